# blender --background --factory-startup --python blender_export.py -- MOTION.glb MOTION.bvh FRAMES
# Blender imports the same motion as glTF, which makes one armature with one action, and as BVH, and must have every joint at
# the same place in both.
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
(of_gltf_file,) = bpy.data.objects
assert of_gltf_file.type == "ARMATURE" and len(bpy.data.actions) == 1, [a.name for a in bpy.data.actions]
first = min(curve.range()[0] for action in bpy.data.actions for curve in action.fcurves)
bpy.ops.import_anim.bvh(filepath=bvh, axis_forward="-Z", axis_up="Y", frame_start=1)
of_bvh_file = next(o for o in bpy.data.objects if o != of_gltf_file)


def places(armature, frame):
    bpy.context.scene.frame_set(int(frame))
    return {bone.name: numpy.array(armature.matrix_world @ bone.head) for bone in armature.pose.bones}


worst = moved = 0
for frame in range(frames):
    of_gltf = places(of_gltf_file, first + frame)
    of_bvh = places(of_bvh_file, 1 + frame)
    assert of_gltf.keys() == of_bvh.keys()
    worst = max([worst] + [numpy.linalg.norm(of_gltf[name] - of_bvh[name]) for name in of_bvh])
    start = of_bvh if frame == 0 else start
    moved = max([moved] + [numpy.linalg.norm(of_bvh[name] - start[name]) for name in of_bvh])
assert moved > 0.05, f"the joints move by {moved} m only"
assert worst < 1e-4, f"joints of glTF and BVH are {worst} m apart"
print(f"{len(start)} joints over {frames} frames within {worst:.2g} m")
