# blender --background --factory-startup --python blender_export.py -- MOTION.glb MOTION.bvh FRAMES
# Blender imports the same motion as glTF and as BVH, and must have every joint at the same place in both.
import sys

import bpy
import numpy
from io_anim_bvh import import_bvh

# Blender 3.4's glTF importer uses a name that Debian's NumPy 1.24 has dropped.
numpy.bool = bool

gltf, bvh, frames = sys.argv[sys.argv.index("--") + 1:]
frames = int(frames)

# And its BVH importer a mode of open() that Python 3.11 has dropped.
import_bvh.open = lambda path, mode: open(path, mode.replace("U", ""))

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.context.scene.render.fps = 24
bpy.ops.import_scene.gltf(filepath=gltf)
nodes = {o.name: o for o in bpy.data.objects}
first = min(curve.range()[0] for action in bpy.data.actions for curve in action.fcurves)
bpy.ops.import_anim.bvh(filepath=bvh, axis_forward="-Z", axis_up="Y", frame_start=1)
armature = next(o for o in bpy.data.objects if o.type == "ARMATURE" and o.name not in nodes)


def places(frame, place):
    bpy.context.scene.frame_set(int(frame))
    return {bone.name: numpy.array(place(bone)) for bone in armature.pose.bones}


worst = moved = 0
for frame in range(frames):
    of_gltf = places(first + frame, lambda bone: nodes[bone.name].matrix_world.translation)
    of_bvh = places(1 + frame, lambda bone: armature.matrix_world @ bone.head)
    worst = max([worst] + [numpy.linalg.norm(of_gltf[name] - of_bvh[name]) for name in of_bvh])
    start = of_bvh if frame == 0 else start
    moved = max([moved] + [numpy.linalg.norm(of_bvh[name] - start[name]) for name in of_bvh])
assert moved > 0.05, f"the joints move by {moved} m only"
assert worst < 1e-4, f"joints of glTF and BVH are {worst} m apart"
print(f"{len(start)} joints over {frames} frames within {worst:.2g} m")
