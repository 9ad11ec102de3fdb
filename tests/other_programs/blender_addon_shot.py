# blender --background --factory-startup --python blender_addon_shot.py -- ADDON.zip BODYOPT FOLDER
# A bound character as a shot has it: strips and constraints, undo, edits and renderings, and two overrides of one asset. What it
# was not trained for is told and marked; texture coordinates and materials stay.
import math
import os
import sys

import bpy
import numpy

sys.path.append(os.path.dirname(__file__))
import addon

zip_file, _, folder = sys.argv[sys.argv.index("--") + 1:]
addon.install(zip_file)
from bodyopt_blender import live

basis = f"{folder}/basis.safetensors"
addon.begin()
armature, mesh = addon.add_character(f"{folder}/character.glb")
scene, view_layer = bpy.context.scene, bpy.context.view_layer

# Texture coordinates and materials of the mesh are those of the skin, whose corners are shaded as it lies.
mesh.data.uv_layers.new(name="map")
corners = numpy.random.default_rng(1).random(2 * len(mesh.data.loops), numpy.float32)
mesh.data.uv_layers["map"].data.foreach_set("uv", corners)
mesh.data.materials.clear()
for name in ("skin", "nail"):
    mesh.data.materials.append(bpy.data.materials.new(name))
faces = numpy.arange(len(mesh.data.polygons), dtype=numpy.int32) % 2
mesh.data.polygons.foreach_set("material_index", faces)
addon.bind(mesh, basis)
shown = {}
for frame in range(25):
    scene.frame_set(frame)
    shown[frame] = addon.points_of(mesh)
assert addon.apart(shown[8], shown[0]) > 0.05, "the skin hardly moves"
scene.frame_set(8)
evaluated = mesh.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
found_corners, found_faces = numpy.empty_like(corners), numpy.empty_like(faces)
evaluated.uv_layers["map"].data.foreach_get("uv", found_corners)
evaluated.polygons.foreach_get("material_index", found_faces)
assert (found_corners == corners).all() and (found_faces == faces).all() and len(evaluated.materials) == 2
evaluated.calc_normals_split()
shaded = numpy.empty(3 * len(evaluated.loops), numpy.float32)
evaluated.loops.foreach_get("normal", shaded)
plain = bpy.data.meshes.new("plain")
plain.from_pydata(addon.points_of(mesh).tolist(), [], [polygon.vertices[:] for polygon in mesh.data.polygons])
plain.polygons.foreach_set("use_smooth", [True] * len(plain.polygons))
plain.calc_normals_split()
expected = numpy.empty_like(shaded)
plain.loops.foreach_get("normal", expected)
off = addon.apart((numpy.array(mesh.matrix_world)[:3, :3] @ shaded.reshape(-1, 3).T).T, expected.reshape(-1, 3))
print(f"shaded by normals within {off:.2g}")
assert off < 0.2, "shaded as another skin"  # the file's own normals are other ones by 0.1
bpy.data.meshes.remove(plain)


def worst_of(obj, place=0, frames=(0, 8, 17, 4)):
    """How far the object is from its place in these frames, mm."""
    worst = 0
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        assert not live.errors, live.errors
        worst = max(worst, 1e3 * addon.apart(addon.points_of(obj) - place, shown[frame]))
    return worst


# Moved by a strip; by a constraint, as by the matrices that it gives; by a parent of another collection.
action = armature.animation_data.action
track = armature.animation_data.nla_tracks.new()
track.strips.new("walk", int(action.frame_range[0]), action)
armature.animation_data.action = None
assert worst_of(mesh) < 0.01, "moved by a strip it is another"
armature.animation_data.nla_tracks.remove(track)
scene.frame_set(8)
target = bpy.data.objects.new("target", None)
scene.collection.objects.link(target)
hand = armature.pose.bones["wrist"]
target.location = armature.matrix_world @ hand.tail
target.location.x += 0.1
reach = hand.constraints.new("IK")
reach.target, reach.chain_count = target, 3
view_layer.update()
matrices = {bone.name: bone.matrix.copy() for bone in armature.pose.bones}
reached = addon.points_of(mesh)
assert addon.apart(reached, shown[8]) > 0.02, "the target hardly moves it"
hand.constraints.remove(reach)
for bone in armature.pose.bones:
    bone.matrix = matrices[bone.name]
    view_layer.update()
assert addon.apart(addon.points_of(mesh), reached) < 1e-5, "a constraint shows another skin than its matrices"
armature.animation_data.action = action
rigs = bpy.data.collections.new("rigs")
scene.collection.children.link(rigs)
for collection in armature.users_collection:
    collection.objects.unlink(armature)
rigs.objects.link(armature)
armature.parent = target
target.location, target.scale = (1, 0, 0), (2, 2, 2)
scene.frame_set(4)
assert addon.apart(addon.points_of(mesh), 2 * shown[4] + [1, 0, 0]) < 1e-4, "a scaled parent shows another skin"
armature.parent = None

# Renamed, edited, painted, undone, and with the add-on away for a while.
mesh.name, armature.name = "body", "rig"
assert worst_of(mesh) < 0.01
for obj, mode in ((mesh, "EDIT"), (mesh, "SCULPT"), (mesh, "WEIGHT_PAINT"), (armature, "EDIT"), (armature, "POSE")):
    addon.activate(obj)
    bpy.ops.object.mode_set(mode=mode)
    scene.frame_set(4)
    bpy.ops.object.mode_set(mode="OBJECT")
    assert worst_of(mesh) < 0.01, f"after {mode} of {obj.name} it is another"
armature.animation_data.action = None
bpy.ops.ed.undo_push(message="posed")
armature.pose.bones["elbow"].rotation_euler[0] += 0.5
view_layer.update()
assert addon.apart(addon.points_of(mesh), shown[4]) > 0.02, "the elbow hardly moves it"
bpy.ops.ed.undo_push(message="bent")
bpy.ops.ed.undo()
scene, view_layer = bpy.context.scene, bpy.context.view_layer
mesh, armature = bpy.data.objects["body"], bpy.data.objects["rig"]
assert addon.apart(addon.points_of(mesh), shown[4]) < 1e-5, "undone it is another"
armature.animation_data.action = bpy.data.actions[0]
bpy.ops.preferences.addon_disable(module="bodyopt_blender")
scene.frame_set(17)
bpy.ops.preferences.addon_enable(module="bodyopt_blender")
from bodyopt_blender import live

assert worst_of(mesh) < 0.01, "not live after the add-on was away"

# Rendered with motion blur it is the picture of its bake.
scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", 16, False
scene.render.resolution_x = scene.render.resolution_y = 64
scene.render.motion_blur_shutter = 1
scene.camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
scene.collection.objects.link(scene.camera)
middle = shown[4].mean(axis=0)
scene.camera.location, scene.camera.rotation_euler = middle - [0, 1.5, 0], (math.pi / 2, 0, 0)
scene.render.film_transparent = True  # the alpha is its outline, without a light


def picture(blurs):
    scene.render.use_motion_blur, scene.render.filepath = blurs, f"{folder}/picture.png"
    scene.frame_set(4)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(f"{folder}/picture.png")
    pixels = numpy.array(image.pixels)
    bpy.data.images.remove(image)
    return pixels


addon.activate(mesh)
known = set(bpy.data.objects)
bpy.ops.bodyopt.bake(kind="CACHE", filepath=f"{folder}/blurred.pc2")
(baked,) = set(bpy.data.objects) - known
baked.hide_render = True
sharp, live_one = picture(False), picture(True)
mesh.hide_render, baked.hide_render = True, False
blur, off = (numpy.abs(live_one - other).mean() for other in (sharp, picture(True)))
print(f"motion blur changes a picture by {blur:.2g}, a bake by {off:.2g}")
assert 1e-4 < blur and off < 0.1 * blur, "blurred it is another"
bpy.data.meshes.remove(baked.data)
mesh.hide_render = False
assert worst_of(mesh) < 0.01

# What it was not trained for is told with its bone, which a button selects.
armature.animation_data.action = None
for bone in armature.pose.bones:
    bone.matrix_basis.identity()
view_layer.update()
assert not live.bindings["body"].untrained
elbow = armature.pose.bones["elbow"]
elbow.rotation_mode, elbow.rotation_euler = "XYZ", (0, 0, 2.5)
view_layer.update()
binding = live.bindings["body"]
print(binding.notes, binding.untrained)
assert binding.untrained == ["elbow"] and any(note.startswith("not trained for: joint elbow") for note in binding.notes)
bpy.ops.bodyopt.select_bone(skin="body")
assert bpy.context.mode == "POSE" and [bone.name for bone in bpy.context.selected_pose_bones] == ["elbow"]
bpy.ops.object.mode_set(mode="OBJECT")
wrist = armature.pose.bones["wrist"]
wrist.rotation_mode, wrist.rotation_euler = "XYZ", (2.9, 0, 0)
view_layer.update()
assert set(binding.untrained) == {"elbow", "wrist"}, binding.untrained
bpy.ops.bodyopt.select_bone(skin="body")
assert {bone.name for bone in bpy.context.selected_pose_bones} == {"elbow", "wrist"}
bpy.ops.object.mode_set(mode="OBJECT")
wrist.rotation_euler = 0, 0, 0
elbow.rotation_euler = 0, 0, 0
view_layer.update()
assert not live.bindings["body"].untrained, "still marked"
armature.animation_data.action = bpy.data.actions[0]

# An armature that was deleted poses nobody.
bpy.ops.ed.undo_push(message="whole")
addon.activate(armature)
bpy.ops.object.delete()
bpy.context.scene.frame_set(5)
assert "the armature 'rig' was deleted" in live.errors["body"] and not mesh.modifiers["Bodyopt"].show_viewport
bpy.ops.ed.undo_push(message="deleted")
bpy.ops.ed.undo()
mesh, armature = bpy.data.objects["body"], bpy.data.objects["rig"]
assert worst_of(mesh) < 0.01

# An asset with a basis beside it, twice in a shot of another folder: each is posed by its own rig, now and when read again.
asset = bpy.data.collections.new("asset")
bpy.context.scene.collection.children.link(asset)
for obj in (mesh, armature):
    for collection in obj.users_collection:
        collection.objects.unlink(obj)
    asset.objects.link(obj)
bpy.ops.wm.save_as_mainfile(filepath=f"{folder}/asset.blend")
mesh.bodyopt.basis = "//basis.safetensors"
bpy.ops.wm.save_mainfile()
addon.begin()
with bpy.data.libraries.load(f"{folder}/asset.blend", link=True) as (_, linked):
    linked.collections = ["asset"]
for _ in range(2):
    linked.collections[0].override_hierarchy_create(bpy.context.scene, bpy.context.view_layer, do_fully_editable=True)
second = bpy.data.objects["rig.001"]
second.location, second.animation_data.action = (5, 0, 0), None
for bone in second.pose.bones:
    bone.matrix_basis.identity()
bpy.data.objects["body.001"].bodyopt.shows_error = True
os.mkdir(f"{folder}/shots")
bpy.ops.wm.save_as_mainfile(filepath=f"{folder}/shots/shot.blend")
for _ in range(2):
    first, second = bpy.data.objects["body"], bpy.data.objects["body.001"]
    assert first.override_library and worst_of(first) < 0.01, "an override is another skin"
    assert 1e3 * addon.apart(addon.points_of(second) - [5, 0, 0], shown[0]) < 0.01, "of two overrides one moves the other"
    assert second.bodyopt.shows_error and not first.bodyopt.shows_error
    bpy.ops.wm.open_mainfile(filepath=f"{folder}/shots/shot.blend")
first = bpy.data.objects["body"]
addon.activate(first)
for change in (bpy.ops.bodyopt.bind, bpy.ops.bodyopt.unbind, bpy.ops.bodyopt.add_clothes):
    try:
        change()
        raise SystemExit("the library's binding is changed")
    except RuntimeError as error:
        assert "the mesh is linked from" in str(error), error
known = set(bpy.data.objects)
bpy.ops.bodyopt.bake(kind="CACHE", filepath=f"{folder}/shots/first.pc2")
(baked,) = set(bpy.data.objects) - known
bpy.ops.wm.save_mainfile()
bpy.ops.wm.open_mainfile(filepath=f"{folder}/shots/shot.blend")
assert worst_of(bpy.data.objects["body"]) < 0.01 and worst_of(bpy.data.objects["body baked"]) < 0.01, "baked it is another"

# Instanced, the asset moves by its own action.
addon.begin()
with bpy.data.libraries.load(f"{folder}/asset.blend", link=True) as (_, linked):
    linked.collections = ["asset"]
instance = bpy.data.objects.new("instance", None)
instance.instance_type, instance.instance_collection, instance.location = "COLLECTION", linked.collections[0], (5, 0, 0)
bpy.context.scene.collection.objects.link(instance)
for frame in (0, 8, 4):
    bpy.context.scene.frame_set(frame)
    (points,) = [numpy.array([one.matrix_world @ vertex.co for vertex in one.object.data.vertices])
                 for one in bpy.context.evaluated_depsgraph_get().object_instances if one.object.type == "MESH"]
    assert not live.errors and addon.apart(points - [5, 0, 0], shown[frame]) < 1e-5, "instanced it is another"
