"""A bound skin, baked over the scene's frames as a mesh of its own: without armature, in Blender's world."""
import os
import struct

import bpy
import numpy as np
from bpy.props import EnumProperty, StringProperty

from . import live
from .binding import ERROR, MODIFIER, SKIN, VERTEX, Binding, driver_of
from .controls import Controls
from .panel import Operator
from .space import Refusal, file_of


def write_pc2(path, first, shapes):
    """A point cache of shapes, V x 3 each, of consecutive frames: whole or not at all. Raises Refusal where it cannot be
    written."""
    count = points = 0
    try:
        with open(path + ".tmp", "wb") as file:
            file.seek(32)
            for count, shape in enumerate(shapes, 1):
                file.write(shape.astype("<f4").tobytes())
                points = len(shape)
            file.seek(0)
            file.write(struct.pack("<12siiffi", b"POINTCACHE2\0", 1, points, first, 1, count))
        os.replace(path + ".tmp", path)
    except OSError as error:
        raise Refusal(f"'{path}' cannot be written ({error.strerror}): choose a folder that is there, writable and has "
                      "space left") from error
    finally:
        if os.path.exists(path + ".tmp"):
            os.remove(path + ".tmp")


def frames_of(context, frames):
    """The scene in these frames, one after the other, with the progress in the cursor; then in the frame that was."""
    scene, before = context.scene, context.scene.frame_current
    context.window_manager.progress_begin(frames[0], frames[-1])
    try:
        for frame in frames:
            scene.frame_set(frame)
            context.window_manager.progress_update(frame)
            yield frame
    finally:
        context.window_manager.progress_end()
        scene.frame_set(before)


def skins(context, obj, frames, state_in="", state_out=""):
    """The skin in Blender's world, V x 3, of each frame; with jiggle where the object has dynamics, or what it is worn on.

    state_in, state_out: files of the jiggle before the first frame and after the last one. Raises what Binding does.
    """
    scene, dynamics = context.scene, obj.bodyopt.dynamics or driver_of(obj).bodyopt.dynamics
    binding, rate = Binding(obj, dynamics), scene.render.fps / scene.render.fps_base
    if dynamics and abs(binding.model.frames_per_second - rate) > 1e-3:
        raise Refusal(f"the dynamics jiggle at {binding.model.frames_per_second:g} frames a second, the scene has "
                      f"{rate:g}: set the scene's frame rate, or make dynamics of it")
    if (state_in or state_out) and not dynamics:
        raise Refusal("only what jiggles has a state: choose Dynamics, or leave Go on from and Leave empty")
    if state_in:
        binding.instance.set_state(binding.instance.load_state(file_of(state_in)))
    if state_out and not os.access(os.path.dirname(file_of(state_out)) or ".", os.W_OK):
        raise Refusal(f"'{state_out}' cannot be written: choose a folder that is there and writable")
    live.is_held = True
    try:
        for _ in frames_of(context, frames):
            binding.show(obj, scene, context.evaluated_depsgraph_get())
            yield binding.world
        if state_out:
            binding.instance.save_state(binding.instance.state(), file_of(state_out))
    finally:
        live.is_held = False


def cache_file(path):
    """Where a bake writes the mesh cache of this path. Raises Refusal for another kind of file, or a folder not known yet."""
    if not path.lower().endswith(".pc2"):
        raise Refusal(f"'{path}': expected the ending .pc2, of the point cache that a bake writes. Alembic, USD, FBX and glTF "
                      "come of the baked mesh by File > Export")
    return file_of(path)


def baked_copy(context, obj):
    """A copy of a bound object that stands in the world by itself, with the modifiers that come after the skin."""
    baked = obj.copy()
    context.collection.objects.link(baked)
    if baked.override_library:  # which would be bound again when the file is read
        with context.temp_override(selected_objects=[baked], object=baked, active_object=baked):
            bpy.ops.object.make_local(type="SELECT_OBJECT")
    baked.data = obj.data.copy()
    baked.name = baked.data.name = f"{obj.name} baked"
    baked.bodyopt.is_bound = False
    baked.animation_data_clear()
    baked.constraints.clear()
    Controls.remove_from(baked)
    for modifier in [m for m in baked.modifiers if m.type == "ARMATURE" or m.name == MODIFIER]:
        baked.modifiers.remove(modifier)
    for name in (SKIN, VERTEX, ERROR):
        if attribute := baked.data.attributes.get(name):
            baked.data.attributes.remove(attribute)
    baked.shape_key_clear()
    baked.parent = None
    baked.matrix_world.identity()
    return baked


def add_shape_keys(obj, first, shapes):
    """A shape key for each of the shapes, which is shown alone at its frame."""
    for frame, shape in enumerate(shapes, first):
        flat = shape.astype(np.float32).ravel()
        if frame == first:
            obj.data.vertices.foreach_set("co", flat)
            obj.shape_key_add(name="Basis", from_mix=False)
            continue
        key = obj.shape_key_add(name=f"frame {frame}", from_mix=False)
        key.data.foreach_set("co", flat)
        for offset in (-1, 0, 1):
            key.value = offset == 0
            key.keyframe_insert("value", frame=frame + offset)
        for point in obj.data.shape_keys.animation_data.action.fcurves[-1].keyframe_points:
            point.interpolation = "LINEAR"
    obj.data.update()


class BODYOPT_OT_bake(Operator):
    """Bake the skin over the scene's frames, or its preview range, as a mesh that needs no add-on; with dynamics it jiggles"""

    bl_idname, bl_label = "bodyopt.bake", "Bake"
    filepath: StringProperty(name="File", subtype="FILE_PATH")
    kind: EnumProperty(name="As", items=[("CACHE", "Mesh Cache", "A PC2 file, for long shots, Alembic and USD"),
                                         ("KEYS", "Shape Keys", "In the file, for FBX and glTF")])
    state_in: StringProperty(name="Go on from", subtype="FILE_PATH", description="State of the jiggle")
    state_out: StringProperty(name="Leave", subtype="FILE_PATH", description="State of the jiggle after the last frame")

    def invoke(self, context, event):
        self.filepath = f"//{bpy.path.clean_name(context.object.name)}.pc2"  # two characters do not share one
        return context.window_manager.invoke_props_dialog(self, width=400)

    def work(self, context, obj):
        if not obj.bodyopt.is_bound:
            raise Refusal("this mesh is not bound: press Bind first")
        scene = context.scene
        first, last = ((scene.frame_preview_start, scene.frame_preview_end) if scene.use_preview_range
                       else (scene.frame_start, scene.frame_end))
        shapes = skins(context, obj, range(first, last + 1), self.state_in, self.state_out)
        if self.kind == "CACHE":
            write_pc2(cache_file(self.filepath), first, shapes)
            baked = baked_copy(context, obj)
            cache = baked.modifiers.new("Skin", "MESH_CACHE")
            cache.cache_format, cache.filepath, cache.frame_start = "PC2", self.filepath, first
            cache.forward_axis, cache.up_axis = "POS_Y", "POS_Z"
            with context.temp_override(object=baked, active_object=baked):
                bpy.ops.object.modifier_move_to_index(modifier=cache.name, index=0)
        else:
            shapes = list(shapes)
            baked = baked_copy(context, obj)
            add_shape_keys(baked, first, shapes)
        self.report({"INFO"}, f"baked '{baked.name}'")
        live.bindings.pop(obj.name_full, None)


CLASSES = (BODYOPT_OT_bake,)
