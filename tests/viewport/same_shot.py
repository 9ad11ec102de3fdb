"""The shot of same_shot_test.cpp by the Python module: same_shot.py DEVICE FPS FIRST; files are in the working folder."""
import sys

import bodyopt
import numpy as np

device, fps, first = sys.argv[1], float(sys.argv[2]), int(sys.argv[3])
model = bodyopt.load("hero.safetensors", "hero.dynamics.safetensors", attached="hero.attached.safetensors")
joints = np.fromfile("joints", np.float64).reshape(-1, len(model.joint_names), 10)
channels = np.fromfile("channels", np.float32).reshape(len(joints), len(model.channels))
instance = model.instance(bodyopt.open_device(device), jiggles=True)
instance.set_weights(0.75, 1.5)
instance.jiggle(joints[: first - 1], range(1, first), frames_per_second=fps, channels=channels[: first - 1])
skin = instance.jiggle(joints[first - 1 :], range(first, len(joints) + 1), frames_per_second=fps,
                       channels=channels[first - 1 :], goes_on=True)
skin.positions.tofile("whole.python")
skin.attached[0].tofile("whole.sleeve.python")
