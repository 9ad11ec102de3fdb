# blender --background --factory-startup --python blender_addon_worn.py -- ADDON.zip BODYOPT FOLDER
# What is attached to a skin is shown where `bodyopt eval` has it: meshes that the add-on makes, and those of the scene.
import os
import subprocess
import sys

import bpy
import numpy

sys.path.append(os.path.dirname(__file__))
import addon

zip_file, bodyopt, folder = sys.argv[sys.argv.index("--") + 1:]
addon.install(zip_file)
from bodyopt_blender import live, panel

basis = f"{folder}/dressed.safetensors"
addon.begin()
scene = bpy.context.scene
armature, mesh = addon.add_character(f"{folder}/character.glb")
clip = addon.exported_clip(folder)


def add_sleeve(name):
    """The skin around the middle of the character, 8 mm outside."""
    points = numpy.array([mesh.matrix_world @ vertex.co for vertex in mesh.data.vertices])
    normals = numpy.array([mesh.matrix_world.to_3x3() @ vertex.normal for vertex in mesh.data.vertices])
    near = numpy.abs(points[:, 2] - points[:, 2].mean()) < 0.12
    kept = [polygon.vertices[:] for polygon in mesh.data.polygons if near[list(polygon.vertices)].all()]
    used = sorted({vertex for face in kept for vertex in face})
    places = {vertex: place for place, vertex in enumerate(used)}
    sleeve = bpy.data.meshes.new(name)
    sleeve.from_pydata((points[used] + 0.008 * normals[used]).tolist(), [],
                       [[places[vertex] for vertex in face] for face in kept])
    obj = bpy.data.objects.new(name, sleeve)
    bpy.context.collection.objects.link(obj)
    return obj


sleeve = add_sleeve("sleeve")
addon.activate(sleeve)
bpy.ops.export_scene.gltf(filepath=f"{folder}/sleeve.glb", use_selection=True, export_normals=False)
subprocess.run([bodyopt, "attach", f"{folder}/sleeve.glb", basis], check=True, capture_output=True)
addon.evaluated_by_program(bodyopt, basis, clip, folder)
(written,) = [name for name in os.listdir(folder) if name.startswith("posed.") and name.endswith(".pc2") and name[6:-4]]
expected = addon.z_up(addon.read_pc2(f"{folder}/{written}"))
assert addon.apart(expected[8], expected[0]) > 0.02, "the sleeve hardly moves"


def worst_of(obj, vertices=slice(None)):
    worst = 0
    for frame in (0, 8, 24, 3):
        scene.frame_set(frame)
        assert not live.errors, live.errors
        worst = max(worst, 1e3 * addon.apart(addon.points_of(obj), expected[frame][vertices]))
    return worst


# Made by the add-on: of the vertices in the file's order. Pressed twice it makes no second one.
bpy.data.meshes.remove(sleeve.data)
addon.bind(mesh, basis)
for _ in range(2):
    addon.activate(mesh)
    bpy.ops.bodyopt.add_clothes()
(made,) = [obj for obj in bpy.data.objects if obj.bodyopt.worn]
print(f"a sleeve of {len(made.data.vertices)} vertices within {worst_of(made):.2g} mm of bodyopt eval")
assert worst_of(made) < 0.1
armature.location = 0, 0, 1
scene.frame_set(8)
assert 1e3 * addon.apart(addon.points_of(made) - [0, 0, 1], expected[8]) < 0.1, "not where the armature stands"
armature.location = 0, 0, 0
addon.activate(made)
known = set(bpy.data.objects)
bpy.ops.bodyopt.bake(kind="CACHE", filepath=f"{folder}/sleeve_baked.pc2")
assert addon.apart(addon.read_pc2(f"{folder}/sleeve_baked.pc2"), expected) < 1e-4, "baked it is another"
for obj in set(bpy.data.objects) - known:
    bpy.data.meshes.remove(obj.data)

# One of the scene, on the armature as it was imported, with its vertices in another order; Bind alone finds what it is.
bpy.data.meshes.remove(made.data)
sleeve = add_sleeve("sleeve")
points = numpy.array([vertex.co for vertex in sleeve.data.vertices])
sleeve.parent = armature
sleeve.modifiers.new("Armature", "ARMATURE").object = armature
addon.activate(mesh)
bpy.ops.bodyopt.add_clothes()
assert sleeve.bodyopt.worn and sleeve.bodyopt.is_bound and len([o for o in bpy.data.objects if o.bodyopt.worn]) == 1
scene.frame_set(0)
order = [int(numpy.linalg.norm(expected[0] - point, axis=1).argmin()) for point in addon.points_of(sleeve)]
assert worst_of(sleeve, order) < 0.1
addon.activate(sleeve)
bpy.ops.bodyopt.unbind()
assert (points == [vertex.co for vertex in sleeve.data.vertices]).all() and sleeve.modifiers[0].object == armature
addon.bind(sleeve, basis)
assert sleeve.bodyopt.worn and worst_of(sleeve, order) < 0.1, "Bind takes what is worn for another mesh"

# A file of attached meshes that lacks it: said in a sentence, and live again with the file.
os.rename(f"{folder}/dressed.attached.safetensors", f"{folder}/aside")
live.forget()
scene.frame_set(5)
assert "not attached to the basis any more" in live.errors[sleeve.name_full], live.errors
assert not sleeve.modifiers["Bodyopt"].show_viewport and mesh.modifiers["Bodyopt"].show_viewport
addon.activate(mesh)
try:
    bpy.ops.bodyopt.add_clothes()
    raise SystemExit("added clothes that are not there")
except RuntimeError as error:
    assert "no meshes are attached to the basis" in str(error), error
os.rename(f"{folder}/aside", f"{folder}/dressed.attached.safetensors")
live.forget()
scene.frame_set(6)
assert worst_of(sleeve, order) < 0.1

# Of two eyes each is found by its own name, with or without the number that Blender adds.
found, names = panel.BODYOPT_OT_add_clothes.found, ["eye.L", "eye.R"]
eyes = [bpy.data.objects.new(name, bpy.data.meshes.new(name)) for name in ("eye.R", "eye.L.001")]
for eye in eyes:
    scene.collection.objects.link(eye)
    eye.parent = armature
assert [found(scene, name, names, armature, []) for name in names] == eyes[::-1]
assert found(scene, "eye.R", names, armature, eyes[:1]) is None and found(scene, "eye", ["eye"], armature, []) is None
