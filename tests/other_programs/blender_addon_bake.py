# blender --background --factory-startup --python blender_addon_bake.py -- ADDON.zip BODYOPT FOLDER
# A bound skin is baked as a mesh cache and as shape keys, which Blender plays, and takes to Alembic, USD, glTF and FBX, as it
# shows the skin itself. Alembic and USD where this Blender is built with them.
import os
import resource
import sys

import bpy
import numpy

sys.path.append(os.path.dirname(__file__))
import addon

zip_file, bodyopt, folder = sys.argv[sys.argv.index("--") + 1:]
addon.install(zip_file)
from bodyopt_blender import live

addon.begin()
scene = bpy.context.scene
armature, mesh = addon.add_character(f"{folder}/character.glb")
addon.bind(mesh, f"{folder}/basis.safetensors")
armature.location = 1, 2, 0.5
mesh.scale = 1, 1.2, 1  # which the skin takes no notice of
FRAMES = range(25)


def played(obj, first=0):
    frames = []
    for frame in FRAMES:
        scene.frame_set(first + frame)
        frames.append(addon.points_of(obj))
    return numpy.array(frames)


def baked(**options):
    addon.activate(mesh)
    known = set(bpy.data.objects)
    bpy.ops.bodyopt.bake(**options)
    (made,) = set(bpy.data.objects) - known
    return made


def refuses_to_bake(said, **options):
    """Nothing is made, nothing half-written, and the skin is live as before."""
    objects, files = set(bpy.data.objects), set(os.listdir(folder))
    try:
        baked(**options)
    except RuntimeError as error:
        assert said in str(error), f"'{said}' is not in: {error}"
    else:
        raise AssertionError(f"baked in spite of: {said}")
    assert set(bpy.data.objects) == objects and set(os.listdir(folder)) == files and not live.is_held
    print("refused:", said)


def read_back(obj, name, export, read, tolerance):
    """What another file of Blender's exporters has of an object, compared where its vertices are in the same order."""
    path = f"{folder}/baked.{name}"
    addon.activate(obj)
    export(path)
    known = set(bpy.data.objects)
    read(path)
    made = next(o for o in bpy.data.objects if o not in known and o.type == "MESH")
    action = made.data.shape_keys and made.data.shape_keys.animation_data
    if action and not action.action:  # the importer leaves it in a track
        action.action = action.nla_tracks[0].strips[0].action
    first = int(action.action.frame_range[0]) if action else 0
    found = played(made, first)
    assert found.shape == shown.shape, f"{name}: {found.shape} of {shown.shape}"
    worst = addon.apart(found, shown)
    print(f"{name}: {worst:.2g} m")
    assert worst < tolerance, name
    bpy.data.meshes.remove(made.data)


refuses_to_bake("was never saved", kind="CACHE", filepath="//skin.pc2")
refuses_to_bake("'//skin.abc': expected the ending .pc2", kind="CACHE", filepath="//skin.abc")
refuses_to_bake("cannot be written (No such file or directory)", kind="CACHE", filepath=f"{folder}/nowhere/skin.pc2")
refuses_to_bake("only what jiggles has a state", kind="KEYS", state_out=f"{folder}/some.state")
resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 20, resource.RLIM_INFINITY))
refuses_to_bake("cannot be written (File too large)", kind="CACHE", filepath=f"{folder}/large.pc2")
resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))

shown = played(mesh)
assert not live.errors and addon.apart(shown[8], shown[0]) > 0.05
cache = baked(kind="CACHE", filepath=f"{folder}/baked.pc2")
keys = baked(kind="KEYS")
assert mesh.bodyopt.is_bound and addon.apart(played(mesh), shown) == 0, "a bake changes what is live"
for obj in (cache, keys):
    worst = addon.apart(played(obj), shown)
    print(f"{obj.name} as {'shape keys' if obj is keys else 'mesh cache'}: {worst:.2g} m")
    assert worst < 1e-5 and not obj.bodyopt.is_bound and not obj.find_armature()

# With jiggle, as the program makes it; in two parts that go on from a state as in one.
armature.location, mesh.scale = (0, 0, 0), (1, 1, 1)
mesh.bodyopt.dynamics = f"{folder}/soft.safetensors"
expected = addon.evaluated_by_program(bodyopt, f"{folder}/basis.safetensors", addon.exported_clip(folder), folder, "--jiggle",
                                      "--dynamics", mesh.bodyopt.dynamics)
whole = played(baked(kind="CACHE", filepath=f"{folder}/soft.pc2"))
print(f"with jiggle, which moves it by {1e3 * addon.apart(whole, played(mesh)):.1f} mm: {addon.apart(whole, expected):.2g} m "
      "from bodyopt eval")
assert addon.apart(whole, played(mesh)) > 0.001 and addon.apart(whole, expected) < 1e-4
scene.use_preview_range = True
scene.frame_preview_start, scene.frame_preview_end = 0, 12
baked(kind="CACHE", filepath=f"{folder}/first.pc2", state_out=f"{folder}/twelve.state")
scene.frame_preview_start, scene.frame_preview_end = 13, 24
rest = baked(kind="CACHE", filepath=f"{folder}/second.pc2", state_in=f"{folder}/twelve.state")
assert addon.apart(addon.read_pc2(f"{folder}/second.pc2"), whole[13:]) < 1e-6
scene.use_preview_range = False
scene.render.fps = 24
refuses_to_bake("the dynamics jiggle at 30 frames a second, the scene has 24", kind="CACHE", filepath=f"{folder}/other.pc2")
scene.render.fps = 30
refuses_to_bake("'//next.state' lies beside", kind="CACHE", filepath=f"{folder}/other.pc2", state_out="//next.state")
armature.location = 1, 2, 0.5

read_back(keys, "glb", lambda path: bpy.ops.export_scene.gltf(filepath=path, use_selection=True, export_normals=False,
                                                              export_texcoords=False, export_materials="NONE"),
          lambda path: bpy.ops.import_scene.gltf(filepath=path), 1e-5)
read_back(keys, "fbx", lambda path: bpy.ops.export_scene.fbx(filepath=path, use_selection=True, bake_anim_simplify_factor=0,
                                                             bake_anim_use_all_actions=False, bake_anim_use_nla_strips=False),
          lambda path: bpy.ops.import_scene.fbx(filepath=path), 1e-4)
for program, export, read in (("alembic", "alembic_export", "alembic_import"), ("usd", "usd_export", "usd_import")):
    if not getattr(bpy.app.build_options, program):
        print(f"skipped: this Blender is built without {program}")
        continue
    if program == "usd":
        read_back(cache, "usdc", lambda path: bpy.ops.wm.usd_export(filepath=path, selected_objects_only=True,
                                                                   export_animation=True),
                  lambda path: bpy.ops.wm.usd_import(filepath=path), 1e-5)
    else:
        read_back(cache, "abc", lambda path: bpy.ops.wm.alembic_export(filepath=path, selected=True),
                  lambda path: bpy.ops.wm.alembic_import(filepath=path, as_background_job=False), 1e-5)
