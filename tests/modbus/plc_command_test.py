#!/usr/bin/env python3
"""binpick plc against the fake station: what it prints, and that its exit status is the answer.

    plc_command_test.py BINPICK FAKE_STATION
"""

import subprocess
import sys
import unittest

from station_process import Station

PROGRAM = sys.argv.pop(2)
BINPICK = sys.argv.pop(1)


class PlcTest(unittest.TestCase):
    def station(self, *options):
        station = Station(PROGRAM, "--cycle-ms", "5", *options)
        self.addCleanup(station.close)
        return station

    def plc(self, station, *options, status=0):
        command = [BINPICK, "plc", "--host", "127.0.0.1", "--port", str(station.port), *options]
        run = subprocess.run(command, capture_output=True, text=True, timeout=120)
        self.assertEqual(run.returncode, status, run.stdout + run.stderr)
        return run.stdout + run.stderr

    def test_handshake_step_by_step(self):
        for order in ("abcd", "cdab", "badc", "dcba"):
            text = self.plc(self.station("--word-order", order))
            for words in (f"word order {order}", "2. wrote command detect", "19 (40020)",
                          "3. acknowledged_sequence is 1", "4. result_command is 1", "1 done",
                          "    100.000     -50.500     600.001"):
                self.assertIn(words, text)

    def test_every_rotation_convention(self):
        for rotation in ("fanuc_wpr", "rotation_vector", "quaternion_wxyz", "euler_zyz"):
            text = self.plc(self.station("--rotation", rotation), "--flange", "1,2,3,10,20,30")
            self.assertIn(f"rotation {rotation}", text)

    def test_a_refused_command_fails_with_its_cause(self):
        station = self.station()
        self.assertIn("101 recipe_unknown", self.plc(station, "--recipe", "9", status=1))
        self.assertIn("107 nothing_captured", self.plc(station, "--command", "process", status=1))

    def test_watch_sees_changes(self):
        text = self.plc(self.station(), "--watch", "--seconds", "0.5", "--poll-ms", "10")
        self.assertIn("acknowledged     0", text)

    def test_soak_passes_with_a_station_that_behaves(self):
        text = self.plc(self.station("--word-order", "cdab"), "--soak", "300", "--poll-ms", "2",
                        "--seed", "5")
        self.assertIn("300 cycles", text)
        self.assertIn("0 invariants broken", text)

    def test_soak_fails_with_one_that_does_not(self):
        for fault, words in (("--tail-differs", "torn"), ("--changes-picks", "not latched"),
                             ("--heartbeat-stands", "stands still"),
                             ("--answers-stale", "stale")):
            text = self.plc(self.station(fault), "--soak", "12", "--poll-ms", "100",
                            "--timeout-ms", "400", status=1)
            self.assertIn(words, text)

    def test_no_station(self):
        station = self.station()
        station.close()
        self.assertIn("does not accept", self.plc(station, status=78))

    def test_write_protection_is_named(self):
        text = self.plc(self.station("--writer", "127.0.0.9"), status=78)
        self.assertIn("may this address write", text)
        self.plc(self.station("--writer", "127.0.0.9"), "--watch", "--seconds", "0.1")

    def test_usage(self):
        station = self.station()
        self.assertIn("there is no command 'dance'",
                      self.plc(station, "--command", "dance", status=78))
        self.assertIn("--soak", self.plc(station, "--soak", "5", "--watch", status=2))


if __name__ == "__main__":
    unittest.main()
