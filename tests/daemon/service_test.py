#!/usr/bin/env python3
"""The daemon as a service: start and stop, notifications, watchdog, reload, bad configurations,
death in mid-cycle, a sensor that is lost and comes back."""

import ctypes
import os
import signal
import subprocess
import sys
import threading
import time
import unittest
from pathlib import Path

import station_process as sp

DAEMON, MODEL, GVSIM = sys.argv.pop(1), sys.argv.pop(1), sys.argv.pop(1)


class Start(unittest.TestCase):
    def test_ready_then_stopping(self):
        with sp.Station(DAEMON, MODEL) as station:
            print(f"[ measured ] start to READY=1: {station.start():.2f} s")
            status, seconds = station.stop()
            self.assertEqual(status, 0, station.log())
            print(f"[ measured ] SIGTERM to exit: {seconds:.2f} s")
            station.manager.wait("STOPPING=1", 1)
            self.assertFalse(os.path.exists(station.control))

    def test_stops_during_a_cycle(self):
        with sp.Station(DAEMON, MODEL, station="free_run = true") as station:
            station.start()
            time.sleep(0.5)
            self.assertEqual(station.stop()[0], 0)

    def test_plan_is_printed_and_too_little_is_refused(self):
        with sp.Station(DAEMON, MODEL) as station:
            plan = station.run("--plan")
            self.assertEqual(plan.returncode, 0, plan.stderr)
            for owner in ("frame pool", "detector", "models", "total"):
                self.assertIn(owner, plan.stdout)
            station.write("binpick.toml",
                          station.main.replace("lock = false", "lock = false\nmib_max = 20"))
            refused = station.run()
            self.assertEqual(refused.returncode, 78)
            self.assertIn("memory.mib_max allows 20 MiB", refused.stderr)

    def test_check(self):
        with sp.Station(DAEMON, MODEL) as station:
            checked = station.run("--check")
            self.assertEqual((checked.returncode, checked.stderr), (0, ""))
            self.assertIn("can be used", checked.stdout)

    def test_what_cannot_be_used_is_78_and_named(self):
        with sp.Station(DAEMON, MODEL) as station:
            def refusal(main=None, recipe=None):
                station.write("binpick.toml", main or station.main)
                station.write("tee.toml", recipe or f'number = 1\nmodels = ["{MODEL}"]\n')
                for arguments in ((), ("--check",)):
                    result = station.run(*arguments)
                    self.assertEqual(result.returncode, 78, result.stderr)
                return result.stderr

            text = refusal(
                station.main.replace("[station]", "[station]\ndeadline_s = 1\npicks = 3"))
            self.assertIn("station.deadline_s: there is no such key: the key is "
                          "station.deadline_ms", text)
            self.assertIn("station.picks", text)
            self.assertIn("binpick.toml:4:", text)
            self.assertIn("there is no such model file",
                          refusal(recipe='number = 1\nmodels = ["no.bpm"]\n'))
            station.write("bad.bpm", "not a model")
            self.assertIn("bad.bpm", refusal(recipe='number = 1\nmodels = ["bad.bpm"]\n'))
            self.assertIn("number", refusal(recipe=f'number = 70000\nmodels = ["{MODEL}"]\n'))
            self.assertIn("is that of", refusal(recipe=f'number = 5\nmodels = ["{MODEL}"]\n'))
            self.assertIn("binpick.toml:1:", refusal(main="[sensor\n"))

    def test_a_second_daemon_is_refused(self):
        with sp.Station(DAEMON, MODEL) as station:
            station.start()
            second = station.run()
            self.assertEqual(second.returncode, 78)
            station.ask("status")  # the first one lives


class Watchdog(unittest.TestCase):
    def test_is_fed_while_idle_and_while_busy(self):
        with sp.Station(DAEMON, MODEL) as station:
            station.start(watchdog_us=2_000_000)
            for line in ("status", "free_run on"):
                station.ask(line)
                end = time.monotonic() + 3
                while time.monotonic() < end:
                    station.manager.listen(0.1)
            self.assertGreater(station.manager.count("WATCHDOG=1"), 6)

    def test_is_not_fed_by_a_cycle_that_hangs(self):
        """The cycle's thread alone is held; the main loop goes on and answers."""
        with sp.Station(DAEMON, MODEL) as station:
            station.start(watchdog_us=1_000_000)
            station.manager.wait("WATCHDOG=1")
            with HeldThread(station.process.pid, "cycle"):
                while station.manager.listen(0.5):  # what was on its way
                    pass
                fed = station.manager.count("WATCHDOG=1")
                station.ask("status")
                self.assertIsNone(station.manager.listen(2))
            station.manager.wait("WATCHDOG=1")
            self.assertGreater(station.manager.count("WATCHDOG=1"), fed)


class HeldThread:
    """One thread of a child process, stopped by ptrace; skips the test where that is forbidden."""

    SEIZE, INTERRUPT, DETACH, WALL = 0x4206, 0x4207, 17, 0x40000000

    def __init__(self, pid, name):
        tasks = Path(f"/proc/{pid}/task")
        self.tid = next(int(task.name) for task in tasks.iterdir()
                        if (task / "comm").read_text().strip() == name)
        self.ptrace = ctypes.CDLL(None, use_errno=True).ptrace
        self.ptrace.argtypes = [ctypes.c_long, ctypes.c_long, ctypes.c_void_p, ctypes.c_void_p]

    def __enter__(self):
        if self.ptrace(self.SEIZE, self.tid, None, None) != 0:
            raise unittest.SkipTest("ptrace is forbidden here: " + os.strerror(ctypes.get_errno()))
        self.ptrace(self.INTERRUPT, self.tid, None, None)
        os.waitpid(self.tid, self.WALL)

    def __exit__(self, *_):
        self.ptrace(self.DETACH, self.tid, None, None)


class Reload(unittest.TestCase):
    def test_takes_over_what_it_can_and_names_the_rest(self):
        with sp.Station(DAEMON, MODEL) as station:
            station.start()
            station.write("binpick.toml", station.main.replace(
                "[station]", "[station]\nranking = 'near_camera'\npicks_max = 32"))
            station.write("tee.toml", f'number = 1\nmodels = ["{MODEL}"]\nmin_score = 1.0\n')
            station.process.send_signal(signal.SIGHUP)
            station.manager.wait("RELOADING=1")
            station.manager.wait("READY=1")
            station.wait_log("reload: taken over: station.ranking")
            station.wait_log("recipe 1: min_score")
            station.wait_log("needs a restart: station.picks_max")
            for _ in range(2):
                self.assertEqual(station.ask("detect")["picks"], [])

    def test_a_region_moves_as_far_as_the_memory_goes(self):
        def write(station, roi):
            for name, number in (("tee.toml", 1), ("once.toml", 5)):
                station.write(name, f'number = {number}\nmodels = ["{MODEL}"]\nmin_score = 0.4\n'
                                    f"roi_px = {roi}\n")

        def reload(station, roi, log):
            write(station, roi)
            station.process.send_signal(signal.SIGHUP)
            station.wait_log(log)

        def places():
            """Of the picks of all frames, px."""
            for _ in range(7):  # the recording's frames
                for pick in station.ask("detect")["picks"]:
                    x, y, z = (row[3] for row in pick["T_ref_pick"])
                    yield 1908.6 * x / z + 633.2, 1907.9 * y / z + 518.4

        with sp.Station(DAEMON, MODEL) as station:
            write(station, [300, 300, 400, 400])
            station.start()
            self.assertTrue(any(u < 560 for u, _ in places()))
            reload(station, [600, 350, 300, 400], "taken over: recipe 1: roi_px, recipe 5: roi_px")
            moved = list(places())
            self.assertGreater(len(moved), 5)
            for u, v in moved:  # the model's origin is some px from its middle
                self.assertTrue(560 < u < 940 and 310 < v < 790, (u, v))
            reload(station, [600, 350, 401, 400],
                   "needs a restart: recipe 1: roi_px, recipe 5: roi_px")
            self.assertGreater(len(list(places())), 5)

    def test_a_bad_file_changes_nothing(self):
        with sp.Station(DAEMON, MODEL) as station:
            station.start()
            station.write("binpick.toml", station.main + "\n[what]\nis = 'this'\n")
            station.process.send_signal(signal.SIGHUP)
            station.manager.wait("RELOADING=1")
            station.manager.wait("READY=1")
            station.wait_log("nothing is changed")
            self.assertTrue(station.ask("detect")["ok"])


class Death(unittest.TestCase):
    def test_killed_in_mid_cycle_and_started_again(self):
        with sp.Station(DAEMON, MODEL) as station:
            for _ in range(3):
                station.start()
                plc = sp.Plc(station)
                plc.command(sp.DETECT)
                plc.write(sp.DETECT)
                time.sleep(0.03)
                station.process.kill()
                station.process.wait()
                plc.close()
            station.start()
            plc = sp.Plc(station)
            self.assertEqual(plc.sequence, 0)
            fresh = plc.read()
            self.assertEqual((fresh[sp.RESULT], fresh[sp.CAUSE], fresh[sp.PICKS]), (0, 0, 0))
            self.assertEqual(plc.command(sp.DETECT)[sp.CAUSE], 1)
            plc.close()


class SensorLoss(unittest.TestCase):
    def setUp(self):
        pid = os.getpid()
        self.address = f"127.{1 + pid % 200}.{pid // 200 % 250}.77"
        self.gvsim = subprocess.Popen(
            [GVSIM, "--bind", self.address, "--scenes", str(sp.SAMPLE)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.gvsim.stdout.readline()

    def tearDown(self):
        self.gvsim.kill()
        self.gvsim.wait()
        self.gvsim.stdin.close()
        self.gvsim.stdout.close()

    def tell(self, line):
        self.gvsim.stdin.write(line + "\n")
        self.gvsim.stdin.flush()
        return self.gvsim.stdout.readline()

    def test_the_plc_sees_the_cause_in_time_and_the_next_good_pick_after(self):
        sensor = f'uri = "gev://{self.address}"\npacket_socket = false\nframe_deadline_ms = 800'
        with sp.Station(DAEMON, MODEL, sensor=sensor) as station:
            station.start()
            plc = sp.Plc(station)
            plc.wait_state(sp.READY | sp.SENSOR_OK)
            self.assertEqual(plc.command(sp.DETECT)[sp.CAUSE], 1, station.log())
            self.assertIn("ok", self.tell("fault frozen 1"))
            begun = time.monotonic()
            answer = plc.command(sp.DETECT)
            print(f"[ measured ] cause after {time.monotonic() - begun:.2f} s")
            self.assertEqual(answer[sp.CAUSE], 201)
            self.assertLess(time.monotonic() - begun, 5)
            self.assertEqual(answer[sp.PICKS], 0)
            self.assertTrue(answer[sp.STATE] & sp.FAULT)
            self.assertIn("ok", self.tell("fault frozen 0"))
            begun = time.monotonic()
            while answer[sp.CAUSE] != 1 and time.monotonic() < begun + 40:
                answer = plc.command(sp.DETECT)
            print(f"[ measured ] first answer {time.monotonic() - begun:.2f} s after the return")
            self.assertEqual(answer[sp.CAUSE], 1, station.log())
            self.assertFalse(plc.read()[sp.STATE] & sp.FAULT)
            plc.close()


class Age(unittest.TestCase):
    def test_many_cycles_leave_the_resident_size_flat(self):
        with sp.Station(DAEMON, MODEL) as station:
            station.start()
            plcs = [sp.Plc(station) for _ in range(2)]
            stop = threading.Event()

            def poll():
                while not stop.is_set():
                    plcs[1].read()
                    time.sleep(0.003)

            poller = threading.Thread(target=poll)
            poller.start()
            try:
                sizes = []
                for _ in range(3):
                    for i in range(40):
                        plcs[0].command(sp.CAPTURE if i % 4 else sp.DETECT)
                    sizes.append(station.resident_kib())
            finally:
                stop.set()
                poller.join()
            print(f"[ measured ] resident KiB after 40, 80, 120 orders: {sizes}")
            self.assertLess(sizes[2] - sizes[1], 2048)
            for plc in plcs:
                plc.close()


if __name__ == "__main__":
    unittest.main()
