#!/usr/bin/env python3
"""Compares `binpick score` with an independent scorer on random results.

usage: score_agreement.py BINPICK [DATASET]

The scorer is the script that the environment variable BINPICK_SCORER names. It is run as
`SCORER DATASET RESULTS.csv --json -`. The data set is made here: parts without a symmetry, with a
discrete and with a continuous one, scenes of one kind and a mixed scene, a region of interest;
DATASET is compared too (minutes where it is large). Exit status 77: skipped.
"""

import csv
import json
import math
import os
import random
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

ROUNDS = 4
TOLERANCE = 1e-6
# The scorer rounds its mean errors to four digits.
TOLERANCE_OF = {"mean_abs_error": 1.01e-4}
# What both compute. ADD depends on where points are sampled on the mesh: both draw the same ones.
KEYS = ("images", "instances", "detections", "f1", "recall", "precision", "threshold", "time_mean",
        "time_max", "add10_f1", "add10_recall", "add15_f1", "add15_recall", "mssd_recall",
        "mean_abs_error")


def skip(reason):
    print("skipped:", reason)
    sys.exit(77)


def matrix_product(a, b):
    return [sum(a[3 * i + k] * b[3 * k + j] for k in range(3)) for i in range(3) for j in range(3)]


def rotation(axis, angle):
    n = math.sqrt(sum(v * v for v in axis))
    x, y, z = (v / n for v in axis)
    c, s = math.cos(angle), math.sin(angle)
    d = 1 - c
    return [c + x * x * d, x * y * d - z * s, x * z * d + y * s,
            y * x * d + z * s, c + y * y * d, y * z * d - x * s,
            z * x * d - y * s, z * y * d + x * s, c + z * z * d]


def random_rotation(rng):
    axis = [rng.gauss(0, 1) for _ in range(3)]
    return rotation(axis, rng.uniform(0, math.pi))


def moved(rng, R, t, mm, deg):
    turn = rotation([rng.gauss(0, 1) for _ in range(3)], math.radians(abs(rng.gauss(0, deg))))
    return matrix_product(turn, R), [v + rng.gauss(0, mm) for v in t]


def at_the_limit(rng, R, t):
    """Just inside or just outside one limit of the criterion."""
    axis = rng.randrange(3)
    if rng.random() < 0.5:
        turn = rotation([1.0 if i == axis else 0.0 for i in range(3)],
                        math.radians(rng.choice([-1, 1]) * rng.uniform(7.3, 7.7)))
        return matrix_product(turn, R), t
    return R, [v + rng.choice([-1, 1]) * rng.uniform(4.8, 5.2) * (i == axis)
               for i, v in enumerate(t)]


def prism(sides, radius, height, shift=(0, 0, 0)):
    """A closed prism about z: vertices and triangles."""
    rim = [(radius * math.cos(2 * math.pi * i / sides), radius * math.sin(2 * math.pi * i / sides))
           for i in range(sides)]
    vertices = [(x, y, z) for z in (-height / 2, height / 2) for x, y in rim]
    vertices += [(0, 0, -height / 2), (0, 0, height / 2)]
    faces = []
    for i in range(sides):
        j = (i + 1) % sides
        faces += [(i, j, sides + j), (i, sides + j, sides + i), (j, i, 2 * sides),
                  (sides + i, sides + j, 2 * sides + 1)]
    return [tuple(a + b for a, b in zip(v, shift)) for v in vertices], faces


def write_ply(path, vertices, faces):
    with open(path, "wb") as out:
        out.write(("ply\nformat binary_little_endian 1.0\n"
                   f"element vertex {len(vertices)}\nproperty float x\nproperty float y\n"
                   f"property float z\nelement face {len(faces)}\n"
                   "property list uchar int vertex_indices\nend_header\n").encode())
        for vertex in vertices:
            out.write(struct.pack("<3f", *vertex))
        for face in faces:
            out.write(struct.pack("<B3i", 3, *face))


def sixfold():
    turns = []
    for k in range(1, 6):
        R = rotation((0, 0, 1), k * math.pi / 3)
        turns.append(R[0:3] + [0.0] + R[3:6] + [0.0] + R[6:9] + [0.0] + [0.0, 0.0, 0.0, 1.0])
    return turns


def make_dataset(root, rng):
    """Three parts, each in a scene of its own, and a scene with all of them."""
    (root / "models").mkdir(parents=True)
    vertices, faces = prism(5, 20, 30)
    vertices[0] = (vertices[0][0] + 15, vertices[0][1] - 4, vertices[0][2])  # no symmetry left
    shapes = {1: (vertices, faces), 2: prism(6, 14, 40), 3: prism(48, 12, 50, (3, -2, 1))}
    info = {}
    for obj_id, (points, triangles) in shapes.items():
        write_ply(root / f"models/obj_{obj_id:06d}.ply", points, triangles)
        info[obj_id] = {"diameter": max(math.dist(a, b) for a in points for b in points)}
    info[2]["symmetries_discrete"] = sixfold()
    info[3]["symmetries_continuous"] = [{"axis": [0, 0, 2], "offset": [3, -2, 1]}]
    flip = rotation((1, 0, 0), math.pi)
    offset = [0.0, -4.0, 2.0]  # half a turn about the line through the cylinder's centre
    rows = [[*flip[3 * i:3 * i + 3], offset[i]] for i in range(3)]
    info[3]["symmetries_discrete"] = [sum(rows, []) + [0.0, 0.0, 0.0, 1.0]]
    (root / "models/models_info.json").write_text(json.dumps(info))
    for scene, kinds in ((1, [1]), (2, [2]), (3, [3]), (4, [1, 2, 3])):
        make_scene(root / f"test/{scene:06d}", rng, kinds)


def make_scene(folder, rng, kinds):
    folder.mkdir(parents=True)
    camera, truth, visible = {}, {}, {}
    for image in (0, 1, 5):
        entry = {"cam_K": [900, 0, 320, 0, 905, 240, 0, 0, 1], "depth_scale": 0.1}
        if image != 5:
            entry["roi"] = [60, 40, 500, 380]
        camera[image] = entry
        truth[image], visible[image] = [], []
        for _ in range(14):
            t = [rng.uniform(-170, 170), rng.uniform(-130, 130), rng.uniform(550, 620)]
            truth[image].append({"obj_id": rng.choice(kinds), "cam_R_m2c": random_rotation(rng),
                                 "cam_t_m2c": t})
            visible[image].append({"visib_fract": rng.choice([0.05, 0.4, 0.7, 0.8, 0.9, 1.0])})
    for name, data in (("camera", camera), ("gt", truth), ("gt_info", visible)):
        (folder / f"scene_{name}.json").write_text(json.dumps(data))


def random_results(dataset, rng, path):
    """Perturbed, duplicated, swapped, missing and invented detections with tied scores."""
    rows = []
    for scene in sorted((dataset / "test").iterdir()):
        truth = json.loads((scene / "scene_gt.json").read_text())
        for image, instances in truth.items():
            seconds = rng.choice([-1, rng.uniform(0.01, 0.4)])
            for g in instances:
                R, t = g["cam_R_m2c"], g["cam_t_m2c"]
                found = [moved(rng, R, t, 0.8, 1.5)] if rng.random() < 0.85 else []
                if rng.random() < 0.4:
                    found.append(at_the_limit(rng, R, t))
                if rng.random() < 0.25:
                    found.append(moved(rng, R, t, 1.5, 2.5))
                if rng.random() < 0.3:
                    found.append(moved(rng, R, t, 4.0, 6.0))
                if rng.random() < 0.2:
                    found.append((random_rotation(rng), moved(rng, R, t, 5.0, 1.0)[1]))
                if rng.random() < 0.2:
                    found.append((matrix_product(R, rotation((0, 0, 1), math.pi / 3)), t))
                for pose in found:
                    score = round(rng.random(), rng.choice([1, 2, 6]))
                    rows.append((int(scene.name), int(image), g["obj_id"], score, *pose, seconds))
    rng.shuffle(rows)
    with open(path, "w", newline="", encoding="utf-8") as out:
        writer = csv.writer(out)
        if rng.random() < 0.5:
            writer.writerow("scene_id,im_id,obj_id,score,R,t,time".split(","))
        for scene, image, obj_id, score, R, t, seconds in rows:
            writer.writerow([scene, image, obj_id, score, " ".join(map(repr, R)),
                             " ".join(map(repr, t)), seconds])


def differences(name, mine, reference, keys=KEYS):
    found = []
    for key in keys:
        if key not in reference:
            continue
        a, b = mine.get(key), reference[key]
        a_list, b_list = (v if isinstance(v, list) else [v] for v in (a, b))
        tolerance = TOLERANCE_OF.get(key, TOLERANCE)
        same = len(a_list) == len(b_list) and all(
            p == q or (p is not None and q is not None and abs(p - q) <= tolerance)
            for p, q in zip(a_list, b_list))
        if not same:
            found.append(f"{name}: {key}: {a} here, {b} there")
    return found


def compare(mine, reference):
    found = []
    for group in ("parts", "mixed"):
        if len(mine[group]) != len(reference[group]):
            found.append(f"{group}: {len(mine[group])} here, {len(reference[group])} there")
        for a, b in zip(mine[group], reference[group]):
            name = f"{group}, object {b['obj_id']}, scene {b['mixed_scene']}"
            found += differences(name, a, b, ("obj_id", "mixed_scene") + KEYS)
            found += differences(name + ", fixed", a["fixed"], b["fixed"])
    for group in ("mean", "mixed_mean"):
        if mine[group] and reference[group]:
            found += differences(group, mine[group], reference[group])
        elif bool(mine[group]) != bool(reference[group]):
            found.append(f"{group}: only one side has it")
    return found


def run_json(command):
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    if run.returncode != 0:
        sys.exit(f"{' '.join(command)} failed:\n{run.stderr}")
    return json.loads(run.stdout)


def compare_on(program, scorer, dataset, rounds, rng, folder):
    faults, parts = [], 0
    results = str(Path(folder) / "results.csv")
    for _ in range(rounds):
        random_results(dataset, rng, results)
        common = [str(dataset), results, "--json", "-", "--threshold", "0.5"]
        mine = run_json([program, "score"] + common)
        reference = run_json([sys.executable, scorer] + common)
        faults += compare(mine, reference)
        parts += len(reference["parts"]) + len(reference["mixed"])
    print(f"{dataset.name}: {rounds} random results, {parts} parts compared, "
          f"{len(faults)} differences")
    return faults


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    scorer = os.environ.get("BINPICK_SCORER", "")
    if not Path(scorer).is_file():
        skip("BINPICK_SCORER names no scorer script")
    try:
        import numpy  # noqa: F401, the scorer needs it
    except ImportError:
        skip("numpy is not installed")
    seed = int(os.environ.get("BINPICK_SEED", "7"))
    print("seed", seed, "(BINPICK_SEED sets another)")
    rng = random.Random(seed)
    faults = []
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / "made"
        make_dataset(made, rng)
        faults += compare_on(sys.argv[1], scorer, made, ROUNDS, rng, folder)
        for dataset in sys.argv[2:]:
            faults += compare_on(sys.argv[1], scorer, Path(dataset), 1, rng, folder)
    for fault in faults[:40]:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
