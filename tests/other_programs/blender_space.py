# blender --background --factory-startup --python blender_space.py -- CHARACTER.glb FOLDER FIRST FRAMES
# The skin of one shot by every export that Blender plays, as docs/programs.md says: a.pc2 (metres, Y up), of others the
# unit, the axis and the first frame, texture coordinates and materials; and a rig that lies in the skin.
import struct
import sys

import bpy
import numpy

numpy.bool = bool  # Blender 3.4's glTF importer uses a name that Debian's NumPy 1.24 has dropped

character, folder, first, frames = sys.argv[sys.argv.index("--") + 1:]
first, frames = int(first), int(frames)
with open(f"{folder}/a.pc2", "rb") as file:
    points, start, _, samples = struct.unpack("<iffi", file.read(32)[16:])
    expected = numpy.frombuffer(file.read(), "<f4").reshape(samples, points, 3)
assert (start, samples) == (first, frames), (start, samples)
expected = numpy.stack([expected[..., 0], -expected[..., 2], expected[..., 1]], axis=-1)

bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.fps = 24


def shown(obj, frame):
    scene.frame_set(frame)
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    flat = numpy.empty(3 * len(mesh.vertices), "<f4")
    mesh.vertices.foreach_get("co", flat)
    to_world = numpy.array(obj.matrix_world)
    return flat.reshape(-1, 3) @ to_world[:3, :3].T + to_world[:3, 3]


def imported(path):
    known = set(bpy.data.objects)
    bpy.ops.import_scene.gltf(filepath=path)
    return [obj for obj in bpy.data.objects if obj not in known]


def check(name, found, frame, unit=1):
    worst = numpy.abs(unit * found - expected[frame]).max()
    assert worst < 2e-5, f"{name}, frame {first + frame}: {worst} m"


# Point caches on the imported character.
mesh = next(o for o in imported(character) if o.type == "MESH")
mesh.parent = None
mesh.matrix_world.identity()
mesh.modifiers.clear()
cache = mesh.modifiers.new("cache", "MESH_CACHE")
for name, unit, z_up in (("a.pc2", 1, False), ("z.pc2", 1, True), ("a.mdd", 1, False), ("cm.mdd", 0.01, True)):
    cache.cache_format, cache.filepath, cache.frame_start = name[-3:].upper(), f"{folder}/{name}", first
    cache.forward_axis, cache.up_axis = ("POS_Y", "POS_Z") if z_up else ("POS_Z", "NEG_Y")
    for frame in (0, frames // 2, frames - 1):
        check(name, shown(mesh, first + frame), frame, unit)

# glTF: the first frame is Blender's frame 0.
skin = next(o for o in imported(f"{folder}/skin.glb") if o.type == "MESH")
action = skin.data.shape_keys.animation_data
if not action.action:  # the importer leaves it in a track
    action.action = action.nla_tracks[0].strips[0].action
assert tuple(action.action.frame_range) == (0, frames - 1), action.action.frame_range[:]
assert [m.name.split(".")[0] for m in skin.data.materials] == ["cloth", "skin"], skin.data.materials[:]
colours = {m.name.split(".")[0]: tuple(m.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value) for m in skin.data.materials}
assert abs(numpy.array(colours["skin"][:3]) - [0.75, 0.5, 0.25]).max() < 1e-6, colours
for frame in (0, frames // 2, frames - 1):
    check("skin.glb", shown(skin, frame), frame)
(layer,) = skin.data.uv_layers
rest = [vertex.co for vertex in mesh.data.vertices]
worst = max(abs(layer.data[loop.index].uv[0] - 0.5 - rest[loop.vertex_index][0]) for loop in skin.data.loops)
assert worst < 1e-5, f"texture coordinates are off by {worst}"

# The rig stands inside its skin, in every frame.
(rig,) = imported(f"{folder}/rig.glb")
assert rig.type == "ARMATURE"
for frame in (0, frames - 1):
    scene.frame_set(frame)
    heads = numpy.array([rig.matrix_world @ bone.head for bone in rig.pose.bones])
    low, high = expected[frame].min(axis=0) - 0.05, expected[frame].max(axis=0) + 0.05
    assert ((heads > low) & (heads < high)).all(), f"joints stand outside the skin in frame {frame}"
print(f"{points} vertices over {frames} frames by six files")
