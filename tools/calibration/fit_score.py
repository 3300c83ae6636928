#!/usr/bin/env python3
"""Fits the weights of the score (core/pose/score_weights.hpp) to what `binpick eval --evidence`
wrote.

usage: fit_score.py DATASET=EVIDENCE.csv... --depth-alone DATASET=EVIDENCE.csv...
           --intensity-alone DATASET=EVIDENCE.csv... [--check ...] [--check-depth-alone ...]
           [--check-intensity-alone ...] [--header FILE]

A logistic model by maximum likelihood with a small quadratic penalty; every part of every data
set has the same weight in all. A detection is right when it is within 5 mm and 7.5 deg per axis
(or, for parts whose diameter is below 67 mm, 7.5 % of it) of a part in the scene, whatever can be
seen of that. Frames without intensity (--depth-alone) and frames without depth
(--intensity-alone) have weights of their own; a table whose data sets are left out stays as it
stands in FILE. Data sets under --check are not fitted; for all it prints how the probability
holds: of the detections with a probability around p, the share that is right. Needs numpy and
scipy.
"""
import csv
import json
import re
import sys

import numpy as np
from scipy.optimize import minimize

TERMS_FROM = 6  # columns before: scene, image, object, score, R, t
LIMIT_MM, LIMIT_DEG = 5.0, 7.5
PENALTY = 2.0
WEIGHT_PER_PART = 300.0


def rotation_vector_deg(R):
    cos = np.clip((np.trace(R) - 1) / 2, -1, 1)
    angle = np.arccos(cos)
    v = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    if angle < 1e-9:
        return v * 0
    if np.pi - angle < 1e-4:
        return np.full(3, 180.0)
    return np.degrees(angle) * v / (2 * np.sin(angle))


def turned_about(axis, angle):
    K = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


class Part:
    def __init__(self, info):
        self.limit_mm = min(LIMIT_MM, 0.075 * info['diameter'])
        self.diameter = info['diameter']
        self.same = [(np.eye(3), np.zeros(3))]
        for m in info.get('symmetries_discrete', []):
            m = np.array(m, float).reshape(4, 4)
            self.same.append((m[:3, :3], m[:3, 3]))
        axes = [np.array(s['axis'], float) for s in info.get('symmetries_continuous', [])]
        self.axis = axes[0] / np.linalg.norm(axes[0]) if axes else None

    def right(self, R, t, truth_R, truth_t):
        for S, s in self.same:
            base = truth_R @ S
            if self.axis is not None:
                Q = base.T @ R
                v = np.array([Q[2, 1] - Q[1, 2], Q[0, 2] - Q[2, 0], Q[1, 0] - Q[0, 1]])
                base = base @ turned_about(
                    self.axis, np.arctan2(self.axis @ v, np.trace(Q) - self.axis @ Q @ self.axis)
                )
            off_mm = np.abs(t - truth_R @ s - truth_t).max()
            if off_mm < self.limit_mm and np.abs(rotation_vector_deg(R @ base.T)).max() < LIMIT_DEG:
                return True
        return False


def numbers(text):
    return np.array([float(x) for x in text.split()])


def load(argument):
    """terms, right or not, part (an int) of each detection"""
    folder, evidence = argument.rsplit('=', 1)
    info = json.load(open(folder + '/models/models_info.json'))
    parts = {int(k): Part(v) for k, v in info.items()}
    truths, terms, right, part = {}, [], [], []
    with open(evidence) as file:
        rows = csv.reader(file)
        names = next(rows)[TERMS_FROM:]
        for row in rows:
            scene, image, obj = int(row[0]), row[1], int(row[2])
            if scene not in truths:
                truths[scene] = json.load(open('%s/test/%06d/scene_gt.json' % (folder, scene)))
            R, t = numbers(row[4]).reshape(3, 3), numbers(row[5])
            p = parts[obj]
            hit = False
            for g in truths[scene][image]:
                truth_t = np.array(g['cam_t_m2c'], float)
                if g['obj_id'] == obj and np.linalg.norm(truth_t - t) < p.diameter:
                    hit = hit or p.right(
                        R, t, np.array(g['cam_R_m2c'], float).reshape(3, 3), truth_t
                    )
            terms.append([float(x) for x in row[TERMS_FROM:]])
            right.append(hit)
            part.append(obj)
    return names, np.array(terms), np.array(right, float), np.array(part)


# Evidence against a pose; all other terms speak for it. No weight may have the other sign.
AGAINST = {'contradicted', 'hidden', 'outline_bare', 'outline_offset', 'conflicts'}


def fit(names, terms, right, weight):
    mean, spread = terms.mean(axis=0), terms.std(axis=0)
    spread[spread < 1e-6] = np.inf  # says nothing here: weight 0
    Z = np.c_[(terms - mean) / spread, np.ones(len(terms))]

    def loss(b):
        z = Z @ b
        value = (weight * (np.logaddexp(0, z) - right * z)).sum() + PENALTY * (b[:-1] ** 2).sum()
        slope = Z.T @ (weight * (1 / (1 + np.exp(-z)) - right))
        slope[:-1] += 2 * PENALTY * b[:-1]
        return value, slope

    bounds = [(None, 0) if n in AGAINST else (0, None) for n in names] + [(None, None)]
    start = np.zeros(Z.shape[1])
    b = minimize(loss, start, jac=True, method='L-BFGS-B', bounds=bounds).x
    weights = b[:-1] / spread
    return weights, b[-1] - weights @ mean


def report(name, probability, right):
    print(name, len(right), 'detections')
    for low, high in (
        (0, 0.05),
        (0.05, 0.2),
        (0.2, 0.5),
        (0.5, 0.8),
        (0.8, 0.95),
        (0.95, 0.99),
        (0.99, 1.001),
    ):
        band = (probability >= low) & (probability < high)
        if band.any():
            print(
                '  probability %.2f..%.2f: %4d, mean %.3f, right %.3f'
                % (low, high, band.sum(), probability[band].mean(), right[band].mean())
            )


TABLE = '''inline constexpr ScoreWeights %s = {
%s};
'''
HEADER = '''// Written by tools/calibration/fit_score.py; not by hand.
#pragma once

#include <array>

#include "binpick/report/detection.hpp"

namespace binpick {

// One for each ScoreTerm, and the constant.
using ScoreWeights = std::array<double, kScoreTermCount + 1>;

%s
}  // namespace binpick
'''


# Fits one table to the data sets, prints it and how it holds; the table as C++ text.
def table_of(name, fitted, checked):
    sets = [load(a) for a in fitted]
    weight = np.concatenate(
        [[WEIGHT_PER_PART / (part == p).sum() for p in part] for _, _, _, part in sets]
    )
    terms, right = (np.concatenate([s[i] for s in sets]) for i in (1, 2))
    weights, one = fit(sets[0][0], terms, right, weight)
    print(name)
    for term, value in zip(sets[0][0], weights):
        print('%-20s %8.4f' % (term, value))
    print('%-20s %8.4f' % ('one', one))
    for argument, (_, t, r, _) in [*zip(fitted, sets), *((a, load(a)) for a in checked)]:
        report(argument.rsplit('=', 1)[0], 1 / (1 + np.exp(-(t @ weights + one))), r)
    rows = [*zip(weights, sets[0][0]), (one, 'constant')]
    lines = ''.join('    %.4f,  // %s\n' % row for row in rows)
    return TABLE % (name, lines)


# The option that names the data sets of each table, '' for those named first.
TABLES = {
    'kScoreWeights': '',
    'kScoreWeightsOfDepthAlone': '-depth-alone',
    'kScoreWeightsOfIntensityAlone': '-intensity-alone',
}


# As it stands in the header.
def kept_table(name, text):
    found = re.search(r'inline constexpr ScoreWeights %s = \{\n.*?\};\n' % name, text, re.DOTALL)
    if not found:
        sys.exit('%s: neither data sets nor a table in the header' % name)
    return found.group()


def main():
    sets = {'-' + o if o else '': [] for o in TABLES.values()}
    sets.update({'--check' + o: [] for o in TABLES.values()})
    header, into = None, ''
    arguments = iter(sys.argv[1:])
    for a in arguments:
        if a == '--header':
            header = next(arguments)
        elif a in sets:
            into = a
        else:
            sets[into].append(a)
    fitted = {name: sets['-' + o if o else ''] for name, o in TABLES.items()}
    if not any(fitted.values()):
        sys.exit(__doc__)
    tables = {
        name: table_of(name, fitted[name], sets['--check' + option])
        for name, option in TABLES.items()
        if fitted[name]
    }
    if header:
        present = open(header).read()
        text = [tables.get(name) or kept_table(name, present) for name in TABLES]
        open(header, 'w').write(HEADER % '\n'.join(text))


if __name__ == '__main__':
    main()
