#!/usr/bin/env python3
"""Bad input of each command: one clear line on stderr, the right exit status, no output file.

    cli_test.py BINPICK
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import sample_files as sample

BINPICK = None
GOOD = Path(tempfile.mkdtemp(prefix="binpick_cli_good_"))
FAILURE, USAGE, CANNOT_START = 1, 2, 78


def changed(more, options):
    """The options, without those that `more` gives too, and then `more`."""
    given = {str(word).split("=")[0] for word in more}
    kept = [word for name in options if name not in given for word in (name, options[name])]
    return kept + list(more)


def setUpModule():
    """Good inputs, and a model trained from them."""
    unittest.addModuleCleanup(shutil.rmtree, GOOD)
    sample.write_box_stl(GOOD / "box.stl")
    sample.write_camera(GOOD / "camera.json")
    sample.write_frame(GOOD)
    sample.write_dataset(GOOD / "dataset")
    CliTest.folder = GOOD
    run = CliTest.start(*CliTest.train("box.bpm"))
    if run.returncode != 0:
        raise RuntimeError(f"the good model cannot be trained: {run.stderr}")


class CliTest(unittest.TestCase):
    """Works on a copy of the good inputs; each test breaks one thing."""

    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="binpick_cli_"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        shutil.copytree(GOOD, cls.folder, dirs_exist_ok=True)
        cls.model = cls.folder / "box.bpm"

    @classmethod
    def start(cls, *arguments):
        command = [BINPICK] + [str(a) for a in arguments]
        return subprocess.run(command, cwd=cls.folder, stdin=subprocess.DEVNULL, timeout=300,
                              capture_output=True, text=True)

    @classmethod
    def train(cls, output, *more, mesh="box.stl"):
        """Arguments of a training that is as short as it can be; `more` replaces some."""
        return ["train", mesh, "-o", output] + changed(
            more, {"--camera": "camera.json", "--unit": "mm", "--distance-mm": "300:400",
                   "--tree-depths": "2", "--samples": "50", "--threads": "2",
                   "--calibration-piles": "0", "--test-piles": "0"})

    def detect(self, *more, model=None):
        return ["detect", "--model", model or self.model] + changed(
            more, {"--depth": "depth.png", "--intensity": "gray.png", "--camera": "camera.json",
                   "--threads": "2"})

    def refused(self, status, words, *arguments):
        run = self.start(*arguments)
        self.assertEqual(run.returncode, status, run.stderr)
        errors = [line for line in run.stderr.splitlines()
                  if not line.startswith(("binpick: warning", "training"))]
        self.assertEqual(len(errors), 1, run.stderr)
        self.assertTrue(errors[0].startswith("binpick: error: "), errors[0])
        for word in words:
            self.assertIn(word, errors[0])

    def file(self, name, content):
        path = self.folder / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path


class UsageTest(CliTest):
    def test_help_and_version(self):
        for arguments in (["--help"], ["--version"], ["train", "--help"], ["detect", "--help"],
                          ["eval", "--help"], ["score", "--help"], ["info", "--help"]):
            run = self.start(*arguments)
            self.assertEqual(run.returncode, 0)
            self.assertIn("binpick", run.stdout)
            self.assertEqual(run.stderr, "")

    def test_unknown_commands_and_options(self):
        self.refused(USAGE, ["subcommand"])
        self.refused(USAGE, ["'bogus'"], "bogus")
        self.refused(USAGE, ["--bogus"], *self.train("new.bpm", "--bogus"))
        self.refused(USAGE, ["--bogus"], *self.detect("--bogus"))
        self.refused(USAGE, ["--bogus"], "info", self.model, "--bogus")
        self.refused(USAGE, ["--bogus"], "eval", ".", "--csv", "out.csv", "--bogus")
        self.refused(USAGE, ["--bogus"], "score", ".", "results.csv", "--bogus")

    def test_missing_arguments(self):
        self.refused(USAGE, ["MESH"], "train")
        self.refused(USAGE, ["--output"], "train", "box.stl")
        self.refused(USAGE, ["--model"], "detect")
        self.refused(USAGE, ["--depth"], "detect", "--model", self.model)
        self.refused(USAGE, ["--camera"], "detect", "--model", self.model, "--depth", "depth.png")
        self.refused(USAGE, ["--camera"], "detect", "--model", self.model,
                     "--intensity", "gray.png")
        self.refused(USAGE, ["MODEL"], "info")
        for command in ("eval", "score"):
            run = self.start(command)
            self.assertEqual(run.returncode, USAGE)
            self.assertIn("required", run.stderr)


class TrainTest(CliTest):
    def refused_training(self, status, words, *more, mesh="box.stl", output="new.bpm"):
        self.refused(status, words, *self.train(output, *more, mesh=mesh))
        self.assertFalse((self.folder / "new.bpm").exists())
        self.assertEqual([p.name for p in self.folder.glob("new.bpm*")], [])

    def test_mesh(self):
        self.refused_training(CANNOT_START, ["missing.stl"], mesh="missing.stl")
        self.file("empty.stl", "")
        self.refused_training(CANNOT_START, ["empty.stl"], mesh="empty.stl")
        self.file("junk.ply", b"\x00\xff junk" * 100)
        self.refused_training(CANNOT_START, ["junk.ply"], mesh="junk.ply")
        good = (self.folder / "box.stl").read_bytes()
        self.file("cut.stl", good[:len(good) // 2])
        self.refused_training(CANNOT_START, ["cut.stl"], mesh="cut.stl")

    def test_camera(self):
        self.refused_training(CANNOT_START, ["nocamera.json"], "--camera", "nocamera.json")
        self.file("junk.json", "{ this is no JSON")
        self.refused_training(CANNOT_START, ["junk.json", "JSON"], "--camera", "junk.json")
        self.file("nofocus.json", '{"width": 640, "height": 480}')
        self.refused_training(CANNOT_START, ["nofocus.json", "fx"], "--camera", "nofocus.json")
        self.file("nosize.json", '{"fx": 500, "fy": 500, "cx": 320, "cy": 240}')
        self.refused_training(CANNOT_START, ["nosize.json", "width"], "--camera", "nosize.json")
        self.file("flat.json", json.dumps({**sample.CAMERA, "fx": -500}))
        self.refused_training(CANNOT_START, ["flat.json", "fx"], "--camera", "flat.json")

    def test_values(self):
        for option, value in (("--tilt-deg", "200"), ("--tilt-deg", "-1"), ("--tilt-deg", "nan"),
                              ("--samples", "0"), ("--samples", "many"),
                              ("--gradient-threshold", "100"), ("--normal-threshold", "-1"),
                              ("--threads", "0"),
                              ("--threads", "1000"), ("--tree-depths", "9"), ("--seed", "-3"),
                              ("--seed", "x"), ("--distance-mm", "700:500"),
                              ("--distance-mm", "500"), ("--unit", "furlong"),
                              ("--normal-codebook", "rainbow"), ("--roll-interval-deg", "0")):
            with self.subTest(option=option, value=value):
                self.refused_training(USAGE, [option], f"{option}={value}")

    def test_models_that_could_find_nothing(self):
        self.refused_training(CANNOT_START, ["no usable features", "thresholds"],
                              "--gradient-threshold", "0.999", "--normal-threshold", "0.999")

    def test_output(self):
        self.refused(CANNOT_START, ["nowhere/new.bpm"], *self.train("nowhere/new.bpm"))
        self.refused(CANNOT_START, [str(self.folder)], *self.train(self.folder))

    def test_failure_leaves_the_old_model(self):
        old = self.file("old.bpm", "the old model")
        # A distance from which the part is larger than any image.
        run = self.start(*self.train(old, "--distance-mm", "1:2"))
        self.assertNotEqual(run.returncode, 0)
        self.assertEqual(old.read_text(), "the old model")
        self.assertEqual([p.name for p in self.folder.glob("old.bpm*")], ["old.bpm"])

    def test_ends_with_a_self_test(self):
        run = self.start(*self.train("tested.bpm", "--calibration-piles", "1", "--test-piles", "1"))
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("self-test on 1 simulated piles", run.stdout)
        self.assertIn("calibration 100 %", run.stderr)
        info = json.loads(self.start("info", "--json", "tested.bpm").stdout)["trials"]
        self.assertEqual(info["calibration_piles"], 1)
        self.assertEqual(info["self_test"]["piles"], 1)
        text = self.start("info", "tested.bpm").stdout
        self.assertIn("calibrated on 1 simulated piles", text)
        self.assertIn("in 1 simulated piles", text)

    def test_without_a_camera_one_is_assumed_aloud(self):
        arguments = self.train("assumed.bpm")
        at = arguments.index("--camera")
        del arguments[at:at + 2]
        run = self.start(*arguments)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("warning: no --camera", run.stderr)
        self.assertIn("training 100 %", run.stderr)


class ModelTest(CliTest):
    def test_info_shows_what_was_trained(self):
        run = self.start("info", self.model)
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        self.assertIn("12 triangles", run.stdout)
        info = json.loads(self.start("info", "--json", self.model).stdout)
        # Of 12 and 42: a box looks the same after three half turns.
        self.assertEqual([d["viewpoints"] for d in info["depths"]], [6, 15])
        self.assertEqual(info["samples"], 50)
        self.assertEqual(info["size_bytes"], self.model.stat().st_size)

    def test_damaged_models(self):
        good = self.model.read_bytes()
        flipped = bytearray(good)
        flipped[len(good) // 2] ^= 4
        for name, content in (("missing.bpm", None), ("empty.bpm", b""), ("short.bpm", good[:10]),
                              ("cut.bpm", good[:-1]), ("half.bpm", good[:len(good) // 2]),
                              ("flipped.bpm", bytes(flipped)), ("text.bpm", b"# notes\n" * 500)):
            with self.subTest(name):
                if content is not None:
                    self.file(name, content)
                self.refused(CANNOT_START, [name], "info", name)
                self.refused(CANNOT_START, [name], *self.detect(model=name))


class DetectTest(CliTest):
    def test_good_input_gives_poses_json_and_picture(self):
        run = self.start(*self.detect("--json", "poses.json", "--overlay", "poses.png"))
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        poses = json.loads((self.folder / "poses.json").read_text())
        self.assertIn("detections", poses)
        self.assertIn("dropped", poses)
        self.assertEqual((self.folder / "poses.png").read_bytes()[:4], b"\x89PNG")

    def test_images(self):
        self.refused(CANNOT_START, ["nodepth.png"], *self.detect("--depth", "nodepth.png"))
        self.refused(CANNOT_START, ["nogray.png"], *self.detect("--intensity", "nogray.png"))
        self.file("junk.png", "no picture")
        self.refused(CANNOT_START, ["junk.png"], *self.detect("--depth", "junk.png"))
        sample.write_png(self.folder / "small.png", 8, [[0] * 10] * 10)
        self.refused(CANNOT_START, ["small.png", "10x10"], *self.detect("--intensity", "small.png"))
        self.refused(CANNOT_START, ["small.png"], *self.detect("--depth", "small.png"))

    def test_modality(self):
        images = {"depth": ["--depth", "depth.png"], "intensity": ["--intensity", "gray.png"]}
        for name, missing in (("depth", "intensity"), ("intensity", "depth")):
            alone = ["detect", "--model", self.model, "--camera", "camera.json", *images[name]]
            for chosen in ("automatic", name):
                with self.subTest(frame=name, modality=chosen):
                    run = self.start(*alone, "--modality", chosen, "--json", "-")
                    self.assertEqual((run.returncode, run.stderr), (0, ""))
                    settings = json.loads(run.stdout)["settings"]
                    self.assertEqual(settings["modality"], chosen)
            for chosen in (missing, "depth_and_intensity"):
                with self.subTest(frame=name, modality=chosen):
                    self.refused(FAILURE, [f"no {missing} image"], *alone, "--modality", chosen)
        both = [self.start(*self.detect("--modality", m, "--min-score", "0", "--json", "-"))
                for m in ("automatic", "depth_and_intensity")]
        self.assertEqual(*(json.loads(run.stdout)["detections"] for run in both))

    def test_near_symmetry(self):
        for chosen in ("auto", "equivalent", "distinct"):
            with self.subTest(near_symmetry=chosen):
                run = self.start(*self.detect("--near-symmetry", chosen, "--min-score", "0",
                                              "--json", "-"))
                self.assertEqual((run.returncode, run.stderr), (0, ""))
                found = json.loads(run.stdout)
                self.assertEqual(found["settings"]["near_symmetry"], chosen)
                for pose in found["detections"]:
                    one_of = [pose["pose_probability"]]
                    one_of += [other["probability"] for other in pose["alternatives"]]
                    self.assertLessEqual(sum(one_of), 1 + 1e-9)
                    self.assertEqual(pose["pose_ambiguous"], pose["pose_probability"] < 0.8)

    def test_camera(self):
        self.refused(CANNOT_START, ["nocamera.json"], *self.detect("--camera", "nocamera.json"))
        self.file("list.json", "[1, 2, 3]")
        self.refused(CANNOT_START, ["list.json"], *self.detect("--camera", "list.json"))
        camera = dict(sample.CAMERA)
        del camera["depth_scale"]
        self.file("noscale.json", json.dumps(camera))
        self.refused(CANNOT_START, ["depth_scale"], *self.detect("--camera", "noscale.json"))

    def test_roi(self):
        for roi in ("1,2,3", "a,b,c,d", "0,0,0,10", "0,0,-5,10", ""):
            with self.subTest(roi=roi):
                run = self.start(*self.detect(f"--roi={roi}"))
                self.assertEqual(run.returncode, USAGE, run.stderr)
        for roi in ("5000,0,100,100", "0,-500,10,10"):
            with self.subTest(roi=roi):
                self.refused(CANNOT_START, ["region of interest"], *self.detect(f"--roi={roi}"))

    def test_values(self):
        for option, value in (("--max-results", "0"), ("--max-results", "x"),
                              ("--min-score", "1.5"), ("--min-score", "-1"), ("--threads", "0"),
                              ("--layout", "round"), ("--isa", "mmx"),
                              ("--modality", "gray"), ("--near-symmetry", "some")):
            with self.subTest(option=option, value=value):
                self.refused(USAGE, [option], *self.detect(f"{option}={value}"))

    def test_outputs(self):
        for option in ("--json", "--overlay"):
            self.refused(CANNOT_START, ["nowhere/out"], *self.detect(option, "nowhere/out.png"))

    def test_meshes_have_to_match_the_models(self):
        self.refused(USAGE, ["--mesh"], *self.detect("--mesh", "box.stl", "box.stl"))
        self.refused(CANNOT_START, ["nomesh.stl"], *self.detect("--mesh", "nomesh.stl"))

    def test_data_set_frame(self):
        arguments = ["detect", "--model", self.model, "--bop-frame"]
        self.refused(USAGE, ["--bop-frame"], *arguments, ".", "1")
        self.refused(CANNOT_START, ["nowhere"], *arguments, "nowhere", "1/1")
        self.refused(CANNOT_START, ["test"], *arguments, ".", "1/1")
        self.refused(CANNOT_START, ["scene 2"], *arguments, "dataset", "2/0")
        self.refused(CANNOT_START, ["image 5"], *arguments, "dataset", "1/5")
        self.refused(USAGE, ["--depth"], *self.detect("--bop-frame", "dataset", "1/0"))
        run = self.start(*arguments, "dataset", "1/0", "--json", "-")
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        self.assertEqual(json.loads(run.stdout)["frame"]["name"], "000001/000000")


class EvaluationTest(CliTest):
    def test_data_set(self):
        for command in (["eval", "nowhere", "--csv", "out.csv"], ["score", "nowhere", "none.csv"]):
            self.refused(CANNOT_START, ["nowhere"], *command)

    def test_values(self):
        for option in ("--scenes=x", "--objects=-", "--threads=0", "--min-score=7", "--sweep=fog"):
            with self.subTest(option):
                run = self.start("eval", "dataset", "--csv", "out.csv", option)
                self.assertEqual(run.returncode, USAGE, run.stderr)
                self.assertIn(option.split("=")[0], run.stderr)


class AssessmentTest(CliTest):
    def assess(self, source, *more):
        return ["assess", source, "--model", self.model, *more]

    def test_sources(self):
        self.refused(CANNOT_START, ["nowhere"], *self.assess("nowhere"))
        self.refused(CANNOT_START, ["nowhere"], *self.assess("replay:nowhere"))
        self.refused(CANNOT_START, ["dataset", "1 frame", "at least 5"], *self.assess("dataset"))
        self.refused(FAILURE, ["ftp://here"], *self.assess("ftp://here"))

    def test_values(self):
        for option in ("--scenes=x", "--threads=0", "--wrong-picks-max=2", "--threshold=1",
                       "--count=0", "--roi=1,2", "--modality=sound", "--near-symmetry=no"):
            with self.subTest(option):
                self.refused(USAGE, [option.split("=")[0]], *self.assess("dataset", option))

    def test_options_of_another_kind_of_source(self):
        self.refused(USAGE, ["--exposure-us", "sensors"],
                     *self.assess("dataset", "--exposure-us", "500"))
        self.refused(USAGE, ["--scenes", "folders"],
                     *self.assess("gev://127.0.0.9", "--scenes", "1"))


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    BINPICK = os.path.abspath(sys.argv.pop(1))
    unittest.main()
