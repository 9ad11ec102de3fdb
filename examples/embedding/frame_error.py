"""Plots how far Direct Delta Mush alone is off what was learned: frame_error.py BASIS.safetensors JOINT OUT.svg"""
import sys

import bodyopt
import numpy as np

basis, joint, out = sys.argv[1:]
model = bodyopt.load(basis)
pose = model.bind_pose[None]
q = pose[0, int(joint), 3:7]  # its rotation, times 45 degrees about z
q[:] = np.cos(np.pi / 8) * q + np.sin(np.pi / 8) * q[[1, 0, 3, 2]] * [1, -1, 1, -1]
instance = model.instance()
learned = instance.evaluate(pose, normals=False).positions
instance.set_weights(correction=0)
error = np.sort(1e3 * np.linalg.norm(instance.evaluate(pose, normals=False).positions - learned, axis=2)[0])
curve = " ".join(f"{600 * i / len(error):.1f},{290 - 270 * e / (error[-1] or 1):.1f}" for i, e in enumerate(error))
with open(out, "w") as svg:
    svg.write(f'<svg xmlns="http://www.w3.org/2000/svg" width="600" height="300"><polyline points="{curve}" '
              f'fill="none" stroke="#06c"/><text x="9" y="20">vertices by error, up to {error[-1]:.2f} mm</text></svg>')
print(f"{model.joint_names[int(joint)]}: RMS {np.sqrt(np.mean(error**2)):.3f} mm, largest {error[-1]:.3f} mm")
