#!/usr/bin/env python3
"""Frames of the first day, as users give them to `binpick detect`: exit status, reason, advice.

    wrong_frames_test.py BINPICK
"""

import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "cli"))
import sample_files as sample

BINPICK = None
SAMPLE_BIN = Path(__file__).resolve().parent.parent / "data" / "bin-sample"
WIDTH, HEIGHT = sample.CAMERA["width"], sample.CAMERA["height"]
DONE, FAILURE, CANNOT_START = 0, 1, 78


def bin_floor(factor=1.0):
    """A floor of 340 to 400 mm in units of 0.1 mm, with a sensor's noise."""
    noise = random.Random(3)
    return [[min(65535, round(factor * (3400 + 600 * x / WIDTH + noise.gauss(0, 4))))
             for x in range(WIDTH)] for _ in range(HEIGHT)]


def stripes(rows, value, nth=3):
    """With this value in every nth column."""
    return [[value if x % nth == 0 else z for x, z in enumerate(row)] for row in rows]


def flat(value):
    return [[value] * WIDTH for _ in range(HEIGHT)]


# What: (depth image, changes to the camera file, more options, exit status, words of the output).
WRONG_FRAMES = {
    "depth_scale too small": (bin_floor(), {"depth_scale": 0.0001}, [], CANNOT_START,
                              ["1000 times too small for box", "set depth_scale to 0.1"]),
    "depth_scale too large": (bin_floor(), {"depth_scale": 1.0}, [], CANNOT_START,
                              ["10 times too large for box", "set depth_scale to 0.1"]),
    "no measurement": (flat(0), {}, [], CANNOT_START, ["no pixel of the region", "check"]),
    "65535": (stripes(bin_floor(), 65535), {}, [], CANNOT_START,
              [" % of the measured pixels", "value 65535", "written as 0"]),
    "one value": (flat(9000), {}, [], CANNOT_START, ["the same depth, 900 mm"]),
    "too far away": (bin_floor(1.9), {}, [], DONE,
                     [": 0 found", "trained for (300 to 400 mm)", "move the sensor"]),
    "region outside": (bin_floor(), {}, ["--roi", "400,10,50,50"], CANNOT_START,
                       ["region of interest", "320x240", "--roi"]),
    "focal length in mm": (bin_floor(), {"fx": 8, "fy": 8}, [], CANNOT_START,
                           ["focal lengths", "in pixels"]),
    "principal point outside": (bin_floor(), {"cx": 700}, [], DONE,
                                ["principal point (700, 119.5)", "of this image size"]),
    "nothing wrong, nothing there": (bin_floor(), {}, [], DONE, [": 0 found"]),
}


class WrongFrames(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="binpick_wrong_frames_"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        sample.write_box_stl(cls.folder / "box.stl")
        sample.write_camera(cls.folder / "camera.json")
        run = cls.start("train", "box.stl", "-o", "box.bpm", "--camera", "camera.json", "--unit",
                        "mm", "--distance-mm", "300:400", "--tree-depths", "2", "--samples", "50",
                        "--gradient-threshold", "0.1", "--normal-threshold", "0.2",
                        "--calibration-piles", "0", "--test-piles", "0")
        if run.returncode != 0:
            raise RuntimeError(run.stderr)

    @classmethod
    def start(cls, *arguments):
        return subprocess.run([BINPICK, *map(str, arguments)], cwd=cls.folder, timeout=300,
                              capture_output=True, text=True, check=False)

    def detect(self, depth, camera, *more):
        sample.write_png(self.folder / "depth.png", 16, depth)
        (self.folder / "frame.json").write_text(json.dumps({**sample.CAMERA, **camera}))
        return self.start("detect", "--model", "box.bpm", "--depth", "depth.png", "--camera",
                          "frame.json", *more)

    def test_each_has_its_reason(self):
        for what, (depth, camera, more, status, words) in WRONG_FRAMES.items():
            with self.subTest(what):
                run = self.detect(depth, camera, *more)
                self.assertEqual(run.returncode, status, run.stderr + run.stdout)
                said = run.stderr if status else run.stdout
                if status:
                    self.assertEqual(len(run.stderr.splitlines()), 1, run.stderr)
                for word in words:
                    self.assertIn(word, said)

    def test_nothing_found_comes_with_the_reason(self):
        text = self.detect(bin_floor(), {}).stdout
        self.assertRegex(text, "best rejected pose: box at|nothing in the frame")
        # A score that no pose reaches: then there is a best of them.
        run = self.detect(bin_floor(), {}, "--json", "-", "--min-score", "1")
        report = json.loads(run.stdout)
        self.assertEqual(report["detections"], [])
        self.assertEqual(report["diagnostics"], [])

    def test_the_json_names_the_findings(self):
        report = json.loads(self.detect(bin_floor(1.9), {}, "--json", "-").stdout)
        finding, = report["diagnostics"]
        self.assertEqual(finding["code"], "depth_not_trained")
        self.assertEqual(finding["severity"], "warning")
        self.assertEqual(finding["part"], "box")
        self.assertEqual(finding["numbers"]["trained_max_mm"], 400)

    def test_capture_tells_what_its_frames_show(self):
        scene = self.folder / "empty" / "test" / "000001"
        (scene / "depth").mkdir(parents=True)
        c = sample.CAMERA
        camera = {"cam_K": [c["fx"], 0, c["cx"], 0, c["fy"], c["cy"], 0, 0, 1], "depth_scale": 0.1}
        (scene / "scene_camera.json").write_text(json.dumps({"0": camera, "1": camera}))
        for i in range(2):
            sample.write_png(scene / "depth" / f"{i:06}.png", 16, flat(0))
        run = self.start("capture", "--sensor", "replay:empty", "-n", "2", "-o", "captured")
        self.assertEqual(run.returncode, DONE, "what the sensor gave is kept")
        told = "warning: frame 0: no pixel of the region of interest has a depth"
        self.assertEqual(run.stderr.count(told), 1, run.stderr)

    def test_eval_names_each_frame_and_trains_nothing_for_it(self):
        data = self.folder / "data"
        shutil.copytree(SAMPLE_BIN, data)
        for camera in data.glob("test/*/scene_camera.json"):
            frames = json.loads(camera.read_text())
            for frame in frames.values():
                frame["depth_scale"] = 0.0001  # metres
            camera.write_text(json.dumps(frames))
        run = self.start("eval", "data", "--csv", "out.csv", "--scenes", "1")
        self.assertEqual(run.returncode, CANNOT_START, run.stderr)
        for frame in ("000001/000000", "000001/000001"):
            self.assertIn(f"frame {frame}: the measured depths", run.stderr)
        self.assertIn("set depth_scale to 0.1", run.stderr)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    BINPICK = os.path.abspath(sys.argv.pop(1))
    unittest.main()
