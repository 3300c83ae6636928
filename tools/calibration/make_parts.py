#!/usr/bin/env python3
"""Writes a dozen plain mechanical parts as meshes (mm), with their symmetries, for piles on which
the score is fitted: plates, profiles, turned parts, blocks with pockets, rings. None of them is
a part of the development piles. Needs numpy and scipy.

usage: make_parts.py FOLDER [--held-out]      writes obj_NNNNNN.ply and models_info.json
"""
import json
import os
import sys

import numpy as np
from scipy.spatial import Delaunay

STEP_MM = 1.5  # along outlines


def dense(loop):
    """The loop with points at most STEP_MM apart."""
    loop = np.asarray(loop, float)
    out = []
    for a, b in zip(loop, np.roll(loop, -1, axis=0)):
        n = max(1, int(np.ceil(np.linalg.norm(b - a) / STEP_MM)))
        out += [a + (b - a) * k / n for k in range(n)]
    return np.array(out)


def circle(x, y, r, n=48, begin=0.0):
    a = begin + np.arange(n) * 2 * np.pi / n
    return np.c_[x + r * np.cos(a), y + r * np.sin(a)]


def inside(points, loop):
    """Even-odd rule."""
    x, y = points[:, 0], points[:, 1]
    hit = np.zeros(len(points), bool)
    for (x0, y0), (x1, y1) in zip(loop, np.roll(loop, -1, axis=0)):
        crosses = (y0 > y) != (y1 > y)
        with np.errstate(divide='ignore', invalid='ignore'):
            hit ^= crosses & (x < (x1 - x0) * (y - y0) / (y1 - y0) + x0)
    return hit


def area(loop):
    x, y = loop[:, 0], loop[:, 1]
    return 0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)


def extrude(outline, holes, z0, z1):
    """Triangles of a prism over a plane region."""
    loops = [dense(outline)] + [dense(h) for h in holes]
    loops = [l if (area(l) > 0) == (i == 0) else l[::-1] for i, l in enumerate(loops)]
    points = np.concatenate(loops)
    faces = Delaunay(points).simplices
    centres = points[faces].mean(axis=1)
    keep = inside(centres, loops[0])
    for hole in loops[1:]:
        keep &= ~inside(centres, hole)
    faces = faces[keep]
    a, b, c = (points[faces[:, i]] for i in range(3))
    u, v = b - a, c - a
    turn = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    faces = faces[np.abs(turn) > 1e-9]
    turn = turn[np.abs(turn) > 1e-9]
    faces = np.where((turn > 0)[:, None], faces, faces[:, ::-1])
    lift = lambda z: np.c_[points, np.full(len(points), z)]
    triangles = [lift(z1)[faces], lift(z0)[faces[:, ::-1]]]
    for loop in loops:
        low, high = np.c_[loop, np.full(len(loop), z0)], np.c_[loop, np.full(len(loop), z1)]
        low2, high2 = np.roll(low, -1, axis=0), np.roll(high, -1, axis=0)
        triangles += [np.stack([low, low2, high2], 1), np.stack([low, high2, high], 1)]
    return np.concatenate(triangles)


def revolve(profile, n=64):
    """Triangles of a turned solid; profile is a closed loop of (radius, z)."""
    profile = np.asarray(profile, float)
    a = np.arange(n) * 2 * np.pi / n
    ring = np.stack(
        [
            np.outer(np.cos(a), profile[:, 0]),
            np.outer(np.sin(a), profile[:, 0]),
            np.outer(np.ones(n), profile[:, 1]),
        ],
        -1,
    )
    nxt = np.roll(ring, -1, axis=0)
    p, q = ring, np.roll(ring, -1, axis=1)
    r, s = nxt, np.roll(nxt, -1, axis=1)
    triangles = np.concatenate(
        [np.stack([p, r, s], 2).reshape(-1, 3, 3), np.stack([p, s, q], 2).reshape(-1, 3, 3)]
    )
    u, v = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    triangles = triangles[np.linalg.norm(np.cross(u, v), axis=1) > 1e-9]
    volume = np.einsum(
        'ij,ij->i', triangles[:, 0], np.cross(triangles[:, 1], triangles[:, 2])
    ).sum()
    return triangles if volume > 0 else triangles[:, ::-1]


def along(triangles, axes):
    """Coordinates permuted cyclically: axes names where x, y, z go, such as 'yzx'."""
    order = {'xyz': (0, 1, 2), 'yzx': (2, 0, 1), 'zxy': (1, 2, 0)}[axes]
    return triangles[:, :, order]


def rectangle(x0, y0, x1, y1):
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


def turns(axis, count):
    """Symmetries of a part that looks the same after 1/count of a turn about z or x."""
    out = []
    for k in range(1, count):
        a = 2 * np.pi * k / count
        c, s = np.cos(a), np.sin(a)
        R = (
            [[c, -s, 0], [s, c, 0], [0, 0, 1]]
            if axis == 'z'
            else [[1, 0, 0], [0, c, -s], [0, s, c]]
        )
        out.append(np.array(R))
    return out


FLIP_X = np.diag([1.0, -1.0, -1.0])


def with_flips(rotations):
    return rotations + [FLIP_X] + [R @ FLIP_X for R in rotations]


def gear(teeth, inner, outer):
    loop = []
    for k in range(teeth):
        for share, r in ((0.0, inner), (0.18, inner), (0.30, outer), (0.70, outer), (0.82, inner)):
            a = 2 * np.pi * (k + share) / teeth
            loop.append((r * np.cos(a), r * np.sin(a)))
    return loop


def parts():
    """name, triangles, discrete symmetries, axis of continuous symmetry"""
    bracket = np.concatenate(
        [
            extrude(rectangle(0, 0, 40, 24), [circle(26, 7, 3), circle(26, 17, 3)], 0, 3),
            along(extrude(rectangle(0, 0, 24, 30), [circle(12, 20, 5)], 0, 3), 'yzx'),
        ]
    )
    yield 'angle bracket', bracket, [], None
    yield 'plate with cut corner', extrude(
        [(0, 0), (46, 0), (46, 20), (38, 28), (0, 28)],
        [circle(9, 14, 4), rectangle(20, 8, 34, 13)],
        0,
        2.5,
    ), [], None
    yield 'washer with tab', np.concatenate(
        [
            extrude(circle(0, 0, 15), [circle(0, 0, 8)], 0, 2),
            extrude(rectangle(-3, 14, 3, 22), [], 0, 2),
        ]
    ), [FLIP_X @ np.diag([-1.0, -1.0, 1.0])], None
    yield 'channel', along(
        extrude(
            [(0, 0), (22, 0), (22, 16), (19, 16), (19, 3), (3, 3), (3, 16), (0, 16)], [], 0, 38
        ),
        'yzx',
    ), [np.diag([-1.0, -1.0, 1.0])], None
    yield 'stepped shaft', revolve(
        [
            (0, -25),
            (6, -25),
            (6, -8),
            (11, -8),
            (11, -2),
            (8, -2),
            (8, 14),
            (4.5, 14),
            (4.5, 25),
            (0, 25),
        ]
    ), [], [0, 0, 1]
    nut = np.concatenate(
        [
            extrude(rectangle(-16, -8, 16, 8), [], 0, 6),
            extrude(rectangle(-16, -4.5, 16, 4.5), [], 5.9, 11),
        ]
    )
    yield 'slot nut', nut, turns('z', 2), None
    yield 'gear', extrude(gear(12, 13, 17), [circle(0, 0, 5)], -4, 4), with_flips(
        turns('z', 12)
    ), None
    yield 'cup', revolve([(0, 0), (14, 0), (17, 22), (15, 22), (12.3, 2), (0, 2)]), [], [0, 0, 1]
    wedge = along(extrude([(0, 0), (34, 0), (34, 6), (0, 20)], [circle(10, 8, 4)], 0, 16), 'yzx')
    yield 'wedge with bore', wedge, [], None
    hook = [
        (0, 0),
        (36, 0),
        (36, 26),
        (22, 26),
        (22, 20),
        (30, 20),
        (30, 6),
        (6, 6),
        (6, 14),
        (0, 14),
    ]
    yield 'hook', extrude(hook, [], 0, 5), [], None
    elbow = np.concatenate(
        [
            along(revolve([(0, -2), (8, -2), (8, 30), (5.5, 30), (5.5, 2), (0, 2)]), 'yzx'),
            revolve([(0, -6), (9, -6), (9, 22), (6, 22), (6, 2), (0, 2)]),
        ]
    )
    yield 'elbow', elbow, [], None
    block = np.concatenate(
        [
            extrude(rectangle(-15, -11, 15, 11), [circle(-6, 0, 5), circle(8, 0, 3.5)], 0, 14),
            extrude(rectangle(-15, -11, 15, 11), [], 0, 4),
            extrude(rectangle(11, -4, 18, 4), [], 2, 8),
        ]
    )
    yield 'block with pockets', block, [], None
    key = np.concatenate(
        [
            extrude(circle(0, 0, 11), [circle(0, 0, 5)], 0, 5),
            extrude(rectangle(8, -4, 44, 4), [], 0, 5),
            extrude(rectangle(34, 3, 40, 12), [], 0, 5),
        ]
    )
    yield 'lever', key, [], None
    stud = np.concatenate(
        [extrude(circle(0, 0, 9, 6), [], 0, 6), revolve([(0, 5), (5, 5), (5, 34), (0, 34)])]
    )
    yield 'hexagon stud', stud, turns('z', 6), None


def held_out_parts():
    """Parts that nothing is fitted to. Their truth holds up to the turns that differ by less than a
    sensor shows: the screw of the pulley, the nub of the housing, the odd hole of the flange."""
    pulley = np.concatenate(
        [
            revolve(
                [
                    (4, -7),
                    (16, -7),
                    (16, -5),
                    (12, 0),
                    (16, 5),
                    (16, 7),
                    (8, 7),
                    (8, 12),
                    (4, 12),
                ]
            ),
            along(extrude(circle(0, 9.5, 1.2, 16), [], 7.8, 8.4), 'yzx'),
        ]
    )
    yield 'pulley', pulley, [], [0, 0, 1]
    yield 'washer', extrude(circle(0, 0, 13), [circle(0, 0, 7)], 0, 2.5), [FLIP_X], [0, 0, 1]
    yield 'clevis pin', revolve(
        [(0, 0), (4.5, 0), (4.5, 2), (3, 2), (3, 31), (2.5, 32), (0, 32)]
    ), [], [0, 0, 1]
    housing = np.concatenate(
        [
            extrude(rectangle(-24, -15, 24, 15), [circle(-14, 0, 6), circle(14, 0, 6)], 0, 12),
            extrude(rectangle(-24, -15, 24, 15), [], 0, 3),
            extrude(rectangle(-4, -15, 4, 15), [], 11, 17),
            extrude(circle(19, 11, 1.5, 16), [], 11.5, 13.5),
        ]
    )
    yield 'housing', housing, turns('z', 2), None
    yield 'rod', revolve([(0, -20), (3, -20), (3, 20), (0, 20)]), [FLIP_X], [0, 0, 1]
    yield 'ring', revolve(
        [(12, -3), (17, -3), (18, -2), (18, 2), (17, 3), (12, 3)]
    ), [FLIP_X], [0, 0, 1]
    flange = np.concatenate(
        [
            extrude(
                rectangle(-18, -18, 18, 18),
                [circle(0, 0, 8)]
                + [circle(12.5 * i, 12.5 * j, 2.5 if i + j else 2.2, 20)
                   for i, j in ((1, 1), (-1, 1), (-1, -1), (1, -1))],
                0,
                5,
            ),
            extrude(circle(0, 0, 11), [circle(0, 0, 8)], 5, 14),
        ]
    )
    yield 'flange', flange, turns('z', 4), None
    yield 'sheet bracket', np.concatenate(
        [
            extrude(rectangle(0, 0, 50, 20), [circle(38, 10, 4)], 0, 1.5),
            along(extrude(rectangle(0, 0, 20, 18), [], 0, 1.5), 'yzx'),
        ]
    ), [], None
    tee = np.concatenate(
        [
            along(revolve([(5, -22), (8, -22), (8, 22), (5, 22)]), 'yzx'),
            revolve([(5, 6), (8, 6), (8, 24), (5, 24)]),
        ]
    )
    yield 'tee', tee, turns('z', 2), None
    yield 'nozzle', revolve(
        [(2, 0), (9, 0), (9, 6), (5, 10), (5, 22), (3.5, 30), (2, 30)]
    ), [], [0, 0, 1]
    yield 'latch', extrude(
        [(0, 0), (40, 0), (40, 8), (30, 8), (26, 18), (12, 18), (12, 8), (0, 8)],
        [circle(6, 4, 2.2, 20)],
        0,
        7,
    ), [], None
    wing = np.concatenate(
        [
            revolve([(3, 0), (7, 0), (6, 9), (3, 9)]),
            along(extrude([(2, 6), (8, 4), (18, 14), (14, 18)], [], -1.5, 1.5), 'zxy')[
                :, ::-1, [1, 0, 2]
            ],
        ]
    )
    yield 'nut with wing', wing, [], None


def centred(triangles):
    corners = triangles.reshape(-1, 3)
    middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
    return triangles - middle


def write_ply(path, triangles):
    corners, index = np.unique(np.round(triangles.reshape(-1, 3), 5), axis=0, return_inverse=True)
    faces = index.reshape(-1, 3)
    faces = faces[
        (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 0] != faces[:, 2])
    ]
    with open(path, 'w') as out:
        out.write(
            'ply\nformat ascii 1.0\nelement vertex %d\n'
            'property float x\nproperty float y\nproperty float z\n'
            'element face %d\nproperty list uchar int vertex_indices\nend_header\n'
            % (len(corners), len(faces))
        )
        out.write(''.join('%.5f %.5f %.5f\n' % tuple(p) for p in corners))
        out.write(''.join('3 %d %d %d\n' % tuple(f) for f in faces))
    return corners


def main():
    folder = sys.argv[1]
    made = held_out_parts() if '--held-out' in sys.argv[2:] else parts()
    os.makedirs(folder, exist_ok=True)
    info = {}
    for number, (name, triangles, symmetries, axis) in enumerate(made, start=1):
        corners = write_ply('%s/obj_%06d.ply' % (folder, number), centred(triangles))
        low, size = corners.min(axis=0), np.ptp(corners, axis=0)
        hull = corners[
            np.unique(np.argmax(corners @ np.random.default_rng(1).normal(size=(3, 400)), axis=0))
        ]
        entry = {
            'name': name,
            'diameter': float(max(np.linalg.norm(hull - p, axis=1).max() for p in hull)),
        }
        for key, value, extent in zip('xyz', low, size):
            entry['min_' + key], entry['size_' + key] = float(value), float(extent)
        if symmetries:
            entry['symmetries_discrete'] = [
                [*R[0], 0, *R[1], 0, *R[2], 0, 0, 0, 0, 1] for R in np.array(symmetries).tolist()
            ]
        if axis:
            entry['symmetries_continuous'] = [{'axis': axis, 'offset': [0, 0, 0]}]
        info[str(number)] = entry
    json.dump(info, open(folder + '/models_info.json', 'w'), indent=1)


if __name__ == '__main__':
    main()
