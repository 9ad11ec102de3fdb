# blender --background --factory-startup --python blender_point_cache.py -- CHARACTER.glb CACHE.pc2 SAMPLE
# Blender imports the character, plays the cache by its Mesh Cache modifier, and must show the cache's own points.
import struct
import sys

import bpy
import numpy

# Blender 3.4's glTF importer uses a name that Debian's NumPy 1.24 has dropped.
numpy.bool = bool

character, cache, sample = sys.argv[sys.argv.index("--") + 1:]
sample = int(sample)

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=character, merge_vertices=False)
mesh = next(o for o in bpy.data.objects if o.type == "MESH" and o.find_armature() is not None)

with open(cache, "rb") as file:
    magic, version, points, start, rate, samples = struct.unpack("<12siiffi", file.read(32))
    assert magic == b"POINTCACHE2\0" and version == 1, "not a PC2 cache"
    assert points == len(mesh.data.vertices), f"cache has {points} points, Blender {len(mesh.data.vertices)} vertices"
    file.seek(32 + sample * points * 12)
    expected = struct.unpack(f"<{points * 3}f", file.read(points * 12))

mesh.parent = None
mesh.matrix_world.identity()
mesh.modifiers.clear()
modifier = mesh.modifiers.new("cache", "MESH_CACHE")
modifier.cache_format = "PC2"
modifier.filepath = cache
modifier.play_mode = "CUSTOM"
modifier.time_mode = "FRAME"
modifier.eval_frame = sample
evaluated = mesh.evaluated_get(bpy.context.evaluated_depsgraph_get())
worst = max(
    abs(vertex.co[axis] - expected[3 * index + axis])
    for index, vertex in enumerate(evaluated.data.vertices)
    for axis in range(3)
)
print(f"Blender: {points} points, {samples} samples, largest difference {worst:.3g} m")
assert worst < 1e-6, "Blender shows other points than the cache holds"
