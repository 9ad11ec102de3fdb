# blender --background --factory-startup --python blender_sculpt.py -- FRAME.obj SCULPT.obj
# The sculptor: opens a frame, moves every vertex on one side by a bump of 10 mm, and saves it.
import sys

import bpy

frame, sculpt = sys.argv[sys.argv.index("--") + 1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.wm.obj_import(filepath=frame)
mesh = next(o for o in bpy.data.objects if o.type == "MESH")
middle = mesh.data.vertices[0].co.copy()
for vertex in mesh.data.vertices:
    distance = (vertex.co - middle).length
    if distance < 0.05:
        vertex.co += vertex.normal * 0.01 * (1 - (distance / 0.05) ** 2) ** 2
bpy.ops.wm.obj_export(filepath=sculpt, export_materials=False, export_uv=False, export_normals=False)
