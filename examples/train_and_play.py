#!/usr/bin/env python3
"""Trains a character and measures how far a clip takes its skin beyond what was learned, with the module `bodyopt`.

    train_and_play.py hero.glb walk.glb hero.safetensors    # a draft of the range of motion is simulated first: minutes
"""
import sys

import bodyopt
import numpy as np


def tell(what, done, total, seconds):
    print(f"\r{what}: {100 * done / max(total, 1):3.0f} % in {seconds:.0f} s", end="\033[K", flush=True)


character, clip, basis = sys.argv[1:]
try:
    trained = bodyopt.run("train", character, out=basis, progress=tell)
    coverage = bodyopt.run("coverage", basis, clip=clip)
    shot = bodyopt.run("eval", basis, clip=clip, out="shot.glb", character=character, rig="rig.glb")
except bodyopt.Error as error:
    sys.exit(f"{error} ({error.code})")
print("\n", *(f"{name}: {len(part) if isinstance(part, list) else part}\n" for name, part in coverage.items()))

# The same skin in this process, written where a host wants it: here one joint is turned a little more in every frame.
model = bodyopt.load(basis)
poses = np.repeat(model.bind_pose[None], 24, axis=0)
angles = np.linspace(0, np.pi / 4, 24)
poses[:, -1, 3:7] = np.stack([np.sin(angles / 2), 0 * angles, 0 * angles, np.cos(angles / 2)], axis=1)
vertices = np.zeros((24, model.vertex_count, 8), np.float32)
skin = model.instance().evaluate(poses, positions=vertices[:, :, :3], normals=vertices[:, :, 3:6])
moved = np.linalg.norm(vertices[-1, :, :3] - vertices[0, :, :3], axis=1).max()
print(f"{shot['points']} points; '{model.joint_names[-1]}' turned by 45 degrees moves them by up to {1e3 * moved:.1f} mm")
