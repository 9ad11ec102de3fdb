"""Bodyopt's runtime: poses in, skin out. Units: metres, seconds, radians; quaternions x y z w.

    model = bodyopt.load("hero.safetensors")
    pose = model.bind_pose                       # joints x 10: translation, rotation, scale, of each joint
    skin = model.instance().evaluate(pose[None])  # frames x joints x 10, float64
    skin.positions                               # frames x vertices x 3, float32, in the vertex order of the character

Verbs of the program: bodyopt.run("train", "dataset", out="hero.safetensors"); see verbs.py.
"""

from ._runtime import (
    Call,
    Device,
    Error,
    Instance,
    Model,
    Skin,
    State,
    __version__,
    device_names,
    evaluate_together,
    load,
    load_from_memory,
    open_device,
)
from .verbs import run

__all__ = [
    "Call",
    "Device",
    "Error",
    "Instance",
    "Model",
    "Skin",
    "State",
    "__version__",
    "device_names",
    "evaluate_together",
    "load",
    "load_from_memory",
    "open_device",
    "run",
]
