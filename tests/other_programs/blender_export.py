# blender --background --factory-startup --python blender_export.py -- MOTION.glb MOTION.bvh FRAMES
# Blender imports the same motion as glTF and as BVH, and must have every joint at the same place in both.
import sys

import bpy
import numpy

# Blender 3.4's glTF importer uses a name that Debian's NumPy 1.24 has dropped.
numpy.bool = bool

gltf, bvh, frames = sys.argv[sys.argv.index("--") + 1:]
frames = int(frames)

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.context.scene.render.fps = 24
bpy.ops.import_scene.gltf(filepath=gltf)
nodes = {o.name: o for o in bpy.data.objects}
bpy.ops.import_anim.bvh(filepath=bvh, axis_forward="-Z", axis_up="Y", frame_start=1)
armature = next(o for o in bpy.data.objects if o.type == "ARMATURE" and o.name not in nodes)

worst = compared = 0
for frame in range(1, frames + 1):
    bpy.context.scene.frame_set(frame)
    for bone in armature.pose.bones:
        head = armature.matrix_world @ bone.head
        # glTF time 0 is Blender's frame 0 or 1, by version: the nearer of the two is meant.
        worst_here = []
        for shift in (0, -1):
            bpy.context.scene.frame_set(frame + shift)
            worst_here.append((nodes[bone.name].matrix_world.translation - head).length)
        worst = max(worst, min(worst_here))
        compared += 1
        bpy.context.scene.frame_set(frame)
assert compared >= 24 * 5, f"only {compared} joints were compared"
assert worst < 1e-4, f"joints of glTF and BVH are {worst} m apart"
print(f"{compared} joints within {worst:.2g} m")
