"""The bones that a basis was not trained to see as they are: drawn in red, and selected by a button."""
import bpy
import gpu
from bpy.props import StringProperty
from gpu_extras.batch import batch_for_shader

from . import live

_drawing = None  # the handle of draw() in Blender


def untrained_bone(obj):
    """The armature and the pose bone that the skin of an object was not trained for, or None."""
    shown, armature = live.bindings.get(obj.name_full), obj.bodyopt.armature
    bone = shown and armature and shown.untrained and armature.pose.bones.get(shown.untrained)
    return (armature, bone) if bone else None


def draw():
    """Those of all skins that are seen, over all else of a 3D view."""
    found = [untrained_bone(obj) for obj in bpy.context.scene.objects
             if obj.name_full in live.bindings and obj.visible_get()]
    ends = [armature.matrix_world @ end for armature, bone in filter(None, found) for end in (bone.head, bone.tail)]
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
    """Select the bone that the basis was not trained for, in Pose Mode"""

    bl_idname, bl_label = "bodyopt.select_bone", "Select Bone"
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}
    skin: StringProperty(description="The bound mesh")

    def execute(self, context):
        found = untrained_bone(bpy.data.objects[self.skin])
        if not found:
            return {"CANCELLED"}
        armature, bone = found
        if context.object != armature or context.mode != "POSE":
            if context.object and context.object.mode != "OBJECT":
                bpy.ops.object.mode_set(mode="OBJECT")
            bpy.ops.object.select_all(action="DESELECT")
            armature.select_set(True)
            context.view_layer.objects.active = armature
            bpy.ops.object.mode_set(mode="POSE")
        for other in armature.data.bones:
            other.select = other.name == bone.name
        armature.data.bones.active = bone.bone
        return {"FINISHED"}


CLASSES = (BODYOPT_OT_select_bone,)
