"""Datasets made of what Blender shows, by any modifiers, shape keys or simulation, and trainings of them."""
import json
import os
import re
import subprocess
import threading
import webbrowser

import bpy
import numpy as np
from bpy.props import BoolProperty, StringProperty
from bpy_extras.anim_utils import bake_action

from .bake import frames_of, write_pc2
from .binding import armature_of
from .panel import Operator, sentence
from .space import Z_UP, Refusal, file_of, moved

training = None  # the Training under way, or the last one


class Preferences(bpy.types.AddonPreferences):
    bl_idname = __package__
    program: StringProperty(name="Program", subtype="FILE_PATH", default="bodyopt",
                            description="bodyopt, which makes datasets and trains")

    def draw(self, context):
        self.layout.prop(self, "program")


def program(context):
    """The program of the preferences."""
    return bpy.path.abspath(context.preferences.addons[__package__].preferences.program)


def folder_of(scene):
    """The folder of the scene's dataset, made where it is missing. Raises Refusal where it cannot be written."""
    if not scene.bodyopt_dataset:
        raise Refusal("choose a folder for the dataset first")
    folder = file_of(scene.bodyopt_dataset)
    try:
        os.makedirs(folder, exist_ok=True)
    except OSError as error:
        raise Refusal(f"the folder '{folder}' cannot be made ({error.strerror}): choose another") from error
    if not os.access(folder, os.W_OK):
        raise Refusal(f"the folder '{folder}' is not writable: choose another")
    return folder


def does_not_run(context, error):
    """The refusal that an OSError of starting the program becomes."""
    return Refusal(f"'{program(context)}' does not run ({error.strerror}): choose bodyopt in the add-on's preferences")


def run(context, *arguments):
    """Runs a verb to its end. Raises Refusal with what it says where it fails."""
    try:
        done = subprocess.run([program(context), *arguments], capture_output=True, text=True, check=False)
    except OSError as error:
        raise does_not_run(context, error) from error
    if done.returncode:
        said = [line for line in done.stderr.split("\n") if line.strip() and not line.startswith("Run with --help")]
        raise Refusal(said[-1] if said else f"bodyopt {arguments[0]} failed ({done.returncode})")


def scene_frames(scene):
    return range(scene.frame_start, scene.frame_end + 1)


def moving_copy(context, armature):
    """A copy of an armature that has all that it shows in the scene's frames, by constraints, too, as one action."""
    copy = armature.copy()
    context.collection.objects.link(copy)
    bake_action(copy, action=None, frames=scene_frames(context.scene), only_selected=False, do_pose=True, do_object=True,
                do_visual_keying=True, do_constraint_clear=True)
    while copy.animation_data.nla_tracks:
        copy.animation_data.nla_tracks.remove(copy.animation_data.nla_tracks[0])
    return copy


def resting_copy(context, obj, armature):
    """A copy of a mesh as it is without modifiers but an armature's, whose one UV layer tells the vertex of each corner."""
    copy = obj.copy()
    copy.data = obj.data.copy()
    copy.shape_key_clear()
    copy.data.materials.clear()
    copy.modifiers.clear()
    copy.modifiers.new("Armature", "ARMATURE").object = armature
    copy.parent = armature
    while copy.data.uv_layers:
        copy.data.uv_layers.remove(copy.data.uv_layers[0])
    corners = np.empty(len(copy.data.loops), np.int32)
    copy.data.loops.foreach_get("vertex_index", corners)
    layer = copy.data.uv_layers.new(do_init=False)
    layer.data.foreach_set("uv", np.stack([corners, 0 * corners], axis=1).astype(np.float32).ravel())
    context.collection.objects.link(copy)
    return copy


def exported_character(context, obj, armature, path):
    """Writes a mesh at rest on its armature, with the scene's motion, as glTF; the vertex of obj of each in it, N."""
    selected, active = list(context.selected_objects), context.view_layer.objects.active
    was_hidden = obj.hide_viewport
    moving = moving_copy(context, armature)
    resting = resting_copy(context, obj, moving)
    try:
        for other in selected:
            other.select_set(False)
        moving.select_set(True)
        resting.select_set(True)
        obj.hide_viewport = True  # else each frame waits for its modifiers several times
        bpy.ops.export_scene.gltf(filepath=path, use_selection=True, export_normals=False, export_materials="NONE",
                                  export_colors=False, export_morph=False, export_force_sampling=True,
                                  export_nla_strips=False, export_anim_single_armature=False)
    finally:
        bpy.data.meshes.remove(resting.data)  # and the object
        bpy.data.actions.remove(moving.animation_data.action)
        bpy.data.objects.remove(moving)
        obj.hide_viewport = was_hidden
        for other in selected:
            other.select_set(True)
        context.view_layer.objects.active = active
    return vertices_in(path)


def vertices_in(path):
    """The numbers that the UV layer of a glTF binary of one mesh holds, N."""
    with open(path, "rb") as file:
        data = file.read()
    length = int.from_bytes(data[12:16], "little")
    gltf, binary = json.loads(data[20:20 + length]), 28 + length
    primitives = [p for mesh in gltf["meshes"] for p in mesh["primitives"]]
    if len(primitives) != 1:
        raise Refusal(f"Blender wrote the mesh in {len(primitives)} parts: bones that carry shapes of their own in it?")
    accessor = gltf["accessors"][primitives[0]["attributes"]["TEXCOORD_0"]]
    view = gltf["bufferViews"][accessor["bufferView"]]
    begin = binary + view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    return np.frombuffer(data, "<f4", 2 * accessor["count"], begin)[::2].round().astype(int)


def shapes_of(context, obj, vertices):
    """What Blender shows of obj in each frame, N x 3, Y up and metres, for the vertices of the exported file."""
    from_world = np.linalg.inv(Z_UP)
    for frame in frames_of(context, scene_frames(context.scene)):
        evaluated = obj.evaluated_get(context.evaluated_depsgraph_get())
        flat = np.empty(3 * len(evaluated.data.vertices), np.float32)
        if len(evaluated.data.vertices) != len(obj.data.vertices):
            raise Refusal(f"in frame {frame} modifiers make {len(evaluated.data.vertices)} vertices of "
                          f"{len(obj.data.vertices)}: switch off or apply those that do (Subdivision, Mirror, ...)")
        evaluated.data.vertices.foreach_get("co", flat)
        yield moved(from_world @ np.array(evaluated.matrix_world), flat.reshape(-1, 3).astype(float))[vertices]


class BODYOPT_OT_add_take(Operator):
    """Add what Blender shows of this mesh over the scene's frames, and the armature's poses, to a dataset"""

    bl_idname, bl_label = "bodyopt.add_take", "Add Take"

    def work(self, context, obj):
        scene, folder = context.scene, folder_of(context.scene)
        name = bpy.path.clean_name(scene.name)
        clip, shapes = (os.path.join(folder, name + ending) for ending in (".glb", ".shapes.pc2"))
        if os.path.exists(clip):  # the poses of the take, and perhaps the character of the dataset
            raise Refusal(f"the dataset has the take '{name}' already: give the scene another name, or choose a new folder")
        next(shapes_of(context, obj, slice(None)))  # what is refused is so before the minutes of an export
        begun, is_added = os.path.exists(os.path.join(folder, "dataset.json")), False
        try:
            vertices = exported_character(context, obj, armature_of(obj), clip)
            write_pc2(shapes, scene.frame_start, shapes_of(context, obj, vertices))
            run(context, "dataset", "add", folder, "--clip", clip, "--shapes", shapes, "--first-frame", "0",
                "--fps", str(scene.render.fps / scene.render.fps_base), "--name", name,
                "--frames", f"{scene.frame_start}-{scene.frame_end}", *([] if begun else ["--character", clip]))
            is_added = True
        finally:
            for path in (shapes, *([] if is_added else [clip])):  # of the shapes the dataset has a copy
                if os.path.exists(path):
                    os.remove(path)
        self.report({"INFO"}, f"added frames {scene.frame_start} to {scene.frame_end} as take '{name}'")


class Training:
    """`bodyopt train` as a process of its own, with the last line that it said."""

    def __init__(self, context, dataset):
        self.basis, self.report = os.path.join(dataset, "basis.safetensors"), os.path.join(dataset, "report")
        self.said, self.is_cancelled = "begins", False
        try:
            self.process = subprocess.Popen(
                [program(context), "train", dataset, "--out", self.basis, "--report", self.report, "--heldout-every", "5"],
                stderr=subprocess.PIPE, stdout=subprocess.DEVNULL)
        except OSError as error:
            raise does_not_run(context, error) from error
        self.reader = threading.Thread(target=self._read, daemon=True)
        self.reader.start()

    def _read(self):
        text = b""
        while piece := os.read(self.process.stderr.fileno(), 4096):
            text = (text + piece)[-4096:]
            if lines := [line for line in re.split(rb"[\r\n]+", text) if line.strip()]:
                self.said = lines[-1].decode(errors="replace")

    def is_running(self):
        return self.process.poll() is None

    def cancel(self):
        self.is_cancelled = True
        self.process.terminate()


def stop():
    """Cancels a training under way, which nobody would be told of any more."""
    if training and training.is_running():
        training.cancel()


class BODYOPT_OT_train(Operator):
    """Train a basis of the dataset, for this mesh, and open its report"""

    bl_idname, bl_label = "bodyopt.train", "Train"
    opens_report: BoolProperty(default=True)

    def execute(self, context):
        global training
        try:
            if training and training.is_running():
                raise Refusal("a training is under way: wait for it, or cancel it")
            folder = folder_of(context.scene)
            if not os.path.exists(os.path.join(folder, "dataset.json")):
                raise Refusal(f"there is no dataset in '{folder}': press Add Take first")
            training = Training(context, folder)
        except Refusal as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.target = context.object.name
        if bpy.app.background:
            training.process.wait()
            return self.end()
        self.timer = context.window_manager.event_timer_add(0.25, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        for area in context.screen.areas:
            area.tag_redraw()
        if training.is_running():
            return {"PASS_THROUGH"}
        context.window_manager.event_timer_remove(self.timer)
        return self.end()

    def end(self):
        training.reader.join()
        if training.process.returncode:
            self.report({"WARNING"} if training.is_cancelled else {"ERROR"},
                        "the training was cancelled" if training.is_cancelled else training.said)
            return {"CANCELLED"}
        if self.target in bpy.data.objects:
            bpy.data.objects[self.target].bodyopt.basis = training.basis
        if self.opens_report:
            webbrowser.open("file://" + os.path.join(training.report, "report.html"))
        return {"FINISHED"}


class BODYOPT_OT_cancel(bpy.types.Operator):
    """Stop the training; the next one goes on from what it kept"""

    bl_idname, bl_label = "bodyopt.cancel", "Cancel"

    def execute(self, context):
        training.cancel()
        return {"FINISHED"}


class BODYOPT_PT_dataset(bpy.types.Panel):
    bl_label, bl_category, bl_space_type, bl_region_type = "Dataset", "Bodyopt", "VIEW_3D", "UI"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout = self.layout
        layout.prop(context.scene, "bodyopt_dataset")
        layout.operator("bodyopt.add_take")
        row = layout.row(align=True)
        row.operator("bodyopt.open_frame")
        row.operator("bodyopt.keep_sculpt")
        if training and training.is_running():
            sentence(layout, context, training.said, "INFO")
            layout.operator("bodyopt.cancel", icon="CANCEL")
            return
        layout.operator("bodyopt.train")
        if training and training.process.returncode and not training.is_cancelled:
            sentence(layout, context, training.said, "ERROR")


CLASSES = (Preferences, BODYOPT_OT_add_take, BODYOPT_OT_train, BODYOPT_OT_cancel, BODYOPT_PT_dataset)
