#!/usr/bin/env python3
"""What goes wrong at a station is told as what it is: to the PLC, in the log, and by --check.

    station_causes_test.py BINPICKD BINPICK
"""

import json
import os
import random
import shutil
import socket
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

TESTS = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(TESTS / "cli"), str(TESTS / "daemon")]
import sample_files as sample  # noqa: E402
import station_process as sp  # noqa: E402

DAEMON, BINPICK = (os.path.abspath(sys.argv.pop(1)) for _ in range(2))
FOLDER = Path(tempfile.mkdtemp(prefix="binpick_causes_"))
DONE, DETECTION_FAILED, HEARTBEAT_LOST = 1, 205, 206
NO_FRAME, DEPTH_NOT_TRAINED, DEPTH_REPEATED = 1 << 9, 1 << 11, 1 << 12


def floor(factor=1.0, size=(320, 240)):
    """340 to 400 mm in units of 0.1 mm, with a sensor's noise."""
    noise = random.Random(5)
    return [[min(65535, round(factor * (3400 + 600 * x / size[0] + noise.gauss(0, 4))))
             for x in range(size[0])] for _ in range(size[1])]


def recording(name, *depths):
    """A data set of one scene, a frame for each depth image; the sensor's lines for it."""
    scene = FOLDER / name / "test" / "000001"
    (scene / "depth").mkdir(parents=True)
    c = sample.CAMERA
    camera = {"cam_K": [c["fx"], 0, c["cx"], 0, c["fy"], c["cy"], 0, 0, 1], "depth_scale": 0.1}
    for i, depth in enumerate(depths):
        sample.write_png(scene / "depth" / f"{i:06}.png", 16, depth)
    frames = {str(i): camera for i in range(len(depths))}
    (scene / "scene_camera.json").write_text(json.dumps(frames))
    return f'uri = "replay:{FOLDER / name}"\nreplay_paced = false'


def setUpModule():
    unittest.addModuleCleanup(shutil.rmtree, FOLDER)
    sample.write_box_stl(FOLDER / "box.stl")
    sample.write_camera(FOLDER / "camera.json")
    subprocess.run([BINPICK, "train", "box.stl", "-o", "box.bpm", "--camera", "camera.json",
                    "--unit", "mm", "--distance-mm", "300:400", "--tree-depths", "2", "--samples",
                    "50", "--gradient-threshold", "0.1", "--normal-threshold", "0.2",
                    "--calibration-piles", "0", "--test-piles", "0"],
                   cwd=FOLDER, check=True, capture_output=True)


def station(sensor, **parameters):
    return sp.Station(DAEMON, FOLDER / "box.bpm", sensor=sensor, **parameters)


class Frames(unittest.TestCase):
    def answers(self, name, depth, cause, reason, told):
        with station(recording(name, depth)) as s:
            s.start()
            plc = sp.Plc(s)
            for _ in range(2):
                answer = plc.command(sp.DETECT)
                self.assertEqual(answer[sp.CAUSE], cause)
                self.assertTrue(answer[sp.REASONS] & reason, hex(answer[sp.REASONS]))
                self.assertEqual(answer[sp.PICKS], 0)
            s.wait_log(told)
            self.assertEqual(s.log().count(told), 1, "once, not once a cycle")
            diagnostics = s.ask("detect")["diagnostics"]
            self.assertTrue(any(told in d["text"] for d in diagnostics), diagnostics)
            plc.close()

    def test_a_wrong_unit_is_a_fault(self):
        self.answers("unit", floor(0.1), DETECTION_FAILED, DEPTH_NOT_TRAINED, "10 times too small")

    def test_depth_that_stands_for_none_is_a_fault(self):
        depth = [[65535 if x % 3 else z for x, z in enumerate(row)] for row in floor()]
        self.answers("none", depth, DETECTION_FAILED, DEPTH_REPEATED, "value 65535 in the image")

    def test_an_empty_bin_is_no_fault(self):
        self.answers("empty", floor(1.6), DONE, DEPTH_NOT_TRAINED,
                     "was trained for (300 to 400 mm)")


class FrameSize(unittest.TestCase):
    def test_a_recording_that_does_not_fit_is_found_by_the_check(self):
        lines = recording("small", floor()) + "\nwidth_max = 256\nheight_max = 256"
        with station(lines) as s:
            for arguments in (["--check"], []):
                run = s.run(*arguments)
                self.assertEqual(run.returncode, 78, run.stderr)
                self.assertRegex(run.stderr, r"binpick\.toml:4:1: sensor\.width_max: is 256, but "
                                             r".* has 320x240 px")

    def test_a_frame_that_does_not_fit_names_the_key(self):
        lines = recording("grows", floor(), floor(size=(640, 480)))
        with station(lines + "\nwidth_max = 320\nheight_max = 240") as s:
            self.assertEqual(s.run("--check").returncode, 0)
            s.start()
            plc = sp.Plc(s)
            self.assertEqual(plc.command(sp.DETECT)[sp.CAUSE], DONE)
            answer = plc.command(sp.DETECT)
            self.assertEqual(answer[sp.CAUSE], DETECTION_FAILED, "the sensor is not lost")
            self.assertTrue(answer[sp.REASONS] & NO_FRAME)
            s.wait_log("a frame is 640x480 px: raise sensor.width_max and sensor.height_max")
            self.assertEqual(plc.command(sp.DETECT)[sp.CAUSE], DONE)
            plc.close()


class Modbus(unittest.TestCase):
    def test_a_heartbeat_counts_for_the_command_in_its_write(self):
        with station(recording("beats", floor()), modbus="plc_heartbeat_timeout_ms = 300") as s:
            s.start()
            plc = sp.Plc(s)
            plc.command(sp.DETECT, heartbeat=1)
            for beat in range(2, 8):
                plc.wait_state(sp.PLC_LOST)
                self.assertEqual(plc.command(sp.DETECT, heartbeat=beat)[sp.CAUSE], DONE)
            plc.wait_state(sp.PLC_LOST)
            self.assertEqual(plc.command(sp.DETECT, heartbeat=beat)[sp.CAUSE], HEARTBEAT_LOST)
            plc.close()

    def test_clients_that_find_no_place_are_in_the_log(self):
        with station(recording("full", floor()), modbus="clients_max = 1") as s:
            s.start()
            plc = sp.Plc(s)
            with socket.create_connection(("127.0.0.1", s.port)) as refused:
                refused.settimeout(30)
                self.assertEqual(refused.recv(1), b"")
            s.wait_log("Modbus: 1 clients refused: all 1 places of modbus.clients_max are taken")
            plc.close()


class Transforms(unittest.TestCase):
    def test_the_check_warns_about_metres_and_radians(self):
        lines = ('pose_frame = "base"\nT_base_cam_position_mm = [0.31, -1.2, 0.95]\n'
                 "T_base_cam_rotation_deg = [3.12, 0.02, -1.55]")
        with station(recording("metres", floor()), station=lines) as s:
            run = s.run("--check")
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertEqual(len(run.stderr.splitlines()), 2, run.stderr)
            self.assertIn("T_base_cam_position_mm: the position looks like metres", run.stderr)
            self.assertIn("T_base_cam_rotation_deg: looks like radians", run.stderr)


if __name__ == "__main__":
    unittest.main()
