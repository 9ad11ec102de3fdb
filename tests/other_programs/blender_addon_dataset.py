# blender --background --factory-startup --python blender_addon_dataset.py -- ADDON.zip BODYOPT FOLDER
# A dataset that the add-on makes of shape keys, smoothed above the armature, trains as the same frames do that go to
# `dataset add` as files; the mesh that it is of shows the basis, though its file has other vertices.
import json
import math
import os
import subprocess
import sys

import bpy
import numpy

sys.path.append(os.path.dirname(__file__))
import addon

zip_file, bodyopt, folder = sys.argv[sys.argv.index("--") + 1:]
character = f"{folder}/character.glb"
addon.install(zip_file)
from bodyopt_blender import bake, live

bpy.context.preferences.addons["bodyopt_blender"].preferences.program = bodyopt
addon.begin()
scene = bpy.context.scene
scene.name, scene.frame_end = "bulges", 95
armature, mesh = addon.add_character(character, moves=False)
random = numpy.random.default_rng(1)
for bone in armature.pose.bones:
    bone.rotation_mode = "XYZ"
    for frame in range(0, 96, 5):
        bone.rotation_euler = random.uniform(-0.4, 0.4, 3) if frame else (0, 0, 0)
        bone.keyframe_insert("rotation_euler", frame=frame)
wrist = armature.pose.bones["wrist"]
wrist.keyframe_delete("rotation_euler", frame=0)  # moved by a constraint in place of its own keys
follow = wrist.constraints.new("COPY_ROTATION")
follow.target, follow.subtarget, follow.target_space, follow.owner_space = armature, "elbow", "LOCAL", "LOCAL"

# The sculptor's muscle: it swells with the elbow's bend.
mesh.shape_key_add(name="Basis")
swollen = mesh.shape_key_add(name="swollen")
swollen.slider_min, swollen.slider_max = -1, 1
elbow = armature.data.bones["elbow"].head_local
for vertex, point in zip(mesh.data.vertices, swollen.data):
    point.co += 0.02 * math.exp(-((vertex.co - elbow).length / 0.1) ** 2) * vertex.normal
driver = swollen.driver_add("value").driver
driver.type = "SCRIPTED"
variable = driver.variables.new()
variable.name, variable.type = "bend", "TRANSFORMS"
variable.targets[0].id, variable.targets[0].bone_target = armature, "elbow"
variable.targets[0].transform_type, variable.targets[0].transform_space = "ROT_X", "LOCAL_SPACE"
driver.expression = "2 * bend"
smooth = mesh.modifiers.new("Smooth", "CORRECTIVE_SMOOTH")
smooth.iterations = 3



def refused(operator, said):
    try:
        operator()
    except RuntimeError as error:
        assert said in str(error), error
    else:
        raise AssertionError(f"done in spite of: {said}")


refused(bpy.ops.bodyopt.add_take, "choose a folder")
scene.bodyopt_dataset = f"{folder}/of_blender"
refused(bpy.ops.bodyopt.train, "there is no dataset in")
mesh.modifiers.new("Subdivision", "SUBSURF")
objects = set(bpy.data.objects)
refused(bpy.ops.bodyopt.add_take, "switch off or apply those that do")
mesh.modifiers.remove(mesh.modifiers["Subdivision"])
bpy.context.preferences.addons["bodyopt_blender"].preferences.program = f"{folder}/nowhere"
refused(bpy.ops.bodyopt.add_take, "nowhere' does not run")
bpy.context.preferences.addons["bodyopt_blender"].preferences.program = bodyopt
assert set(bpy.data.objects) == objects, "copies are left in the scene"
assert os.listdir(scene.bodyopt_dataset) == [], "something half-written is left"
bpy.ops.bodyopt.add_take()
bpy.context.preferences.addons["bodyopt_blender"].preferences.program = f"{folder}/nowhere"
refused(bpy.ops.bodyopt.train, "nowhere' does not run")
bpy.context.preferences.addons["bodyopt_blender"].preferences.program = bodyopt
with open(f"{folder}/of_blender/bulges.glb", "rb") as file:
    poses = file.read()
refused(bpy.ops.bodyopt.add_take, "has the take 'bulges' already")
scene.name, scene.frame_end = "more of it", 3
bpy.ops.bodyopt.add_take()
scene.name, scene.frame_end = "bulges", 95
with open(f"{folder}/of_blender/dataset.json") as file:
    dataset = json.load(file)
assert [take["name"] for take in dataset["takes"]] == ["bulges", "more_of_it"], dataset
assert poses == open(f"{folder}/of_blender/bulges.glb", "rb").read(), "another take changes the poses of the first"
dataset["takes"].pop()
with open(f"{folder}/of_blender/dataset.json", "w") as file:
    json.dump(dataset, file)
bpy.ops.bodyopt.train(opens_report=False)
assert mesh.bodyopt.basis == f"{folder}/of_blender/basis.safetensors"

# A frame goes out, is sculpted by 10 mm, and comes back: opened again it is as it was sculpted. Undone, it is what it was.
frame = dict(take="bulges", frame=40)
refused(bpy.ops.bodyopt.keep_sculpt, "is no frame of a dataset")
refused(lambda: bpy.ops.bodyopt.open_frame(take="none", frame=40), "none")
shape_of = lambda obj: addon.points_of(obj)


def opened():
    bpy.ops.bodyopt.open_frame(**frame)
    return bpy.context.view_layer.objects.active


sculpted = opened()
before = shape_of(sculpted)
for vertex in sculpted.data.vertices:
    away = (vertex.co - sculpted.data.vertices[0].co).length
    vertex.co.z += 0.01 * max(0, 1 - (away / 0.1) ** 2)
bpy.ops.bodyopt.keep_sculpt()
after = opened()
moved = numpy.linalg.norm(shape_of(after) - before, axis=1)
print(f"sculpted: the frame is moved by {1e3 * moved.max():.3f} mm at most, where 10 were sculpted")
assert abs(moved.max() - 0.01) < 1e-5 and numpy.abs(shape_of(after) - shape_of(sculpted)).max() < 1e-5
subprocess.run([bodyopt, "curate", "undo", f"{folder}/of_blender"], check=True, capture_output=True)
assert numpy.abs(shape_of(opened()) - before).max() < 1e-6
for obj in [o for o in bpy.data.objects if "bodyopt_take" in o]:
    bpy.data.meshes.remove(obj.data)

# The same frames as files: the character's own, with the vertices in its order.
shapes = []
for frame in range(96):
    scene.frame_set(frame)
    points = addon.points_of(mesh)
    shapes.append(numpy.stack([points[:, 0], points[:, 2], -points[:, 1]], axis=1))
bake.write_pc2(f"{folder}/shapes.pc2", 0, shapes)
run = lambda *arguments: subprocess.run([bodyopt, *arguments], check=True, capture_output=True)
addon.activate(armature)
run("dataset", "add", f"{folder}/of_files", "--character", character, "--clip", addon.exported_clip(folder), "--fps", "30",
    "--first-frame", "0", "--frames", "0-95", "--shapes", f"{folder}/shapes.pc2", "--name", "bulges")
run("train", f"{folder}/of_files", "--out", f"{folder}/of_files/basis.safetensors", "--report", f"{folder}/of_files/report",
    "--heldout-every", "5")
errors = []
for dataset in ("of_blender", "of_files"):
    with open(f"{folder}/{dataset}/report/report.json") as file:
        errors.append(next(m["errors_mm"]["rms"] for m in json.load(file)["methods"] if m["name"].startswith("full")))
print(f"trained by the add-on {errors[0]:.4g} mm, by files {errors[1]:.4g} mm off on frames held out")
assert 0 < errors[1] < 0.5 and abs(errors[0] / errors[1] - 1) < 0.01

# Bound to the mesh that it was made of, whose glTF file has other vertices: what the modifiers made is what is shown.
mesh.shape_key_clear()
mesh.modifiers.remove(smooth)
addon.bind(mesh, mesh.bodyopt.basis)
off = []
for frame in range(0, 96, 3):
    scene.frame_set(frame)
    assert not live.errors, live.errors
    off.append(addon.points_of(mesh) - addon.z_up(shapes[frame]))
rms = 1e3 * numpy.sqrt((numpy.array(off) ** 2).sum(axis=2).mean())
print(f"live, {rms:.3g} mm off what the modifiers made")
assert rms < 0.2
