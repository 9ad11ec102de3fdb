# blender --background --factory-startup --python blender_addon_live.py -- ADDON.zip BODYOPT FOLDER CHARACTER.glb BASIS [CLIP]
# The add-on shows every vertex where `bodyopt eval` has it, by frames and by hand, wherever the character stands, in files
# that are opened again, with the add-on or without; and gives the mesh back.
import os
import sys
import time

import bpy
import numpy

sys.path.append(os.path.dirname(__file__))
import addon

zip_file, bodyopt, folder, character, basis, *clip = sys.argv[sys.argv.index("--") + 1:]
basis = f"{folder}/{basis}"
addon.install(zip_file)
from bodyopt_blender import live

addon.begin()
scene = bpy.context.scene
armature, mesh = addon.add_character(character)
before = numpy.array([vertex.co for vertex in mesh.data.vertices])
clip = f"{character}#{clip[0]}" if clip else addon.exported_clip(folder)
expected = addon.evaluated_by_program(bodyopt, basis, clip, folder)
assert addon.apart(expected[8], expected[0]) > 0.05, "the skin hardly moves"
addon.bind(mesh, basis)


def worst_of(frames, mesh, place=lambda points: points):
    worst = 0
    for frame in frames:
        scene.frame_set(frame)
        assert not live.errors, live.errors
        worst = max(worst, addon.apart(addon.points_of(mesh), place(expected[frame])))
    return 1e3 * worst


print(f"{len(before)} vertices by frames within {worst_of(range(25), mesh):.2g} mm of bodyopt eval")
assert worst_of(range(25), mesh) < 0.1
assert worst_of((20, 3, 3, 17), mesh) < 0.1, "frames out of order are others"

# Posed by hand: the pose of frame 8 in frame 0, where a breath has not begun.
if not any(key.startswith("bodyopt.breath") for key in mesh.keys()):
    scene.frame_set(8)
    pose = [bone.matrix_basis.copy() for bone in armature.pose.bones]
    action = armature.animation_data.action
    armature.animation_data.action = None
    scene.frame_set(0)
    for bone, matrix in zip(armature.pose.bones, pose):
        bone.matrix_basis = matrix
    bpy.context.view_layer.update()
    assert 1e3 * addon.apart(addon.points_of(mesh), expected[8]) < 0.1, "not live while posing"
    spent = time.process_time()
    for k in range(100):
        armature.pose.bones[0].rotation_euler[0] += 0.001
        bpy.context.view_layer.update()
    spent = (time.process_time() - spent) / 100
    print(f"posed in {1e3 * spent:.1f} ms of one core")
    assert spent < 1 / 60
    armature.animation_data.action = action
    mesh.bodyopt.shows_error = True
    scene.frame_set(8)
    colours = numpy.empty(4 * len(before), "<f4")
    mesh.data.attributes["bodyopt_error"].data.foreach_get("color", colours)
    assert numpy.ptp(colours.reshape(-1, 4)[:, 0]) > 0.01, "the expected error is the same everywhere"
    assert live.bindings[mesh.name_full].expected_mm > 0
else:
    mesh["bodyopt.breath.rate"] = 30.0
    mesh["bodyopt.breath.exertion"] = 0.0
    mesh.keyframe_insert('["bodyopt.breath.exertion"]', frame=0)
    mesh["bodyopt.breath.exertion"] = 1.0
    mesh.keyframe_insert('["bodyopt.breath.exertion"]', frame=24)
    for point in mesh.animation_data.action.fcurves[0].keyframe_points:
        point.interpolation = "LINEAR"
    quiet = expected
    with open(f"{folder}/breath.csv", "w") as file:
        file.write("frame,breath.rate,breath.exertion\n" + "".join(f"{f},30,{f / 24}\n" for f in range(25)))
    expected = addon.evaluated_by_program(bodyopt, basis, clip, folder, "--controls", f"{folder}/breath.csv")
    assert addon.apart(quiet[20], expected[20]) > 0.002, "the breath hardly moves the skin"
    print(f"with a keyed breath within {worst_of([*range(25), 20, 4], mesh):.2g} mm")
    assert worst_of([*range(25), 20, 4], mesh) < 0.1

    # Another frame rate holds for the past, too; a past that only a driver knows is told of.
    scene.frame_set(10)
    scene.render.fps = 60
    scene.frame_set(11)
    passed = addon.points_of(mesh)
    scene.frame_set(20)
    scene.frame_set(11)
    assert 1e3 * addon.apart(addon.points_of(mesh), passed) < 0.01, "another frame rate leaves a past of the one before"
    scene.render.fps = 30
    mesh.driver_add('["bodyopt.breath.rate"]').driver.expression = "30"
    for frame, is_told in ((20, True), (21, False), (0, False)):
        scene.frame_set(frame)
        assert any("play from the first frame" in note for note in live.bindings[mesh.name_full].notes) == is_told, frame
    mesh.driver_remove('["bodyopt.breath.rate"]')
    mesh["bodyopt.breath.rate"] = 30.0

# Elsewhere, turned, and twice as large; the mesh with a transform of its own. Then a second character.
turn = numpy.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
armature.rotation_mode, armature.rotation_euler, armature.location = "XYZ", (0, 0, numpy.pi / 2), (3, 4, 5)
armature.scale = 2, 2, 2
mesh.location, mesh.scale = (0.3, 0, 0), (1, 1.5, 1)
stands = lambda points: 2 * points @ turn.T + [3, 4, 5]
assert worst_of((3, 16), mesh, stands) < 0.1, "not where the armature stands"
other_armature, other = addon.add_character(character, moves=False)
addon.bind(other, basis)
other_armature.location = 0, 7, 0
assert worst_of((5, 9), mesh, stands) < 0.1, "a second character changes the first"
breath_mm = 20 if "bodyopt.breath" in other.keys() else 0.1
assert 1e3 * addon.apart(addon.points_of(other) - [0, 7, 0], before) < breath_mm, "at rest the skin is not the mesh"

# A file opened again, and without the add-on.
scene.frame_set(16)
bpy.ops.wm.save_as_mainfile(filepath=f"{folder}/bound.blend")
shown = addon.points_of(mesh)
name = mesh.name
bpy.ops.preferences.addon_disable(module="bodyopt_blender")
bpy.ops.wm.open_mainfile(filepath=f"{folder}/bound.blend")
assert addon.apart(addon.points_of(bpy.data.objects[name]), shown) == 0, "without the add-on the skin is another"
bpy.ops.preferences.addon_enable(module="bodyopt_blender")
bpy.ops.wm.open_mainfile(filepath=f"{folder}/bound.blend")
scene, mesh = bpy.context.scene, bpy.data.objects[name]
assert worst_of((4, 23), mesh, stands) < 0.1, "not live in a file that is opened again"

scene.frame_set(0)
addon.activate(mesh)
bpy.ops.bodyopt.unbind()
assert (before == [vertex.co for vertex in mesh.data.vertices]).all(), "the mesh is not given back"
assert [m.type for m in mesh.modifiers] == ["ARMATURE"] and mesh.modifiers[0].object == mesh.parent
assert not [a.name for a in mesh.data.attributes if a.name.startswith("bodyopt")] and "bodyopt.breath" not in mesh.keys()
