"""The bones that a basis was not trained to see as they are: drawn in red, and selected by a button."""
import bpy
import gpu
from bpy.props import StringProperty
from gpu_extras.batch import batch_for_shader

from . import live

_drawing = None  # the handle of draw() in Blender


def untrained_bones(obj):
    """The pose bones that the skin of an object was not trained for, the worst first."""
    shown, armature = live.bindings.get(obj.name_full), obj.bodyopt.armature
    if not shown or not armature:
        return []
    return list(filter(None, map(armature.pose.bones.get, shown.untrained)))


def draw():
    """Those of all skins that are seen, over all else of a 3D view."""
    ends = [obj.bodyopt.armature.matrix_world @ end for obj in bpy.context.scene.objects
            if obj.name_full in live.bindings and obj.visible_get()
            for bone in untrained_bones(obj) for end in (bone.head, bone.tail)]
    if not ends:
        return
    shader = gpu.shader.from_builtin("3D_UNIFORM_COLOR")
    shader.uniform_float("color", (1, 0.1, 0.1, 1))
    gpu.state.line_width_set(5)
    batch_for_shader(shader, "LINES", {"pos": ends}).draw(shader)
    gpu.state.line_width_set(1)


def begin_drawing():
    global _drawing
    _drawing = bpy.types.SpaceView3D.draw_handler_add(draw, (), "WINDOW", "POST_VIEW")


def end_drawing():
    bpy.types.SpaceView3D.draw_handler_remove(_drawing, "WINDOW")


class BODYOPT_OT_select_bone(bpy.types.Operator):
    """Select the bones that the basis was not trained for, in Pose Mode"""

    bl_idname, bl_label = "bodyopt.select_bone", "Select Bones"
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}
    skin: StringProperty(description="The bound mesh")

    def execute(self, context):
        skin = bpy.data.objects[self.skin]
        bones, armature = untrained_bones(skin), skin.bodyopt.armature
        if not bones:
            return {"CANCELLED"}
        if context.object != armature or context.mode != "POSE":
            if context.object and context.object.mode != "OBJECT":
                bpy.ops.object.mode_set(mode="OBJECT")
            bpy.ops.object.select_all(action="DESELECT")
            armature.select_set(True)
            context.view_layer.objects.active = armature
            bpy.ops.object.mode_set(mode="POSE")
        names = {bone.name for bone in bones}
        for other in armature.data.bones:
            other.select = other.name in names
        armature.data.bones.active = bones[0].bone
        return {"FINISHED"}


CLASSES = (BODYOPT_OT_select_bone,)
