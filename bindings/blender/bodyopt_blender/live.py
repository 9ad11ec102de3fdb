"""Keeps bound meshes in their poses: after every change of the scene and every frame."""
import traceback

import bpy
from bpy.app.handlers import persistent

from . import bodyopt
from .binding import MODIFIER, Binding, take_own_mesh
from .space import Refusal

bindings = {}  # by the object's name: Binding; never an object, which undo and loading a file replace
errors = {}  # by the object's name: a sentence
is_held = False  # while a bake evaluates in an order of its own


def attempt(name, task):
    """Runs task(), keeps what it refuses as the sentence of the object of this name, and gives back its result."""
    try:
        result = task()
        errors.pop(name, None)
        return result
    except (Refusal, bodyopt.Error) as error:
        errors[name] = str(error)
    except Exception as error:  # a defect of this add-on must not stop Blender's own work
        traceback.print_exc()
        errors[name] = f"a defect of the add-on, told in the console: {error}"
    return None


def binding_of(obj):
    """The binding of an object, made anew after an edit. Raises Refusal and bodyopt.Error."""
    take_own_mesh(obj)
    binding = bindings.get(obj.name_full)
    if not binding or not binding.fits(obj):
        binding = bindings[obj.name_full] = Binding(obj)
    return binding


def show(obj, scene, depsgraph):
    """Shows a bound object's skin, or else its mesh at rest and why."""
    name = obj.name_full
    changed = attempt(name, lambda: binding_of(obj).show(obj, scene, depsgraph))
    if changed is None:
        bindings.pop(name, None)
    modifier, is_right = obj.modifiers.get(MODIFIER), changed is not None
    if modifier and modifier.show_viewport != is_right:
        modifier.show_viewport = modifier.show_render = is_right
        changed = True
    if changed and bpy.context.window_manager:
        for window in bpy.context.window_manager.windows:
            for area in window.screen.areas:
                if area.type in {"VIEW_3D", "PROPERTIES"}:
                    area.tag_redraw()


def show_all(scene, depsgraph):
    """Shows all bound objects that are live and that Blender evaluates, of instanced collections, too."""
    if is_held:
        return
    for obj in bpy.data.objects:
        if (obj.type == "MESH" and obj.bodyopt.is_bound and obj.bodyopt.is_live and obj.mode != "EDIT"
                and obj.evaluated_get(depsgraph).is_evaluated):
            show(obj, scene, depsgraph)


@persistent
def on_change(scene, depsgraph):
    show_all(scene, depsgraph)


@persistent
def forget(*_):
    """After undo and after a file is read: what is known of objects may be of others."""
    bindings.clear()
    errors.clear()


@persistent
def on_load(*_):
    forget()
    show_all(bpy.context.scene, bpy.context.evaluated_depsgraph_get())


HANDLERS = ((bpy.app.handlers.depsgraph_update_post, on_change), (bpy.app.handlers.frame_change_post, on_change),
            (bpy.app.handlers.undo_post, forget), (bpy.app.handlers.redo_post, forget),
            (bpy.app.handlers.load_post, on_load))
