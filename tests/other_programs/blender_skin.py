# blender --background --factory-startup --python blender_skin.py -- SKIN.glb SKIN.pc2 FRAMES
# Blender imports a skin as glTF with morph targets, alone or bound to an armature, and must have every vertex in every frame where the cache has it.
import struct
import sys

import bpy
import numpy

# Blender 3.4's glTF importer uses a name that Debian's NumPy 1.24 has dropped.
numpy.bool = bool

gltf, cache, frames = sys.argv[sys.argv.index("--") + 1:]
frames = int(frames)

with open(cache, "rb") as file:
    points, _, _, samples = struct.unpack("<iffi", file.read(32)[16:])
    expected = numpy.frombuffer(file.read(), "<f4").reshape(samples, points, 3)
assert samples == frames, f"the cache has {samples} samples"

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.context.scene.render.fps = 24
bpy.ops.import_scene.gltf(filepath=gltf)
skin = next(o for o in bpy.data.objects if o.type == "MESH")
bound = skin.find_armature()
assert len(skin.data.shape_keys.key_blocks) == frames + bool(bound), "a shape key for each frame beside the basis"
action = skin.data.shape_keys.animation_data
for animated in [action] + ([bound.animation_data] if bound else []):
    if not animated.action:  # the importer leaves it in a track
        animated.action = animated.nla_tracks[0].strips[0].action
first = action.action.frame_range[0]
worst = moved = 0
for frame in range(frames):
    bpy.context.scene.frame_set(int(first) + frame)
    mesh = skin.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    shown = numpy.empty(3 * points, "<f4")
    mesh.vertices.foreach_get("co", shown)
    to_world = numpy.array(skin.matrix_world)
    shown = shown.reshape(points, 3) @ to_world[:3, :3].T + to_world[:3, 3]
    shown = numpy.stack([shown[:, 0], shown[:, 2], -shown[:, 1]], axis=1)  # Z up there
    worst = max(worst, numpy.abs(shown - expected[frame]).max())
    moved = max(moved, numpy.abs(expected[frame] - expected[0]).max())
assert moved > 0.02, f"the skin moves by {moved} m only"
assert worst < 1e-5, f"the skin of glTF and of the cache are {worst} m apart"
print(f"{points} vertices over {frames} frames within {worst:.2g} m")
