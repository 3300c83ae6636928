#!/usr/bin/env python3
"""The sensor commands as users start them, on a recording and on a simulated sensor.

capture_test.py BINPICK GVSIM U3VSIM
"""

import filecmp
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

BINPICK, GVSIM, U3VSIM = sys.argv.pop(1), sys.argv.pop(1), sys.argv.pop(1)
BIN = Path(__file__).resolve().parents[1] / "data/bin-sample"


def address():
    pid = os.getpid()
    return f"127.{1 + pid // 250 % 250}.{1 + pid % 250}.201"


def binpick(*arguments, **environment):
    return subprocess.run([BINPICK, *map(str, arguments)], stdin=subprocess.DEVNULL, text=True,
                          capture_output=True, timeout=120, env={**os.environ, **environment})


class CaptureTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.out = Path(folder.name) / "captured"

    def assert_same_images(self, count):
        """What was captured is scene 1, image after image, as a capture of the files writes it."""
        truth = self.out.parent / "truth"
        run = binpick("capture", "--sensor", f"replay:{BIN}", "-n", 2, "-o", truth)
        self.assertEqual(run.returncode, 0, run.stderr)
        for number in range(count):
            for kind in ("depth", "gray"):
                captured = self.out / f"test/000001/{kind}/{number:06d}.png"
                wanted = truth / f"test/000001/{kind}/{number % 2:06d}.png"
                self.assertTrue(filecmp.cmp(captured, wanted, shallow=False), captured)
        cameras = json.loads((self.out / "test/000001/scene_camera.json").read_text())
        files = json.loads((BIN / "test/000001/scene_camera.json").read_text())
        for number in range(count):
            self.assertEqual(cameras[str(number)]["cam_K"], files[str(number % 2)]["cam_K"])

    def test_captures_a_recording_and_the_capture_is_a_recording(self):
        run = binpick("capture", "--sensor", f"replay:{BIN}", "-n", 3, "-o", self.out)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("3 of 3 frames", run.stdout)
        again = self.out.parent / "again"
        run = binpick("capture", "--sensor", f"replay:{self.out}", "-n", 3, "-o", again)
        self.assertEqual(run.returncode, 0, run.stderr)
        for kind in ("depth", "gray"):
            for i in range(3):
                name = f"test/000001/{kind}/{i:06d}.png"
                self.assertTrue(filecmp.cmp(self.out / name, again / name, shallow=False))

    def test_says_when_a_recording_ends_too_early(self):
        run = binpick("capture", "--sensor", f"replay:{BIN}", "-n", 99, "-o", self.out)
        self.assertEqual(run.returncode, 1)
        self.assertIn("7 of 99 frames", run.stdout)
        self.assertIn("the recording is over", run.stderr)

    def test_does_not_overwrite(self):
        self.out.mkdir()
        (self.out / "mine").write_text("x")
        run = binpick("capture", "--sensor", f"replay:{BIN}", "-n", 1, "-o", self.out)
        self.assertEqual(run.returncode, 78)
        self.assertIn("not empty", run.stderr)

    def test_names_what_is_wrong(self):
        run = binpick("capture", "--sensor", "what:ever", "-n", 1, "-o", self.out)
        self.assertEqual(run.returncode, 1)
        self.assertIn("what:ever: expected gev://", run.stderr)
        self.assertFalse(self.out.exists())

    def test_a_simulated_sensor_needs_no_address(self):
        info = binpick("sensor-info", "sim:gev", "--seconds", 0)
        if info.returncode != 0:  # else somebody has started one
            self.assertEqual(info.returncode, 1)
            self.assertIn("start it first: gvsim", info.stderr)
        self.assertEqual(binpick("sensor-info", "replay:here").returncode, 2)

    def test_a_simulated_sensor_is_shown_and_captured(self):
        sim = subprocess.Popen([GVSIM, "--bind", address(), "--scenes", BIN, "--scene", "1"],
                               stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        try:
            self.assertIn("ready", sim.stdout.readline())
            uri = f"gev://{address()}"
            info = binpick("sensor-info", uri, "--seconds", 1, "--no-packet-socket")
            self.assertEqual(info.returncode, 0, info.stderr)
            self.assertIn("Scan3dCoordinateScale C", info.stdout)
            self.assertIn("frames/s", info.stdout)
            run = binpick("capture", "--sensor", uri, "-n", 4, "-o", self.out, "--no-packet-socket")
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertIn("4 of 4 frames", run.stdout)
            self.assertIn("dropped 0", run.stdout)
            self.assert_same_images(4)
        finally:
            sim.kill()
            sim.communicate()

    def test_a_sensor_that_another_program_controls_says_so(self):
        sim = subprocess.Popen([GVSIM, "--bind", address(), "--scenes", BIN, "--scene", "1"],
                               stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        other = None
        try:
            self.assertIn("ready", sim.stdout.readline())
            wanted = ["capture", "--sensor", f"gev://{address()}", "--no-packet-socket"]
            other = subprocess.Popen([BINPICK, *wanted, "-n", "999", "--trigger", "free", "--fps",
                                      "5", "-o", str(self.out)], stderr=subprocess.PIPE, text=True)
            while "capture 0 %" not in other.stderr.readline():
                self.assertIsNone(other.poll())
            run = binpick(*wanted, "-n", 1, "-o", self.out / "second")
            self.assertEqual(run.returncode, 1)
            self.assertIn(f"gev://{address()}: another program controls this sensor: ", run.stderr)
            self.assertFalse((self.out / "second").exists())
        finally:
            for process in filter(None, (other, sim)):
                process.kill()
                process.communicate()

    def test_sensors_of_known_makes_are_served_by_their_profiles(self):
        for vendor, model, payload, trigger, profile in (
                ("Basler", "blaze-101", "mono16", "software", "basler-blaze"),
                ("Lucid Vision Labs", "HLT003S-001", "abcy16", "software", "lucid-helios2"),
                ("Roboception GmbH", "rc_visard 65", "disparity", "free",
                 "roboception-rc-visard")):
            sim = subprocess.Popen([GVSIM, "--bind", address(), "--scenes", BIN, "--scene", "1",
                                    "--vendor", vendor, "--model", model, "--payload", payload],
                                   stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
            try:
                self.assertIn("ready", sim.stdout.readline())
                run = binpick("capture", "--sensor", f"gev://{address()}", "-n", 2,
                              "-o", self.out / profile, "--trigger", trigger,
                              "--no-packet-socket")
                self.assertIn("profile " + profile, run.stderr)
                self.assertEqual(run.returncode, 0, run.stderr)
                self.assertIn("2 of 2 frames", run.stdout)
            finally:
                sim.kill()
                sim.communicate()

    @unittest.skipUnless(shutil.which("umockdev-wrapper"), "umockdev is not installed")
    def test_a_simulated_usb_sensor_is_listed_and_captured(self):
        sim = subprocess.Popen([U3VSIM, "--scenes", BIN, "--scene", "1", "--serial", "U1"],
                               stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        try:
            folder = re.search(r"UMOCKDEV_DIR=(\S+)", sim.stdout.readline()).group(1)
            bus = {"UMOCKDEV_DIR": folder, "LD_PRELOAD": "libumockdev-preload.so.0"}
            self.assertIn("u3v://serial/U1", binpick("sensors", **bus).stdout)
            run = binpick("capture", "--sensor", "u3v://serial/U1", "-n", 4, "-o", self.out, **bus)
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertIn("dropped 0", run.stdout)
            self.assert_same_images(4)
        finally:
            sim.kill()
            sim.communicate()


if __name__ == "__main__":
    sys.exit(unittest.main())
