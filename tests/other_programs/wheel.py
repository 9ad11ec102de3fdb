# python wheel.py, in the environment that wheel.sh makes: the verbs and the frames of the installed module.
import os
import struct
import subprocess
import sys
import threading
import time

import bodyopt
import numpy

steps = []
assert bodyopt.run("demo", quick=True, out="demo", progress=lambda *step: steps.append(step))
assert {what for what, done, total, _ in steps if done == total} >= {"simulate", "train: trade-off"}, steps[-3:]

# Frames are those of the program.
result = bodyopt.run("eval", "demo/basis.safetensors", clip="demo/heldout.glb", frames="1-5", device="cpu", out="shot.pc2",
                     rig="shot.glb")
assert result["points"] and result["rig"] == "shot.glb" and len(result["per_frame"]) == 5
with open("shot.pc2", "rb") as file:
    points, _, _, samples = struct.unpack("<iffi", file.read(32)[16:])
    shot = numpy.frombuffer(file.read(), "<f4").reshape(samples, points, 3)
model = bodyopt.load("demo/basis.safetensors")
buffer = numpy.empty((1, model.vertex_count, 3), numpy.float32)
skin = model.instance().evaluate(model.bind_pose[None], positions=buffer)
assert skin.positions is buffer or numpy.shares_memory(skin.positions, buffer)
assert points == model.vertex_count and numpy.isfinite(shot).all() and numpy.ptp(shot - buffer) > 0.01

# Other verbs, by their own names and options.
assert bodyopt.run("coverage", "demo/basis.safetensors", clip="demo/heldout.glb")
assert bodyopt.run("curate", "list", "demo/dataset") is not None
assert bodyopt.run("test", "demo/basis.safetensors", "demo/dataset")

# Refused as the program refuses.
for code, call in ((4, lambda: bodyopt.run("info", "nowhere.safetensors")),
                   (64, lambda: bodyopt.run("eval", "demo/basis.safetensors", clip="demo/heldout.glb", out="shot.txt")),
                   (64, lambda: bodyopt.run("view", "demo/basis.safetensors")),
                   (64, lambda: bodyopt.run("trian"))):
    try:
        call()
    except bodyopt.Error as error:
        assert error.code == code and str(error), (error.code, str(error))
    else:
        raise AssertionError("not refused")

# Cancelled from another thread while this one runs on; nothing is left of what it would have written.
cancel, ticks = threading.Event(), []


def train():
    try:
        bodyopt.run("simulate", "demo/character.glb", clip="demo/rom.glb", out="more", muscles="demo/muscles.json",
                    cancelled=cancel.is_set)
    except bodyopt.Error as error:
        ticks.append(error.code)


thread = threading.Thread(target=train)
thread.start()
time.sleep(2)
cancel.set()
thread.join(60)
assert ticks == [75], ticks

# Cancelled before it has begun, and when it has just begun: the same.
for answers in ([True], [False, True]):
    try:
        bodyopt.run("simulate", "demo/character.glb", clip="demo/rom.glb", out="more", muscles="demo/muscles.json",
                    cancelled=lambda: answers.pop(0))
    except bodyopt.Error as error:
        assert error.code == 75 and "interrupted" in str(error) and error.result is None, (error.code, str(error))
    else:
        raise AssertionError("not cancelled")

# What a callback raises ends the verb, too, and so does Ctrl-C, which a terminal sends to the program as well: the half of a
# cache that was written by then is gone.
SHOT = """
import os, sys, bodyopt
def look(what):
    if any(name.endswith(".tmp") for name in os.listdir("half")):
        what()
try:
    bodyopt.run("eval", "demo/basis.safetensors", clip="demo/heldout.glb", fps=20000, device="cpu", out="half/shot.pc2",
                cancelled=lambda: look(eval(sys.argv[1])))
except (ZeroDivisionError, KeyboardInterrupt) as error:
    print(type(error).__name__, os.listdir("half"))
"""
os.mkdir("half")
for what, said in (("lambda: 1 / 0", "ZeroDivisionError"), ("lambda: os.killpg(0, 2)", "KeyboardInterrupt"),
                   ("lambda: os.kill(os.getpid(), 2)", "KeyboardInterrupt")):
    done = subprocess.run([sys.executable, "-c", SHOT, what], start_new_session=True, capture_output=True, text=True)
    assert done.stdout == f"{said} []\n", (what, done.stdout, done.stderr)
print(f"{len(steps)} steps of progress, {samples} frames")
