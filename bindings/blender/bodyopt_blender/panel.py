"""Settings of a bound object, the panel in the sidebar of the 3D view, and its buttons."""
import re

import bpy
import numpy as np
from bpy.props import BoolProperty, FloatProperty, FloatVectorProperty, IntProperty, PointerProperty, StringProperty

from . import binding, bodyopt, live
from .controls import PREFIX
from .space import Z_UP, Refusal, moved, named, similarity


CHANGEABLE = {"LIBRARY_OVERRIDABLE"}


def refresh(settings, context):
    """After a setting has changed: shown at once."""
    live.show_all(context.scene, context.evaluated_depsgraph_get())


class Settings(bpy.types.PropertyGroup):
    """What a file keeps of a binding."""

    basis: StringProperty(name="Basis", subtype="FILE_PATH", description="What `bodyopt train` wrote: FILE.safetensors")
    dynamics: StringProperty(name="Dynamics", subtype="FILE_PATH", override=CHANGEABLE,
                             description="What `bodyopt dynamics` wrote: with it a bake jiggles")
    armature: PointerProperty(name="Armature", type=bpy.types.Object, poll=lambda _, obj: obj.type == "ARMATURE",
                              override=CHANGEABLE, description="The rig that poses the skin; without one that of the mesh")
    level: IntProperty(name="Level of Detail", min=0, description="Of a proxy: 0 is the finest")
    is_bound: BoolProperty()
    is_live: BoolProperty(name="Live", default=True, update=refresh, override=CHANGEABLE, description="Follow the armature")
    shows_error: BoolProperty(name="Expected Error", update=refresh, override=CHANGEABLE, description="As the colour attribute "
                              f"'{binding.ERROR}': blue where nothing is expected, red from the largest on")
    error_mm: FloatProperty(name="Largest (mm)", default=5, min=0.01, update=refresh, override=CHANGEABLE)
    worn: StringProperty(description="The mesh that is attached to the skin of the basis; empty: the skin itself")
    muted: StringProperty()
    rest: FloatVectorProperty(size=16)


def without_number(name):
    """`eye.L` of `eye.L.001`."""
    return re.sub(r"\.\d+$", "", name)


class Operator(bpy.types.Operator):
    """An operator on the active mesh, whose refusals are Blender's errors."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return context.object and context.object.type == "MESH" and context.mode == "OBJECT"

    def execute(self, context):
        try:
            self.work(context, context.object)
        except (Refusal, bodyopt.Error, OSError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        refresh(None, context)
        return {"FINISHED"}


class BODYOPT_OT_bind(Operator):
    """Show the skin of the basis on this mesh, by its armature"""

    bl_idname, bl_label = "bodyopt.bind", "Bind"

    def work(self, context, obj):
        live.bindings.pop(obj.name_full, None)
        binding.bind(obj)


class BODYOPT_OT_unbind(Operator):
    """Give the mesh back as it was"""

    bl_idname, bl_label = "bodyopt.unbind", "Unbind"

    def work(self, context, obj):
        binding.unbind(obj)
        live.bindings.pop(obj.name_full, None)
        live.errors.pop(obj.name_full, None)


class BODYOPT_OT_add_skin(Operator):
    """Add a mesh of the basis, at this level of detail, to the active armature, and bind it"""

    bl_idname, bl_label = "bodyopt.add_skin", "Add Skin"
    filepath: StringProperty(subtype="FILE_PATH")
    level: IntProperty(min=0)

    @classmethod
    def poll(cls, context):
        return context.object and context.object.type == "ARMATURE" and context.mode == "OBJECT"

    def invoke(self, context, event):
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def work(self, context, armature):
        model = binding.load(self.filepath, self.level)
        rig = binding.Rig(model, armature)
        rest = similarity(rig.bind[:, :3, 3], rig.heads)
        rest = np.linalg.inv(np.array(armature.matrix_world)) @ Z_UP if rest is None else rest
        mesh = bpy.data.meshes.new("skin")
        mesh.from_pydata(moved(rest, binding.rest_skin(model)[0]).tolist(), [], model.triangles.tolist())
        mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
        obj = bpy.data.objects.new(mesh.name, mesh)
        context.collection.objects.link(obj)
        obj.parent = armature
        obj.bodyopt.basis, obj.bodyopt.level, obj.bodyopt.armature = self.filepath, self.level, armature
        context.view_layer.update()
        try:
            binding.bind(obj)
        except (Refusal, bodyopt.Error):
            bpy.data.meshes.remove(mesh)  # and its object
            raise


class BODYOPT_OT_add_clothes(Operator):
    """Bind the meshes that are attached to this skin (clothes, eyes, props): those of the scene, or else new ones"""

    bl_idname, bl_label = "bodyopt.add_clothes", "Add Clothes"

    def work(self, context, obj):
        binding.require_local(obj)
        settings = obj.bodyopt
        if not settings.is_bound or settings.worn:
            raise Refusal("this mesh is not bound as a skin: press Bind first")
        model = binding.load(settings.basis, settings.level)
        if not model.attached:
            raise Refusal("no meshes are attached to the basis: 'bodyopt train' attaches those of the character's file, "
                          "'bodyopt attach' others. They stand beside the basis, as NAME.attached.safetensors")
        armature, made, wearers = binding.armature_of(obj), [], []
        rest = np.array(settings.rest).reshape(4, 4).T
        for name, triangles in model.attached:
            worn = self.found(context.scene, name, binding.attached_names(model), armature, wearers)
            if not worn:
                worn = self.add(context, armature, name, moved(rest, binding.rest_skin(model, name)[0]), triangles)
                made.append(worn)
            wearers.append(worn)
            worn.bodyopt.basis, worn.bodyopt.level, worn.bodyopt.armature = settings.basis, settings.level, armature
            context.view_layer.update()
            live.bindings.pop(worn.name_full, None)
            try:
                binding.bind(worn, name)
            except (Refusal, bodyopt.Error) as refusal:
                for mesh in [o.data for o in made]:
                    bpy.data.meshes.remove(mesh)  # and its object
                raise Refusal(f"'{worn.name}': {refusal}") from refusal
        self.require_all(model, wearers)

    @staticmethod
    def found(scene, name, names, armature, taken):
        """The mesh of the scene that wears this name, or has it, or has it but for the number that Blender adds."""
        meshes = [o for o in scene.objects if o.type == "MESH" and o not in taken
                  and armature in (o.parent, o.find_armature(), o.bodyopt.armature)]
        free = [o for o in meshes if not o.bodyopt.is_bound]
        plain = [o for o in free if o.name not in names and without_number(o.name) == without_number(name)]
        return next((o for o in [*(o for o in meshes if o.bodyopt.worn == name),
                                 *(o for o in free if o.name == name), *plain]), None)

    @staticmethod
    def require_all(model, wearers):
        missing = set(binding.attached_names(model)) - {o.bodyopt.worn for o in wearers}
        if missing:
            raise Refusal(f"no mesh shows {named(sorted(missing))}: meshes of the scene with such names are of another "
                          "part; rename them, and add clothes again")

    @staticmethod
    def add(context, armature, name, points, triangles):
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata(points.tolist(), [], triangles.tolist())
        mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
        obj = bpy.data.objects.new(name, mesh)
        context.collection.objects.link(obj)
        obj.parent = armature
        return obj


class BODYOPT_PT_skin(bpy.types.Panel):
    bl_label, bl_category, bl_space_type, bl_region_type = "Bodyopt", "Bodyopt", "VIEW_3D", "UI"

    def draw(self, context):
        layout, obj = self.layout, context.object
        layout.use_property_split = True
        if obj and obj.type == "ARMATURE":
            layout.operator("bodyopt.add_skin", icon="OUTLINER_OB_MESH")
            for skin in (o for o in context.scene.objects if o.bodyopt.is_bound and o.bodyopt.armature == obj):
                layout.label(text=skin.name, icon="OUTLINER_OB_MESH")
                draw_shown(layout, context, skin)
            return
        if not obj or obj.type != "MESH":
            layout.label(text="Select a mesh, or an armature", icon="INFO")
            return
        settings = obj.bodyopt
        layout.prop(settings, "basis")
        column = layout.column()
        column.enabled = not settings.is_bound
        column.prop(settings, "armature")
        column.prop(settings, "level")
        row = layout.row(align=True)
        row.operator("bodyopt.bind", text="Bind Again" if settings.is_bound else "Bind")
        if not settings.is_bound:
            return
        row.operator("bodyopt.unbind")
        layout.prop(settings, "dynamics")
        if settings.worn:
            layout.label(text=f"worn: {settings.worn}", icon="MOD_CLOTH")
        elif settings.level == 0:
            layout.operator("bodyopt.add_clothes", icon="MOD_CLOTH")
        layout.operator("bodyopt.bake", icon="FILE_CACHE")
        draw_shown(layout, context, obj)


def draw_shown(layout, context, obj):
    """What a bound object shows: why not, how well, and its sliders."""
    settings = obj.bodyopt
    layout.prop(settings, "is_live")
    if error := live.errors.get(obj.name_full):
        sentence(layout, context, error, "ERROR")
    shown = live.bindings.get(obj.name_full)
    for note in shown.notes if shown else ():
        sentence(layout, context, note, "INFO")
    if shown and shown.untrained and not settings.armature.library:
        others = len(shown.untrained) - 1
        text = f"Select {shown.untrained[0]}{f' and {others} more' if others else ''}"
        layout.operator("bodyopt.select_bone", icon="BONE_DATA", text=text).skin = obj.name
    if shown and shown.expected_mm is not None:
        layout.label(text=f"Expected error {shown.expected_mm:.2f} mm RMS")
        layout.prop(settings, "shows_error")
        if settings.shows_error:
            layout.prop(settings, "error_mm")
    for key in (key for key in obj.keys() if key.startswith(PREFIX)):
        layout.prop(obj, f'["{key}"]', text=key[len(PREFIX):])


def sentence(layout, context, text, icon):
    """A sentence over as many lines as the panel's width asks for."""
    width = max(16, int(context.region.width / (7 * context.preferences.system.ui_scale)) - 6)
    column, line = layout.column(align=True), ""
    for word in text.split() + [None]:
        if word is None or (line and len(line) + len(word) >= width):
            column.label(text=line, icon=icon)
            icon, line = "BLANK1", ""
        line += f" {word}" if line else word or ""


CLASSES = (Settings, BODYOPT_OT_bind, BODYOPT_OT_unbind, BODYOPT_OT_add_skin, BODYOPT_OT_add_clothes, BODYOPT_PT_skin)
