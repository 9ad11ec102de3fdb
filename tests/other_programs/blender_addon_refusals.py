# blender --background --factory-startup --python blender_addon_refusals.py -- ADDON.zip BODYOPT FOLDER
# What the add-on cannot show rightly it says in a sentence, and shows the mesh at rest until it can.
import os
import shutil
import sys

import bpy
import numpy

sys.path.append(os.path.dirname(__file__))
import addon

zip_file, bodyopt, folder = sys.argv[sys.argv.index("--") + 1:]
character, basis = f"{folder}/character.glb", f"{folder}/basis.safetensors"
addon.install(zip_file)
from bodyopt_blender import live


def begin(moves=True):
    addon.begin()
    return addon.add_character(character, moves)


def refuses_to_bind(mesh, said, file=basis):
    """Binding fails with this in its sentence, and leaves the mesh as it was."""
    modifiers = [(m.name, m.type) for m in mesh.modifiers]
    try:
        addon.bind(mesh, file)
    except RuntimeError as error:
        assert said in str(error), f"'{said}' is not in: {error}"
    else:
        raise AssertionError(f"bound in spite of: {said}")
    assert not mesh.bodyopt.is_bound and [(m.name, m.type) for m in mesh.modifiers] == modifiers
    print("refused:", said)


def refuses_to_show(mesh, said, recover):
    """A bound mesh stands at rest and has this sentence; once recovered, it is live again."""
    bpy.context.scene.frame_set(8)
    bpy.context.view_layer.update()
    error = live.errors.get(mesh.name_full, "nothing")
    assert said in error, f"'{said}' is not in: {error}"
    assert not mesh.modifiers["Bodyopt"].show_viewport, "a wrong skin is shown"
    recover()
    bpy.context.view_layer.update()
    bpy.context.scene.frame_set(9)
    assert not live.errors and mesh.modifiers["Bodyopt"].show_viewport, f"does not recover: {live.errors}"
    print("refused:", said)


def set_all(collection, attribute, value):
    for item in collection:
        setattr(item, attribute, value)


armature, mesh = begin()
refuses_to_bind(mesh, "there is no file", f"{folder}/nowhere.safetensors")
with open(f"{folder}/cut.safetensors", "wb") as file:
    file.write(open(basis, "rb").read(3000))
refuses_to_bind(mesh, "cut.safetensors", f"{folder}/cut.safetensors")
refuses_to_bind(mesh, "character.glb", character)
mesh.bodyopt.level = 3
refuses_to_bind(mesh, "level")
mesh.bodyopt.level = 0

armature.data.bones["elbow"].name = "ellbow"
refuses_to_bind(mesh, "'elbow'")
for bone in armature.data.bones:
    bone.name = "other " + bone.name
refuses_to_bind(mesh, "another armature")

armature, mesh = begin()
addon.activate(armature)
bpy.ops.object.mode_set(mode="EDIT")
armature.data.edit_bones["elbow"].head.z += 0.05
bpy.ops.object.mode_set(mode="OBJECT")
refuses_to_bind(mesh, "another rest pose: bone 'elbow'")

armature, mesh = begin()
armature.scale = 1, 1, 2
bpy.context.view_layer.update()
refuses_to_bind(mesh, "scaled differently along its axes")
armature.scale = -1, 1, 1
bpy.context.view_layer.update()
refuses_to_bind(mesh, "mirrored")
armature.scale = 1, 1, 1
bpy.context.view_layer.update()
flat = numpy.array([vertex.co for vertex in mesh.data.vertices])
mesh.data.vertices.foreach_set("co", (flat * [-1, 1, 1]).ravel())
refuses_to_bind(mesh, "mirrored")
mesh.data.vertices.foreach_set("co", (flat[::-1] * [1, 1.02, 1]).ravel())
refuses_to_bind(mesh, "another mesh")

armature, mesh = begin()
copy = mesh.copy()
refuses_to_bind(mesh, "shared by 2 objects")
bpy.data.objects.remove(copy)
smooth = mesh.modifiers.new("Smooth", "SMOOTH")
bpy.ops.object.modifier_move_to_index(modifier="Smooth", index=0)
refuses_to_bind(mesh, "'Smooth' comes before")
mesh.modifiers.remove(smooth)
empty = bpy.data.objects.new("empty", bpy.data.meshes.new("empty"))
bpy.context.collection.objects.link(empty)
empty.bodyopt.armature = armature
refuses_to_bind(empty, "the mesh has no vertices")
mesh.modifiers.clear()
mesh.parent = None
refuses_to_bind(mesh, "there is no armature")

# Vertices in another order are found by their places, where none lie on each other.
armature, mesh = begin()
addon.bind(mesh, basis)
bpy.context.scene.frame_set(8)
in_order = addon.points_of(mesh)
bpy.ops.bodyopt.unbind()
order = numpy.random.default_rng(1).permutation(len(flat))
mesh.data.vertices.foreach_set("co", flat[order].ravel())
addon.bind(mesh, basis)
bpy.context.scene.frame_set(9)
bpy.context.scene.frame_set(8)
assert addon.apart(addon.points_of(mesh), in_order[order]) < 1e-5, "another order is another skin"
mesh.data.vertices.foreach_set("co", flat.ravel())
refuses_to_show(mesh, "the mesh was changed", lambda: mesh.data.vertices.foreach_set("co", flat[order].ravel()))

# A level of detail has a mesh of its own.
armature, mesh = begin()
clip = addon.exported_clip(folder)
expected = addon.evaluated_by_program(bodyopt, f"{folder}/light.safetensors", clip, folder, "--level", "1")
addon.activate(armature)
bpy.ops.bodyopt.add_skin(filepath=f"{folder}/light.safetensors", level=1)
light = next(obj for obj in bpy.data.objects if obj.type == "MESH" and obj != mesh)
bpy.context.scene.frame_set(8)
assert len(light.data.vertices) < 1000 and addon.apart(addon.points_of(light), expected[8]) < 1e-4, "another level"
refuses_to_bind(mesh, "another mesh", f"{folder}/light.safetensors")

# What happens to a bound one.
armature, mesh = begin()
addon.bind(mesh, basis)
shutil.copy(basis, f"{folder}/moved.safetensors")
mesh.bodyopt.basis = f"{folder}/moved.safetensors"
bpy.context.scene.frame_set(3)
assert not live.errors
os.remove(f"{folder}/moved.safetensors")
live.forget()
refuses_to_show(mesh, "there is no file", lambda: shutil.copy(basis, f"{folder}/moved.safetensors"))
mesh.bodyopt.basis = basis
armature.data.bones["elbow"].name = "ellbow"
refuses_to_show(mesh, "was one renamed to 'ellbow'", lambda: setattr(armature.data.bones["ellbow"], "name", "elbow"))
armature.scale = 1, 1.5, 1
refuses_to_show(mesh, "scaled differently", lambda: setattr(armature, "scale", (1, 1, 1)))
armature.pose.bones["elbow"].scale = 0, 0, 0
refuses_to_show(mesh, "scaled to nothing", lambda: setattr(armature.pose.bones["elbow"], "scale", (1, 1, 1)))
parent, mesh.parent = mesh.parent, None
armature.hide_viewport = True
refuses_to_show(mesh, "the armature is switched off", lambda: setattr(armature, "hide_viewport", False))
bpy.context.view_layer.layer_collection.collection.objects.unlink(armature)
group = bpy.data.collections.new("rigs")
bpy.context.scene.collection.children.link(group)
group.objects.link(armature)
layer = bpy.context.view_layer.layer_collection.children["rigs"]
layer.exclude = True
refuses_to_show(mesh, "the armature is switched off", lambda: setattr(layer, "exclude", False))
mesh.parent = parent
layer.exclude = True
bpy.context.scene.frame_set(9)
bpy.context.scene.frame_set(8)
assert not live.errors and addon.apart(addon.points_of(mesh), in_order) < 1e-6, "a parent that is excluded does not pose"
layer.exclude = False
mesh.scale = 0, 1, 1
refuses_to_show(mesh, "the mesh is scaled to nothing", lambda: setattr(mesh, "scale", (1, 1, 1)))
second = mesh.modifiers.new("Second", "ARMATURE")
second.object = armature
refuses_to_show(mesh, "'Second' moves the skin a second time", lambda: mesh.modifiers.remove(second))
copy = mesh.copy()
refuses_to_show(mesh, "shared by 2 objects", lambda: bpy.data.objects.remove(copy))
other = mesh.modifiers.new("Smooth", "SMOOTH")
addon.activate(mesh)
bpy.ops.object.modifier_move_to_index(modifier="Smooth", index=0)
refuses_to_show(mesh, "'Smooth' comes before", lambda: mesh.modifiers.remove(other))
mesh.modifiers["Bodyopt"].name = "Mine"
bpy.context.scene.frame_set(8)
assert "no modifier has the name 'Bodyopt'" in live.errors[mesh.name_full], live.errors
mesh.modifiers["Mine"].name = "Bodyopt"
bpy.ops.object.mode_set(mode="EDIT")
bpy.ops.mesh.select_all(action="DESELECT")
bpy.ops.object.mode_set(mode="OBJECT")
set_all(list(mesh.data.vertices)[:5], "select", True)
bpy.ops.object.mode_set(mode="EDIT")
bpy.ops.mesh.delete(type="VERT")
bpy.ops.object.mode_set(mode="OBJECT")
bpy.context.scene.frame_set(8)
assert not live.errors and addon.apart(addon.points_of(mesh), in_order[5:]) < 1e-6, "vertices deleted, others are wrong"
mesh.shape_key_add(name="Basis")
mesh.shape_key_add(name="smile").value = 1
bpy.context.scene.frame_set(7)
assert "shape keys" in str(live.bindings[mesh.name_full].notes)

# Linked from another file: the mesh is refused, a linked armature is none of its business.
bpy.ops.bodyopt.unbind()
bpy.ops.wm.save_as_mainfile(filepath=f"{folder}/library.blend")
addon.begin()
with bpy.data.libraries.load(f"{folder}/library.blend", link=True) as (found, linked):
    linked.objects = found.objects
for obj in linked.objects:
    bpy.context.collection.objects.link(obj)
mesh = next(obj for obj in linked.objects if obj.type == "MESH")
refuses_to_bind(mesh, "the mesh is linked from")
armature = next(obj for obj in linked.objects if obj.type == "ARMATURE")
addon.activate(armature)
bpy.ops.bodyopt.add_skin(filepath=basis)
skin = next(obj for obj in bpy.data.objects if obj.type == "MESH" and not obj.library)
assert skin.bodyopt.is_bound, "no skin on a linked armature"
bpy.context.scene.frame_set(8)
assert not live.errors and addon.apart(addon.points_of(skin), in_order) < 1e-5
