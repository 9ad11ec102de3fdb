# blender --background --factory-startup --python blender_fbx_import.py -- FILE.fbx OUT.npz
# The skinned meshes of an FBX as Blender imports it, Y up and in metres, frame by frame of its first animation: `points`
# (frames x points x 3), `fps`, and `keyed`, the frames at which every curve has a key. Between keys Blender goes straight.
import sys

import bpy
import numpy

source, out = sys.argv[sys.argv.index("--") + 1:]

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.fbx(filepath=source)
scene = bpy.context.scene
curves = [curve for o in bpy.data.objects if o.animation_data and o.animation_data.action
          for curve in o.animation_data.action.fcurves]
times = [{round(key.co[0], 3) for key in curve.keyframe_points} for curve in curves]
first, last = (int(min(map(min, times))), round(max(map(max, times)))) if times else (1, 1)


def skin(frame):
    scene.frame_set(frame)
    shown = bpy.context.evaluated_depsgraph_get()
    parts = []
    for o in bpy.data.objects:
        if o.type != "MESH" or not any(modifier.type == "ARMATURE" for modifier in o.modifiers):
            continue
        evaluated = o.evaluated_get(shown)
        mesh = evaluated.to_mesh()
        points = numpy.empty(3 * len(mesh.vertices))
        mesh.vertices.foreach_get("co", points)
        world = numpy.array(evaluated.matrix_world)
        parts.append(points.reshape(-1, 3) @ world[:3, :3].T + world[:3, 3])
        evaluated.to_mesh_clear()
    x, y, z = numpy.concatenate(parts).T
    return numpy.stack([x, z, -y], axis=1)


frames = range(first, min(last, first + 99) + 1)
keyed = [k for k, frame in enumerate(frames) if all(frame in one for one in times)]
numpy.savez(out, points=numpy.array([skin(frame) for frame in frames]), keyed=keyed or [0],
            fps=scene.render.fps / scene.render.fps_base)
