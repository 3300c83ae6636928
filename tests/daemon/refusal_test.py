#!/usr/bin/env python3
"""What the system refuses to the daemon, locked memory, scheduling and processors: it says so and
goes on, or does not start, as it is configured; and what is granted is in effect.

    refusal_test.py BINPICKD MODEL
"""

import os
import re
import shutil
import sys
import time
import unittest
from pathlib import Path

import station_process as sp

DAEMON, MODEL = sys.argv.pop(1), sys.argv.pop(1)
# Starts a program that may lock 64 KiB and set no scheduling, whoever runs the test.
POWERLESS = ["prlimit", "--memlock=65536:65536", "--rtprio=0:0"]
if os.geteuid() == 0:
    POWERLESS += ["setpriv", "--bounding-set=-all", "--inh-caps=-all"]


def station_with(memory="lock = false", threads=""):
    station = sp.Station(DAEMON, MODEL)
    station.main = station.main.replace("lock = false", memory)
    station.main += f'[threads]\n{threads}\n[metrics]\nlisten = "{station.folder}/metrics"\n'
    station.write("binpick.toml", station.main)
    return station


def refused(station, setting):
    """The metric."""
    return re.search(rf'binpick_setting_refused{{setting="{setting}"}} (\d)', station.metrics())[1]


OTHERS = ("binpickd", "modbus", "modbus-link", "sensor")


def threads_of(station, names):
    """{name: tid}; a thread names itself, some time after it began."""
    end = time.monotonic() + 30
    while True:
        tasks = Path(f"/proc/{station.process.pid}/task")
        found = {(task / "comm").read_text().strip(): int(task.name) for task in tasks.iterdir()}
        if found.keys() >= set(names):
            return found
        assert time.monotonic() < end, found
        time.sleep(0.01)


@unittest.skipUnless(shutil.which("prlimit") and shutil.which("setpriv"), "no prlimit or setpriv")
class Refused(unittest.TestCase):
    def goes_on(self, setting, told, **parameters):
        with station_with(**parameters) as station:
            station.start(under=POWERLESS)
            station.wait_log(told)
            self.assertEqual(station.log().count(told), 1, "once")
            self.assertEqual(refused(station, setting), "1")
            self.assertTrue(station.ask("detect")["ok"])
            self.assertEqual(station.stop()[0], 0)

    def does_not_start(self, told, **parameters):
        with station_with(**parameters) as station:
            result = station.run(under=POWERLESS)
            self.assertEqual(result.returncode, 78, result.stderr)
            self.assertIn(told, result.stderr)
            self.assertEqual(result.stderr.count("\n"), 1, result.stderr)

    def test_locked_memory(self):
        told = "of locked memory, the system allows 0.1 MiB (LimitMEMLOCK=, ulimit -l)"
        self.goes_on("memory.lock", told, memory="lock = true\nlock_required = false")
        self.does_not_start(told, memory="lock = true")

    def test_scheduling(self):
        told = "threads.scheduling: the system refuses it: Operation not permitted"
        fifo = 'scheduling = "fifo"\npriority = 10'
        self.goes_on("threads", told, threads=fifo)
        self.does_not_start(told, threads=fifo + "\nrequired = true")

    def test_processors(self):
        told = "threads.cpus: the system refuses it: Invalid argument"
        self.goes_on("threads", told, threads="cpus = [1023]")
        self.does_not_start(told, threads="cpus = [1023]\nrequired = true")


class Granted(unittest.TestCase):
    def test_processors_of_those_who_compute(self):
        cpu = min(os.sched_getaffinity(0))
        with station_with(threads=f"cpus = [{cpu}]\nworkers = 3\nrequired = true") as station:
            station.start()
            computing = ("cycle", "worker-1", "worker-2")
            threads = threads_of(station, computing + OTHERS)
            for name in computing:
                self.assertEqual(os.sched_getaffinity(threads[name]), {cpu}, name)
            for name in OTHERS:
                self.assertEqual(os.sched_getaffinity(threads[name]), os.sched_getaffinity(0))
            self.assertEqual(refused(station, "threads"), "0")
            self.assertTrue(station.ask("detect")["ok"])

    def test_scheduling_of_those_who_compute(self):
        before = os.sched_getscheduler(0), os.sched_getparam(0)
        try:
            os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(1))
            os.sched_setscheduler(0, *before)
        except PermissionError:
            self.skipTest("nobody may set a scheduling here")
        for name, policy in (("fifo", os.SCHED_FIFO), ("round_robin", os.SCHED_RR)):
            threads = f'scheduling = "{name}"\npriority = 7\nworkers = 2\nrequired = true'
            with station_with(threads=threads) as station:
                station.start()
                computing = ("cycle", "worker-1")
                tids = threads_of(station, computing + OTHERS)
                for thread in computing:
                    self.assertEqual(os.sched_getscheduler(tids[thread]), policy)
                    self.assertEqual(os.sched_getparam(tids[thread]).sched_priority, 7)
                for thread in OTHERS:
                    self.assertEqual(os.sched_getscheduler(tids[thread]), os.SCHED_OTHER, thread)
                self.assertTrue(station.ask("detect")["ok"])

    def test_locked_memory(self):
        with station_with(memory="lock = true\nlock_required = false") as station:
            station.start()
            if refused(station, "memory.lock") == "1":
                self.skipTest("nobody may lock memory here")
            status = Path(f"/proc/{station.process.pid}/status").read_text()
            locked = int(re.search(r"VmLck:\s+(\d+) kB", status)[1])
            self.assertGreater(locked, 100 << 10)


if __name__ == "__main__":
    unittest.main()
