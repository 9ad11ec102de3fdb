# blender --background --factory-startup --python blender_sculpt.py -- FRAME SCULPT
# The sculptor: opens a frame (.obj or .glb), moves what is within 50 mm of a vertex along the normals, by 10 mm there, puts
# the vertices in another order, and saves it.
import random
import sys

import bmesh
import bpy
import numpy

numpy.bool = bool  # Debian's glTF add-on is older than its numpy

frame, sculpt = sys.argv[sys.argv.index("--") + 1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
if frame.endswith(".obj"):
    bpy.ops.wm.obj_import(filepath=frame)
else:
    bpy.ops.import_scene.gltf(filepath=frame)
skin = max((o for o in bpy.data.objects if o.type == "MESH"), key=lambda o: len(o.data.vertices))
mesh = bmesh.new()
mesh.from_mesh(skin.data)
mesh.verts.ensure_lookup_table()
middle = mesh.verts[0].co.copy()
for vertex in mesh.verts:
    distance = (vertex.co - middle).length
    if distance < 0.05:
        vertex.co += vertex.normal * 0.01 * (1 - (distance / 0.05) ** 2) ** 2
order = list(range(len(mesh.verts)))
random.Random(3).shuffle(order)
for vertex, place in zip(mesh.verts, order):
    vertex.index = place
mesh.verts.sort()
mesh.to_mesh(skin.data)
if sculpt.endswith(".obj"):
    bpy.ops.wm.obj_export(filepath=sculpt, export_materials=False, export_uv=False, export_normals=False)
else:
    bpy.ops.export_scene.gltf(filepath=sculpt)
