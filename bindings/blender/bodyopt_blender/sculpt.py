"""Frames of a dataset as meshes to be sculpted, and the sculpts back into its stack of modifiers (`bodyopt curate`)."""
import os
import tempfile

import bpy
from bpy.props import IntProperty, StringProperty

from .dataset import folder_of, run
from .panel import Operator
from .space import Refusal

TAKE, FRAME = "bodyopt_take", "bodyopt_frame"  # custom properties of a frame's mesh


class BODYOPT_OT_open_frame(Operator):
    """Open a frame of the dataset as a mesh, to be sculpted"""

    bl_idname, bl_label = "bodyopt.open_frame", "Open Frame"
    take: StringProperty(name="Take", description="As the dataset names it")
    frame: IntProperty(name="Frame", default=1)

    @classmethod
    def poll(cls, context):
        return context.mode == "OBJECT"

    def invoke(self, context, event):
        return context.window_manager.invoke_props_dialog(self)

    def work(self, context, obj):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "frame.obj")
            run(context, "curate", "export-frame", folder_of(context.scene), "--take", self.take, "--frame", str(self.frame),
                "--out", path)
            bpy.ops.wm.obj_import(filepath=path)
        opened = context.view_layer.objects.active
        opened[TAKE], opened[FRAME] = self.take, self.frame


class BODYOPT_OT_keep_sculpt(Operator):
    """Put what was sculpted of this frame into the dataset, as its modifier 'sculpt'; Train learns it"""

    bl_idname, bl_label = "bodyopt.keep_sculpt", "Keep Sculpt"

    def work(self, context, obj):
        if TAKE not in obj:
            raise Refusal("this mesh is no frame of a dataset: press Open Frame, and sculpt what it opens")
        for other in list(context.selected_objects):
            other.select_set(other == obj)
        obj.select_set(True)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "sculpt.obj")
            bpy.ops.wm.obj_export(filepath=path, export_selected_objects=True, export_materials=False, export_uv=False,
                                  export_normals=False, apply_modifiers=True)
            run(context, "curate", "import-frame", folder_of(context.scene), "--take", obj[TAKE], "--frame", str(obj[FRAME]),
                "--mesh", path, "--name", "sculpt")
        self.report({"INFO"}, f"frame {obj[FRAME]} of take '{obj[TAKE]}' is as it was sculpted")


CLASSES = (BODYOPT_OT_open_frame, BODYOPT_OT_keep_sculpt)
