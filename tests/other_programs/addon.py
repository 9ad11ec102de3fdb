"""What the checks of the add-on share: a scene with a posed character, and what Blender shows of it."""
import math
import struct
import subprocess

import bpy
import numpy

# Blender 3.4's glTF importer uses a name that Debian's NumPy 1.24 has dropped.
numpy.bool = bool


def install(zip_file):
    bpy.ops.preferences.addon_install(filepath=zip_file, overwrite=True)
    bpy.ops.preferences.addon_enable(module="bodyopt_blender")


def begin():
    bpy.ops.wm.read_homefile(use_empty=True)
    scene = bpy.context.scene
    scene.render.fps, scene.frame_start, scene.frame_end = 30, 0, 24


def add_character(path, moves=True):
    """A character that moves, by its file's first clip or by one made here; its armature and its mesh, which is active."""
    known = set(bpy.data.objects)
    bpy.ops.import_scene.gltf(filepath=path)
    new = [obj for obj in bpy.data.objects if obj not in known]
    armature = next(obj for obj in new if obj.type == "ARMATURE")
    mesh = next(obj for obj in new if obj.type == "MESH")
    action = armature.animation_data and armature.animation_data.action
    armature.animation_data_clear()
    for bone in armature.pose.bones:
        bone.matrix_basis.identity()
    if action and moves:
        armature.animation_data_create().action = action
    for number, bone in enumerate(armature.pose.bones if moves and not action else ()):
        bone.rotation_mode = "XYZ"
        for frame in range(0, 25, 8):
            bone.rotation_euler = [0.25 * math.sin(number + frame + axis) if frame else 0 for axis in range(3)]
            bone.keyframe_insert("rotation_euler", frame=frame)
    activate(mesh)
    return armature, mesh


def activate(obj):
    bpy.ops.object.select_all(action="DESELECT")
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj


def bind(mesh, basis):
    activate(mesh)
    mesh.bodyopt.basis = basis
    bpy.ops.bodyopt.bind()


def points_of(obj):
    """What Blender shows of an object, V x 3 in its world."""
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    flat = numpy.empty(3 * len(evaluated.data.vertices), "<f4")
    evaluated.data.vertices.foreach_get("co", flat)
    to_world = numpy.array(evaluated.matrix_world)
    return flat.reshape(-1, 3) @ to_world[:3, :3].T + to_world[:3, 3]


def z_up(points):
    return numpy.stack([points[..., 0], -points[..., 2], points[..., 1]], axis=-1)


def read_pc2(path):
    with open(path, "rb") as file:
        points, _, _, samples = struct.unpack("<iffi", file.read(32)[16:])
        return numpy.frombuffer(file.read(), "<f4").reshape(samples, points, 3)


def exported_clip(folder):
    """The scene's motion as a glTF file."""
    bpy.ops.export_scene.gltf(filepath=f"{folder}/posed.glb", export_force_sampling=True)
    return f"{folder}/posed.glb"


def evaluated_by_program(bodyopt, basis, clip, folder, *options):
    """Frames 0 to 24 of a clip as the program evaluates them, 25 x V x 3 in Blender's world."""
    subprocess.run([bodyopt, "eval", basis, "--clip", clip, "--fps", "30", "--first-frame", "0", "--frames", "0-24",
                    "--device", "cpu", "--out", f"{folder}/posed.pc2", *options], check=True, capture_output=True)
    return z_up(read_pc2(f"{folder}/posed.pc2"))


def apart(a, b):
    return numpy.linalg.norm(a - b, axis=-1).max()
