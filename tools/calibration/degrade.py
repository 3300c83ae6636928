#!/usr/bin/env python3
"""Copies a data set in BOP layout with worse sensors: per frame, depth noise of 0.2 to 1.2 pixel
footprints, patches without depth, weaker contrast, blur, noise of the intensity. The score has to
mean the same for these.

usage: degrade.py FROM TO [SEED]      needs numpy and OpenCV
"""
import json
import os
import shutil
import sys

import cv2
import numpy as np


def worse_depth(depth_mm, fx, rng):
    noise = rng.normal(size=depth_mm.shape).astype(np.float32)
    noise = cv2.GaussianBlur(noise, (0, 0), 0.8)
    noise /= noise.std()
    out = depth_mm + noise * rng.uniform(0.2, 1.2) * depth_mm / fx
    patches = cv2.GaussianBlur(rng.normal(size=depth_mm.shape).astype(np.float32), (0, 0), 4)
    holes = patches > np.quantile(patches, 1 - rng.uniform(0, 0.15))
    return np.where((depth_mm > 0) & ~holes, np.maximum(out, 0), 0)


def worse_gray(gray, rng):
    out = cv2.GaussianBlur(gray.astype(np.float32), (0, 0), rng.uniform(0.4, 1.6))
    out = out.mean() + (out - out.mean()) * rng.uniform(0.3, 0.9)
    return np.clip(out + rng.normal(size=gray.shape) * rng.uniform(1, 4), 0, 255).astype(np.uint8)


def main():
    source, target = sys.argv[1:3]
    rng = np.random.default_rng(int(sys.argv[3]) if len(sys.argv) > 3 else 1)
    shutil.copytree(source + '/models', target + '/models', dirs_exist_ok=True)
    for scene in sorted(os.listdir(source + '/test')):
        here, there = '%s/test/%s' % (source, scene), '%s/test/%s' % (target, scene)
        if not os.path.exists(here + '/scene_gt_info.json'):
            continue
        os.makedirs(there + '/depth', exist_ok=True)
        os.makedirs(there + '/gray', exist_ok=True)
        for name in os.listdir(here):
            if name.endswith('.json'):
                shutil.copy(here + '/' + name, there)
        cameras = json.load(open(here + '/scene_camera.json'))
        for image, camera in cameras.items():
            file = '%06d.png' % int(image)
            depth = cv2.imread('%s/depth/%s' % (here, file), cv2.IMREAD_UNCHANGED)
            scale = camera.get('depth_scale', 1.0)
            worse = worse_depth(depth.astype(np.float32) * scale, camera['cam_K'][0], rng)
            cv2.imwrite(
                '%s/depth/%s' % (there, file),
                np.clip(np.round(worse / scale), 0, 65535).astype(np.uint16),
            )
            gray = cv2.imread('%s/gray/%s' % (here, file), cv2.IMREAD_GRAYSCALE)
            cv2.imwrite('%s/gray/%s' % (there, file), worse_gray(gray, rng))


if __name__ == '__main__':
    main()
