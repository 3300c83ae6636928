#!/usr/bin/env python3
"""What cannot be written is an error of every command: one line that names it, exit status not 0.

    outputs_test.py BINPICK BINPICKD
"""

import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "cli"))
import sample_files as sample  # noqa: E402

BINPICK = BINPICKD = None
FAILURE, CANNOT_START = 1, 78
TRAIN = ["train", "box.stl", "--camera", "camera.json", "--unit", "mm", "--distance-mm", "300:400",
         "--tree-depths", "2", "--samples", "50", "--threads", "2", "--calibration-piles", "0",
         "--test-piles", "0"]
DETECT = ["detect", "--model", "box.bpm", "--depth", "depth.png", "--intensity", "gray.png",
          "--camera", "camera.json", "--threads", "2"]
EVAL = ["eval", "dataset", "--tree-depths", "2", "--samples", "50", "--calibration-piles", "0",
        "--distance-mm", "300:400", "--threads", "2"]
CAPTURE = ["capture", "--sensor", "replay:dataset", "-n", "1"]


class OutputTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="binpick_outputs_"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        sample.write_box_stl(cls.folder / "box.stl")
        sample.write_camera(cls.folder / "camera.json")
        sample.write_frame(cls.folder)
        sample.write_dataset(cls.folder / "dataset")
        cls.add_truth(cls.folder / "dataset")
        (cls.folder / "results.csv").write_text("scene_id,im_id,obj_id,score,R,t,time\n")
        run = cls.start(*TRAIN, "-o", "box.bpm")
        assert run.returncode == 0, run.stderr

    @staticmethod
    def add_truth(root):
        """One part, a tetrahedron, said to be in the frame."""
        (root / "models").mkdir()
        (root / "models" / "obj_000001.ply").write_text(
            "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
            "property float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n"
            "0 0 0\n40 0 0\n0 30 0\n0 0 20\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n")
        (root / "models" / "models_info.json").write_text('{"1": {"diameter": 50}}')
        pose = {"cam_R_m2c": [1, 0, 0, 0, 1, 0, 0, 0, 1], "cam_t_m2c": [0, 0, 400], "obj_id": 1}
        (root / "test" / "000001" / "scene_gt.json").write_text(json.dumps({"0": [pose]}))

    @classmethod
    def start(cls, *arguments, program=None, **options):
        options = {"stdout": subprocess.PIPE, **options}
        return subprocess.run([program or BINPICK, *arguments], cwd=cls.folder, text=True,
                              stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, timeout=300,
                              check=False, **options)

    def assert_refused(self, run, status, words):
        self.assertEqual(run.returncode, status, run.stderr)
        errors = [line for line in run.stderr.splitlines() if ": error: " in line]
        self.assertEqual(len(errors), 1, run.stderr)
        for word in words:
            self.assertIn(word, errors[0])

    def test_standard_output(self):
        """`command > /dev/full`"""
        for arguments in (["--help"], ["--version"], ["train", "--help"],
                          [*TRAIN, "-o", "again.bpm"], ["info", "box.bpm"],
                          ["info", "--json", "box.bpm"], DETECT, [*DETECT, "--json", "-"],
                          [*EVAL, "--csv", "out.csv"], ["score", "dataset", "results.csv"],
                          ["score", "dataset", "results.csv", "--json", "-"],
                          [*CAPTURE, "-o", "captured"]):
            with self.subTest(" ".join(arguments)), open("/dev/full", "w") as full:
                self.assert_refused(self.start(*arguments, stdout=full), FAILURE,
                                    ["standard output: cannot be written"])

    def test_standard_output_of_the_daemon(self):
        for arguments in (["--help"], ["--version"]):
            with self.subTest(arguments[0]), open("/dev/full", "w") as full:
                self.assert_refused(self.start(*arguments, stdout=full, program=BINPICKD), FAILURE,
                                    ["standard output: cannot be written"])

    def test_files_that_are_no_files(self):
        """Each is noticed before the work begins."""
        for arguments in ([*TRAIN, "-o"], [*DETECT, "--json"], [*DETECT, "--overlay"],
                          [*EVAL, "--csv"], [*EVAL, "--csv", "out.csv", "--evidence"],
                          [*EVAL, "--csv", "out.csv", "--json"],
                          [*EVAL, "--csv", "out.csv", "--report"],
                          ["score", "dataset", "results.csv", "--json"]):
            for path in ("/dev/full", "nowhere/deeper/out"):
                if arguments[-1] == "--report" and path.startswith("nowhere"):
                    continue  # a folder is made where there is none
                with self.subTest(f"{' '.join(arguments)} {path}"):
                    run = self.start(*arguments, path)
                    self.assert_refused(run, CANNOT_START, [path])
                    self.assertEqual(run.stdout, "")

    def test_files_that_end_too_early(self):
        """A limit on the size of files stands for a disk that is full."""
        def few_bytes():
            resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))

        for arguments in ([*TRAIN, "-o", "limited.bpm"], [*DETECT, "--json", "limited.json"],
                          [*DETECT, "--overlay", "limited.png"], [*CAPTURE, "-o", "limited"]):
            with self.subTest(" ".join(arguments)):
                self.assert_refused(self.start(*arguments, preexec_fn=few_bytes), CANNOT_START,
                                    ["limited", "File too large"])
                left = [path for path in self.folder.glob("limited*") if path.is_file()]
                self.assertEqual(left, [])


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    BINPICKD = os.path.abspath(sys.argv.pop(2))
    BINPICK = os.path.abspath(sys.argv.pop(1))
    unittest.main()
