# xvfb-run blender --factory-startup --python blender_addon_window.py -- ADDON.zip BODYOPT FOLDER
# In a window: the panel of a mesh and of its armature, the bone that the basis was not trained for in red, and a training whose
# report is opened by the browser of the environment. FOLDER has the dataset `of_blender`.
import os
import sys
import traceback

import bpy
import numpy

sys.path.append(os.path.dirname(__file__))
import addon

zip_file, bodyopt, folder = sys.argv[sys.argv.index("--") + 1:]
bpy.context.preferences.view.show_splash = False
addon.install(zip_file)
from bodyopt_blender import dataset, live, panel

drawn, wrong = set(), []


def watched(draw):
    """A panel's draw(), which tells for what it was drawn, and what was wrong: Blender itself only prints that."""
    def watch(panel, context):
        try:
            draw(panel, context)
            drawn.add((panel.bl_label, context.object.type))
        except Exception:
            wrong.append(traceback.format_exc())
    return watch


for kind in (panel.BODYOPT_PT_skin, dataset.BODYOPT_PT_dataset):
    bpy.utils.unregister_class(kind)
    kind.bl_category, kind.bl_options, kind.draw = "Item", set(), watched(kind.draw)  # the tab that is open
    bpy.utils.register_class(kind)


def red_pixels():
    """Of the window as it is drawn: of a red that Blender's own colours do not have."""
    bpy.ops.screen.screenshot(filepath=f"{folder}/window.png")
    image = bpy.data.images.load(f"{folder}/window.png")
    red, green, blue, _ = numpy.array(image.pixels).reshape(-1, 4).T
    bpy.data.images.remove(image)
    return ((red > 0.9) & (green < 0.2) & (blue < 0.2)).sum()


def steps():
    """Yields where Blender is to draw and to handle events."""
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
    area.spaces[0].show_region_ui = True
    region = next(region for region in area.regions if region.type == "WINDOW")
    here = bpy.context.temp_override(window=window, area=area, region=region)
    with here:
        bpy.data.objects.remove(bpy.data.objects["Cube"])
        armature, mesh = addon.add_character(f"{folder}/character.glb", moves=False)
        bpy.ops.view3d.view_selected()
        addon.bind(mesh, f"{folder}/basis.safetensors")
        addon.activate(armature)
    area.spaces[0].overlay.show_axis_x = area.spaces[0].overlay.show_floor = False
    yield
    with here:
        before = red_pixels()
    elbow = armature.pose.bones["elbow"]
    elbow.rotation_mode, elbow.rotation_euler = "XYZ", (0, 0, 2.5)
    yield
    assert live.bindings[mesh.name_full].untrained == ["elbow"]
    with here:
        marked = red_pixels() - before
        print(f"a bone of {marked} red pixels")
        assert marked > 20, "the bone is not marked"
        addon.activate(mesh)
    bpy.context.preferences.addons["bodyopt_blender"].preferences.program = bodyopt
    bpy.context.scene.bodyopt_dataset = f"{folder}/of_blender"
    with here:
        assert bpy.ops.bodyopt.train("INVOKE_DEFAULT") == {"RUNNING_MODAL"}
    while dataset.training.is_running() or not os.path.exists(f"{folder}/opened"):
        yield
        assert not dataset.training.process.returncode, dataset.training.said
    assert mesh.bodyopt.basis == f"{folder}/of_blender/basis.safetensors"
    assert open(f"{folder}/opened").read() == f"file://{folder}/of_blender/report/report.html\n"
    assert drawn == {(label, kind) for label in ("Bodyopt", "Dataset") for kind in ("MESH", "ARMATURE")} and not wrong, wrong
    assert not live.errors, live.errors


def go_on(all_steps=steps()):
    try:
        next(all_steps)
        return 0.5
    except StopIteration:
        os._exit(0)
    except Exception:
        traceback.print_exc()
        os._exit(1)


bpy.app.timers.register(go_on, first_interval=1)
