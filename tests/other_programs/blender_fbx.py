# blender --background --factory-startup --python blender_fbx.py -- CHARACTER.glb OUT.glb OUT.fbx
# Blender gives a character some motion and exports it as glTF and as FBX, in centimetres and with other axes.
import math
import sys

import bpy
import numpy

# Blender 3.4's glTF importer uses a name that Debian's NumPy 1.24 has dropped.
numpy.bool = bool

character, gltf, fbx = sys.argv[sys.argv.index("--") + 1:]

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.context.scene.render.fps = 24
bpy.context.scene.frame_start, bpy.context.scene.frame_end = 0, 24
bpy.ops.import_scene.gltf(filepath=character)
armature = next(o for o in bpy.data.objects if o.type == "ARMATURE")
armature.animation_data_clear()
for number, bone in enumerate(armature.pose.bones):
    bone.rotation_mode = "XYZ"
    for frame in range(0, 25, 8):
        bone.rotation_euler = [0.4 * math.sin(number + frame + axis) for axis in range(3)]
        bone.keyframe_insert("rotation_euler", frame=frame)
bpy.ops.export_scene.gltf(filepath=gltf, export_force_sampling=True)
bpy.ops.export_scene.fbx(filepath=fbx, axis_forward="X", axis_up="Z", bake_anim_simplify_factor=0,
                         bake_anim_use_all_actions=False, bake_anim_use_nla_strips=False)
