"""Bodyopt in Blender: skins of trained bases on armatures, baked, and datasets made of what Blender shows."""
bl_info = {
    "name": "Bodyopt",
    "description": "Skins that were learned of simulations, live on an armature",
    "author": "Bodyopt",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "3D View > Sidebar > Bodyopt",
    "category": "Rigging",
}

import bpy
import numpy

from . import bake, dataset, live, mark, panel, sculpt

CLASSES = panel.CLASSES + bake.CLASSES + dataset.CLASSES + sculpt.CLASSES + mark.CLASSES


# Blender 3.4's glTF add-on, by which characters come and go, uses a name that Debian's NumPy 1.24 has dropped.
vars(numpy).setdefault("bool", bool)


def register():
    for kind in CLASSES:
        bpy.utils.register_class(kind)
    bpy.types.Object.bodyopt = bpy.props.PointerProperty(type=panel.Settings, override=panel.CHANGEABLE)
    bpy.types.Scene.bodyopt_dataset = bpy.props.StringProperty(
        name="Folder", subtype="DIR_PATH", description="Folder of the dataset; begun where it is empty")
    for handlers, handler in live.HANDLERS:
        handlers.append(handler)
    mark.begin_drawing()


def unregister():
    dataset.stop()
    mark.end_drawing()
    for handlers, handler in live.HANDLERS:
        handlers.remove(handler)
    live.forget()
    del bpy.types.Scene.bodyopt_dataset, bpy.types.Object.bodyopt
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
