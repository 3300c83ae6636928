#!/usr/bin/env python3
"""The daemon over thousands of cycles on replayed frames with two clients that poll: `binpick plc`,
which gives the commands and checks every invariant, and pymodbus, which watches for torn and
changing answers. Meanwhile metrics are asked for and cycles recorded. What it must show: nothing
broken, picks and empty bins alike, resident size and threads flat, and not one allocation on the
station's own threads; who else allocates is printed.

    long_soak.py BINPICKD BINPICK MODEL ALLOCATION_COUNTER [CYCLES [SENSOR_URI]]

A live sensor, such as gev://127.0.0.7 of a running gvsim, shows what Aravis and GLib allocate; the
thread that grabs calls them, so that only the station's own code must not allocate there.
"""

import os
import random
import struct
import subprocess
import sys
import threading
import time
from pathlib import Path

import station_process as sp

# Threads that run the station's own code and must not allocate once it is ready; the first one is
# the main thread.
OWN = ("binpickd", "cycle", "worker-1", "modbus", "modbus-link", "sensor", "recorder", "log",
       "metrics")
# The pile's middle: a detection of tens of milliseconds, in frames with tees and without.
ROI_PX = [540, 420, 200, 180]
WARM_CYCLES = 100
RESIDENT_GROWTH_KIB_MAX = 1024


class Watcher(threading.Thread):
    """A client of its own: what one result fixes never changes, head and tail belong together."""

    KEPT = list(range(sp.RESULT, 25)) + list(range(27, sp.COUNT))  # all but state and age

    def __init__(self, station):
        super().__init__(daemon=True)
        self.plc, self.stop_it = sp.Plc(station), threading.Event()
        self.reads, self.results, self.with_picks, self.faults = 0, 0, 0, []

    def run(self):
        chance, last = random.Random(3), None
        while not self.stop_it.is_set():
            r = self.plc.read()
            kept = [r[i] for i in self.KEPT]
            self.reads += 1
            if r[sp.RESULT] != r[sp.TAIL]:
                self.faults.append(f"head {r[sp.RESULT]}, tail {r[sp.TAIL]}")
            if last and last[0] == kept[0] and last != kept:
                self.faults.append(f"result {kept[0]} has changed")
            if last and last[0] != kept[0]:
                self.results += 1
                self.with_picks += r[sp.PICKS] > 0
            last = kept
            time.sleep(chance.random() * 0.01)


class Looks:
    """What the process holds, by thread: resident size, threads, allocations."""

    ENTRY = struct.Struct("<qqq")

    def __init__(self, pid, table):
        self.pid, self.table, self.names, self.samples = pid, table, {}, []

    def status(self):
        text = Path(f"/proc/{self.pid}/status").read_text()
        fields = dict(line.split(":", 1) for line in text.splitlines())
        return int(fields["VmRSS"].split()[0]), int(fields["Threads"])

    def allocations(self):
        """{(tid, name): (own code, libraries)}; who is gone keeps the name it had."""
        for task in Path(f"/proc/{self.pid}/task").iterdir():
            try:
                self.names[int(task.name)] = (task / "comm").read_text().strip()
            except FileNotFoundError:
                pass  # has ended
        entries = self.ENTRY.iter_unpack(Path(self.table).read_bytes())
        return {(tid, self.names.get(tid, "gone")): (own, others)
                for tid, own, others in entries if tid != 0}

    def sample(self):
        self.samples.append((time.monotonic(), *self.status()))


def metric(text, name):
    return float(next(line.split()[-1] for line in text.splitlines() if line.startswith(name)))


def start(daemon, model, counter, uri):
    station = sp.Station(daemon, model, sensor=f'uri = "{uri}"\nframe_deadline_ms = 30000\n'
                                               "packet_socket = false")
    station.main = station.main.replace("lock = false", "lock = true\nlock_required = false")
    station.main += (f'[recorder]\nfolder = "{station.folder}/recordings"\nmode = "always"\n'
                     f"mib_max = 64\nfree_mib_min = 0\n"
                     f'[metrics]\nlisten = "{station.folder}/metrics"\n')
    station.write("binpick.toml", station.main)
    station.write("tee.toml", f'number = 1\nmodels = ["{model}"]\nmin_score = 0.4\n'
                              f"roi_px = {ROI_PX}\n")
    station.write("once.toml", f'number = 5\nmodels = ["{model}"]\nmin_score = 0.99\n'
                               f"roi_px = {ROI_PX}\n")
    os.environ.update(LD_PRELOAD=counter, BINPICK_ALLOCATIONS=f"{station.folder}/allocations")
    station.start()
    del os.environ["LD_PRELOAD"], os.environ["BINPICK_ALLOCATIONS"]
    while station.ask("status")["sensor"] != "ready":
        time.sleep(0.02)
    return station


def soak(binpick, station, cycles):
    return subprocess.Popen(
        [binpick, "plc", "--host", "127.0.0.1", "--port", str(station.port), "--poll-ms", "2",
         "--timeout-ms", "30000", "--soak", str(cycles)],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def is_own(name):
    return name in OWN or name.startswith("worker-")


def print_allocations(names, before, after, live):
    """The sum of what the station's own threads took and must not."""
    made = {name: [0, 0] for name in names}  # who never allocated is in no table
    for (tid, name), (own, others) in after.items():
        own_before, others_before = before.get((tid, name), (0, 0))
        line = made.setdefault(name, [0, 0])
        line[0] += own - own_before
        line[1] += others - others_before
    of_station = 0
    print("allocations by thread (own code, libraries):")
    for name, (own, others) in sorted(made.items()):
        calls_sensor = live and name == "sensor"
        of_station += own + (0 if calls_sensor else others) if is_own(name) else 0
        may = "" if is_own(name) and not calls_sensor else "  (may)"
        print(f"  {name:16} {own:10} {others:10}{may}")
    return of_station


def main():
    daemon, binpick, model, counter = sys.argv[1:5]
    cycles = int(sys.argv[5]) if len(sys.argv) > 5 else 10000
    uri = sys.argv[6] if len(sys.argv) > 6 else f"replay:{sp.SAMPLE}"
    live = not uri.startswith("replay:")
    faults = []
    with start(daemon, model, counter, uri) as station:
        warm = soak(binpick, station, WARM_CYCLES)
        station.metrics()
        if warm.wait(600) != 0:
            sys.exit("the warm-up failed:\n" + warm.stdout.read())
        looks = Looks(station.process.pid, f"{station.folder}/allocations")
        watcher = Watcher(station)
        watcher.start()
        before, begun = looks.allocations(), time.monotonic()
        run = soak(binpick, station, cycles)
        while run.poll() is None:
            looks.sample()
            text = station.metrics()
            time.sleep(2)
        took_s = time.monotonic() - begun
        after = looks.allocations()
        watcher.stop_it.set()
        watcher.join()
        print(run.stdout.read(), end="")
        faults += [] if run.returncode == 0 else ["binpick plc found invariants broken"]
        faults += watcher.faults[:20]
        print(f"the other client: {watcher.reads} reads, {watcher.results} results seen, "
              f"{watcher.with_picks} with picks, {len(watcher.faults)} faults")
        if not 0 < watcher.with_picks < watcher.results:
            faults.append("not both, results with picks and without")
        done = metric(text, 'binpick_cycle_seconds_count{stage="detect"}')
        print(f"{took_s:.0f} s, {took_s * 1000 / cycles:.0f} ms a command, {done:.0f} detections, "
              f"{metric(text, 'binpick_recorder_written_total'):.0f} recorded, "
              f"{metric(text, 'binpick_recorder_overwritten_total'):.0f} the disk was too slow for")
        sizes = [size for _, size, _ in looks.samples]
        settled = sizes[len(sizes) // 10]  # a reader's heap has its peak some time after start
        print(f"resident KiB: first {sizes[0]}, after a tenth {settled}, last {sizes[-1]}, "
              f"max {max(sizes)}, {len(sizes)} looks; "
              f"threads {sorted({count for _, _, count in looks.samples})}")
        if max(sizes) - settled > RESIDENT_GROWTH_KIB_MAX:
            faults.append(f"the resident size grew by {max(sizes) - settled} KiB")
        if len({count for _, _, count in looks.samples}) != 1:
            faults.append("threads come and go")
        for name in set(OWN) - set(looks.names.values()):
            faults.append(f"there is no thread {name}: nothing is proved of it")
        of_station = print_allocations(looks.names.values(), before, after, live)
        if of_station != 0:
            faults.append(f"{of_station} allocations on the station's own threads")
        if not any(sum(counts) > sum(before.get(thread, (0, 0)))
                   for thread, counts in after.items() if live or "reader" in thread[1]):
            faults.append("the counter does not count")
    for fault in faults:
        print("FAULT:", fault)
    print("passed" if not faults else "failed")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
