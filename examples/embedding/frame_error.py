"""Plots, for one turned joint, how far Direct Delta Mush alone is off what was learned, vertex by vertex.

    frame_error.py BASIS.safetensors JOINT OUT.svg
"""
import sys

import bodyopt
import numpy as np

basis, joint, out = sys.argv[1:]
model = bodyopt.load(basis)
pose = model.bind_pose
x, y, z, w = pose[int(joint), 3:7]
s, c = np.sin(np.pi / 8), np.cos(np.pi / 8)  # half of 45 degrees, about z
pose[int(joint), 3:7] = x * c + y * s, y * c - x * s, z * c + w * s, w * c - z * s

instance = model.instance()
learned = instance.evaluate(pose[None]).positions[0].copy()
instance.set_weights(correction=0)
error = np.sort(1e3 * np.linalg.norm(instance.evaluate(pose[None]).positions[0] - learned, axis=1))
if error[-1] == 0:
    sys.exit(f"{basis}: nothing that was learned moves with joint {joint}")

points = " ".join(f"{20 + 560 * i / len(error):.1f},{280 - 250 * e / error[-1]:.1f}" for i, e in enumerate(error))
with open(out, "w") as svg:
    svg.write('<svg xmlns="http://www.w3.org/2000/svg" width="600" height="300" font-family="sans-serif" font-size="13">'
              f'<polyline points="{points}" fill="none" stroke="#06c" stroke-width="2"/><path d="M20 20V280H580" '
              f'fill="none" stroke="#888"/><text x="28" y="30">largest {error[-1]:.2f} mm</text>'
              '<text x="330" y="296">vertices, from least to most wrong</text></svg>')
print(f"{model.joint_names[int(joint)]}: RMS {np.sqrt(np.mean(error**2)):.3f} mm, largest {error[-1]:.3f} mm")
