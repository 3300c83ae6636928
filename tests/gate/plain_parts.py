"""Six plain parts of few triangles, as PLY files (mm) with their symmetries: what the gate's data
set is made of. Two can be turned by any angle, one by a sixth, two by a half, one by none."""

import json
import math

SIDES = 48  # of a turned part


def is_ear(corner, before, after, others):
    """Whether the triangle turns to the left and holds none of the other corners."""
    def turn(a, b, c):
        return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])

    if turn(before, corner, after) <= 0:
        return False
    return not any(turn(before, corner, p) >= 0 and turn(corner, after, p) >= 0 and
                   turn(after, before, p) >= 0 for p in others)


def triangulated(outline):
    """Triangles of a simple polygon that runs counter-clockwise, as indices."""
    left, triangles = list(range(len(outline))), []
    while len(left) > 2:
        for k, i in enumerate(left):
            h, j = left[k - 1], left[(k + 1) % len(left)]
            others = [outline[m] for m in left if m not in (h, i, j)]
            if is_ear(outline[i], outline[h], outline[j], others):
                triangles.append((h, i, j))
                left.pop(k)
                break
        else:
            raise ValueError("an outline crosses itself")
    return triangles


def prism(outline, low, high):
    corners = [(x, y, z) for z in (low, high) for x, y in outline]
    n = len(outline)
    faces = []
    for a, b, c in triangulated(outline):
        faces += [(a, c, b), (n + a, n + b, n + c)]
    for i in range(n):
        j = (i + 1) % n
        faces += [(i, j, n + j), (i, n + j, n + i)]
    return corners, faces


def turned(profile):
    """About z. The profile holds (radius, z), from one point on the axis to another, upwards."""
    corners = [(r * math.cos(a), r * math.sin(a), z) for r, z in profile
               for a in (2 * math.pi * k / SIDES for k in range(SIDES))]
    faces = []
    for ring in range(len(profile) - 1):
        for k in range(SIDES):
            a, b = ring * SIDES + k, ring * SIDES + (k + 1) % SIDES
            c, d = a + SIDES, b + SIDES
            if profile[ring][0] > 0:
                faces.append((a, b, d))
            if profile[ring + 1][0] > 0:
                faces.append((a, d, c))
    return corners, faces


def joined(*solids):
    corners, faces = [], []
    for more_corners, more_faces in solids:
        faces += [tuple(len(corners) + i for i in face) for face in more_faces]
        corners += more_corners
    return corners, faces


def hexagon(radius):
    return [(radius * math.cos(k * math.pi / 3), radius * math.sin(k * math.pi / 3))
            for k in range(6)]


def turns_about_z(folds):
    """All that leave a part with so many equal sides as it is, as models_info.json has them."""
    poses = []
    for k in range(1, folds):
        c, s = math.cos(2 * math.pi * k / folds), math.sin(2 * math.pi * k / folds)
        poses.append([c, -s, 0, 0, s, c, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])
    return {"symmetries_discrete": poses}


ANY_TURN = {"symmetries_continuous": [{"axis": [0, 0, 1], "offset": [0, 0, 0]}]}
HALF_TURN_ABOUT_Y = {"symmetries_discrete": [[-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1]]}


def pin():
    return turned([(0, -24), (5, -24), (5, -6), (10, -6), (10, 0), (7, 0), (7, 16), (4, 16),
                   (4, 24), (0, 24)]), ANY_TURN


def cup():
    return turned([(0, 0), (13, 0), (16, 24), (14, 24), (11.2, 2), (0, 2)]), ANY_TURN


def stud():
    shaft = turned([(0, 6), (5.5, 6), (5.5, 34), (0, 34)])
    return joined(prism(hexagon(10), 0, 7), shaft), turns_about_z(6)


def channel():
    return prism([(-12, -8), (12, -8), (12, 8), (9, 8), (9, -5), (-9, -5), (-9, 8), (-12, 8)], -19,
                 19), HALF_TURN_ABOUT_Y


def slide():
    return joined(prism([(-17, -9), (17, -9), (17, 9), (-17, 9)], 0, 6),
                  prism([(-17, -5), (17, -5), (17, 5), (-17, 5)], 5.9, 12)), turns_about_z(2)


def hook():
    return prism([(0, 0), (38, 0), (38, 27), (23, 27), (23, 20), (31, 20), (31, 7), (7, 7), (7, 16),
                  (0, 16)], 0, 6), {}


PARTS = (pin, cup, stud, channel, slide, hook)
NAMES = {number: part.__name__ for number, part in enumerate(PARTS, start=1)}  # by object id


def centred(corners):
    middle = [(min(c[i] for c in corners) + max(c[i] for c in corners)) / 2 for i in range(3)]
    return [tuple(c[i] - middle[i] for i in range(3)) for c in corners]


def write_parts(folder):
    """Returns the files, in the order of the object ids."""
    folder.mkdir(parents=True)
    paths, info = [], {}
    for number, part in enumerate(PARTS, start=1):
        (corners, faces), symmetries = part()
        path = folder / f"obj_{number:06}.ply"
        lines = ["ply", "format ascii 1.0", f"element vertex {len(corners)}", "property float x",
                 "property float y", "property float z", f"element face {len(faces)}",
                 "property list uchar int vertex_indices", "end_header"]
        lines += ["%.5f %.5f %.5f" % corner for corner in centred(corners)]
        lines += ["3 %d %d %d" % face for face in faces]
        path.write_text("\n".join(lines) + "\n")
        paths.append(path)
        info[str(number)] = symmetries
    (folder / "models_info.json").write_text(json.dumps(info))
    return paths
