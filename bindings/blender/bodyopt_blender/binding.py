"""A mesh that shows the skin of a basis, in the pose of its armature.

The skin is a point attribute that a modifier of Blender's own nodes takes for the positions: the mesh itself stays as it
is, and a file opens without this add-on.
"""
import os
import re

import bpy
import numpy as np

from . import bodyopt
from .controls import Controls
from .match import match, mesh_points, refuse_parting, require_unchanged
from .rig import Rig, bone_name, matrices_of
from .space import Z_UP, Refusal, file_of, moved, named

SKIN, VERTEX, ERROR, MODIFIER = "bodyopt_skin", "bodyopt_vertex", "bodyopt_error", "Bodyopt"
WORTH_TELLING = 0.05  # standard deviations outside of training
_models = {}  # of files that were read, by path, date, size and level


def load(path, level=0, dynamics="", library=None):
    """A model of paths of this file or a library, read once, with the meshes that are attached to it in the file beside it.
    Raises Refusal for a file that is not there, bodyopt.Error for one that is wrong."""
    if not path:
        raise Refusal("no basis is chosen: name the .safetensors that 'bodyopt train' wrote as Basis")
    names = [file_of(name, library) for name in (path, dynamics) if name]
    for name in names:
        if not os.path.isfile(name):
            what = f"'{name}' is a folder" if os.path.isdir(name) else f"there is no file '{name}'"
            raise Refusal(f"{what}: choose it again")
    beside = os.path.splitext(names[0])[0] + ".attached.safetensors"
    attached = beside if level == 0 and os.path.isfile(beside) else None
    files = [*names, *([attached] if attached else [])]
    key = (level, *((name, os.stat(name).st_mtime_ns, os.stat(name).st_size) for name in files))
    if key not in _models:
        _models[key] = bodyopt.load(*names, level=level, attached=attached)
    return _models[key]


def attached_names(model):
    """Of the meshes that are attached to a model's skin: clothes, eyes, props."""
    return [name for name, _ in model.attached]


def part_of(model, skin, worn):
    """The vertices of each frame, F x N x 3: of an attached mesh, or of the skin itself where `worn` is empty."""
    if not worn:
        return skin.positions
    if worn not in attached_names(model):
        raise Refusal(f"'{worn}' is not attached to the basis any more: its file of attached meshes has "
                      f"{named(attached_names(model)) or 'none'}. Attach it with 'bodyopt attach', or bind again")
    return skin.attached[attached_names(model).index(worn)]


def rest_skin(model, worn=""):
    """The vertices of a model at rest, N x 3, and with each joint turned a little, which tells them apart."""
    poses = np.repeat(model.bind_pose[None], 2, axis=0)
    turned = poses[1, :, 3:7]
    x, y, z, w = turned.T.copy()
    s, c = np.sin(0.1), np.cos(0.1)  # times a turn about x
    turned[:] = np.stack([w * s + x * c, y * c + z * s, z * c - y * s, w * c - x * s], axis=1)
    return part_of(model, model.instance().evaluate(poses, normals=False, tangents=False), worn)


def point_attribute(mesh, name, kind):
    """The attribute of a mesh's vertices, made where it is missing."""
    found = mesh.attributes.get(name)
    if found and (found.data_type != kind or len(found.data) != len(mesh.vertices)):
        mesh.attributes.remove(found)
        found = None
    if not found:
        mesh.attributes.new(name, kind, "POINT")
    return mesh.attributes[name].data  # asked for anew: making one moves the others


def node_group():
    """The nodes that take SKIN for the positions."""
    group = bpy.data.node_groups.get(MODIFIER)
    if group:
        return group
    group = bpy.data.node_groups.new(MODIFIER, "GeometryNodeTree")
    group.inputs.new("NodeSocketGeometry", "Geometry")
    group.outputs.new("NodeSocketGeometry", "Geometry")
    begin, end = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    move, skin = group.nodes.new("GeometryNodeSetPosition"), group.nodes.new("GeometryNodeInputNamedAttribute")
    skin.data_type = "FLOAT_VECTOR"
    skin.inputs["Name"].default_value = SKIN
    group.links.new(begin.outputs[0], move.inputs["Geometry"])
    group.links.new(next(output for output in skin.outputs if output.enabled), move.inputs["Position"])
    group.links.new(move.outputs[0], end.inputs[0])
    for number, node in enumerate((begin, skin, move, end)):
        node.location = 200 * number, 0
    return group


def armature_of(obj):
    """The armature of a binding. Raises Refusal without one."""
    armature = obj.bodyopt.armature or obj.find_armature()
    if not armature or armature.type != "ARMATURE":
        raise Refusal("there is no armature: choose one under Armature")
    return armature


def take_own_mesh(obj):
    """Gives a linked object or an override mesh data of this file, which can be written: whenever a file is read it is the
    library's."""
    if obj.data.library:
        obj.data = obj.data.copy()


def library_of(obj):
    """The library that an object, its override or its mesh is linked from, or None."""
    return obj.override_library.reference.library if obj.override_library else obj.library or obj.data.library


def require_local(obj):
    """Raises Refusal for an object that a file cannot keep changes of."""
    if library := library_of(obj):
        raise Refusal(f"the mesh is linked from '{library.filepath}': do it there, or make it local with Object > Relations > "
                      "Make Local")


def require_own(obj):
    """Raises Refusal for a mesh that a binding cannot write, or that others move, too."""
    if obj.data.users > 1:
        raise Refusal(f"the mesh data is shared by {obj.data.users} objects: Object > Relations > Make Single User")
    if obj.parent_type == "ARMATURE":
        raise Refusal("the parent armature moves the mesh without a modifier: clear the parent, or parent it as Object")
    for modifier in obj.modifiers:
        if modifier.type == "ARMATURE" or modifier.name == MODIFIER:
            break
        if modifier.show_viewport or modifier.show_render:
            raise Refusal(f"the modifier '{modifier.name}' comes before the skin, which takes no notice of it: apply it, "
                          "switch it off, or move it down")


def require_posed(obj, armature, depsgraph):
    """Raises Refusal where Blender leaves an armature as it was, since it is switched off and nothing hangs on it."""
    layer = depsgraph.view_layer
    is_on = armature.visible_get(view_layer=layer) or armature.hide_get(view_layer=layer)  # hidden ones move, too
    if not (is_on or armature.users_scene or armature.users_collection):
        # Kept by the parent and the settings of what was bound to it.
        raise Refusal(f"the armature '{armature.name}' was deleted: undo that, or unbind the mesh")
    is_off = armature.hide_render if depsgraph.mode == "RENDER" else armature.hide_viewport or not is_on
    while is_off and (obj := obj.parent):
        is_off = obj != armature
    if is_off:
        raise Refusal("the armature is switched off, so that Blender does not pose it: make it the mesh's parent, or "
                      "switch it on and hide it with H")


def found_part(model, points, rig, to_world, first):
    """Which mesh of a model the points are at rest, the skin or one that is attached to it: its name, its vertices at rest
    and turned, and what match() gives; `first` is tried first. Raises Refusal where they are none."""
    refusal = None
    for name in sorted(["", *attached_names(model)], key=lambda name: name != first):
        skins = rest_skin(model, name).astype(float)
        try:
            found, rest = match(skins[0], points, rig, to_world)
            rig.settle(rest)  # of two eyes only one is where the bones say
            return name, skins, found, rest
        except Refusal as error:
            refusal = refusal or error
    raise refusal


def bind(obj, first=""):
    """Makes obj, with its settings, show the skin of its basis, or the attached mesh that it is, `first` before others.
    Raises Refusal and bodyopt.Error, and changes nothing then."""
    require_local(obj)
    require_own(obj)
    armature, model = armature_of(obj), load(obj.bodyopt.basis, obj.bodyopt.level)
    rig = Rig(model, armature)
    to_world = np.array(armature.matrix_world)
    in_armature = np.linalg.inv(to_world) @ np.array(obj.matrix_world)
    worn, skins, found, rest = found_part(model, moved(in_armature, mesh_points(obj.data).astype(float)), rig, to_world,
                                          first)
    if not np.array_equal(found, np.arange(len(skins[0]))):
        refuse_parting(found, *skins)
    rig.stand(to_world)

    point_attribute(obj.data, VERTEX, "INT").foreach_set("value", found.astype(np.int32))
    settings = obj.bodyopt
    settings.muted = settings.muted if settings.is_bound else ""
    for modifier in obj.modifiers:
        if modifier.type == "ARMATURE" and modifier.object == armature:
            modifier.object = None  # switched off it would still have Blender evaluate the mesh twice
            settings.muted += modifier.name + "\n"
    modifier = obj.modifiers.get(MODIFIER) or obj.modifiers.new(MODIFIER, "NODES")
    modifier.node_group = node_group()
    while obj.modifiers[0] != modifier:
        with bpy.context.temp_override(object=obj, active_object=obj):
            bpy.ops.object.modifier_move_to_index(modifier=MODIFIER, index=0)
    settings.armature, settings.worn = armature, worn
    settings.rest = rest.T.ravel()
    settings.is_bound = True
    if not worn:
        Controls(model).add_to(obj)


def unbind(obj):
    """Gives the mesh back as it was before bind(). Raises Refusal for one of a library."""
    require_local(obj)
    for name in obj.bodyopt.muted.split("\n"):
        if modifier := obj.modifiers.get(name):
            modifier.object = obj.bodyopt.armature
    if modifier := obj.modifiers.get(MODIFIER):
        obj.modifiers.remove(modifier)
    for name in (SKIN, VERTEX, ERROR):
        if attribute := obj.data.attributes.get(name):
            obj.data.attributes.remove(attribute)
    Controls.remove_from(obj)
    obj.bodyopt.is_bound = False


def driver_of(obj):
    """Whose sliders drive an object: those of the skin that what is worn is on."""
    settings = obj.bodyopt
    if settings.worn:
        for other in obj.users_scene[0].objects if obj.users_scene else ():
            its = other.bodyopt
            if its.is_bound and not its.worn and its.basis == settings.basis and its.armature == settings.armature:
                return other
    return obj


class Binding:
    """What a bound object needs to be shown, made of its settings. Raises Refusal and bodyopt.Error."""

    def __init__(self, obj, dynamics=""):
        settings = obj.bodyopt
        self.model = load(settings.basis, settings.level, dynamics, library_of(obj))
        self.instance = self.model.instance(jiggles=bool(dynamics))
        self.jiggles = bool(dynamics)
        self.rig = Rig(self.model, armature_of(obj), np.array(settings.rest).reshape(4, 4).T)
        self.points = mesh_points(obj.data)
        attribute = obj.data.attributes.get(VERTEX)
        self.vertices = np.full(len(self.points), -1, np.int32)
        if attribute and len(attribute.data) == len(self.points):
            attribute.data.foreach_get("value", self.vertices)
        self.worn = settings.worn
        rest = rest_skin(self.model, self.worn)[0].astype(float)
        require_unchanged(rest, self.points.astype(float), self.vertices)
        self.is_in_order = np.array_equal(self.vertices, np.arange(len(rest)))
        self.controls = Controls(self.model)
        self.feature_names = self.model.feature_names
        self.made_of = self._settings(obj)
        self.shown = None  # what the last skin was made of
        self.come_to = None  # frame, rate and first frame of modifiers
        self.expected_mm, self.notes, self.world = None, [], None  # and the skin in Blender's world, V x 3
        self.untrained = []  # names of bones, the worst first

    @staticmethod
    def _settings(obj):
        settings = obj.bodyopt
        return settings.basis, settings.level, settings.worn, armature_of(obj).name_full, tuple(settings.rest)

    def fits(self, obj):
        """Whether neither the object nor its armature was edited since."""
        return (self.made_of == self._settings(obj) and len(obj.data.vertices) == len(self.points)
                and self.rig.fits(armature_of(obj)) and np.array_equal(mesh_points(obj.data), self.points))

    def show(self, obj, scene, depsgraph):
        """Writes the skin of this moment into the mesh. Returns whether anything had changed."""
        if MODIFIER not in obj.modifiers:
            raise Refusal(f"no modifier has the name '{MODIFIER}', by which the skin is shown: give it its name back, or unbind")
        require_own(obj)
        for modifier in obj.modifiers:
            if modifier.type == "ARMATURE" and modifier.object and modifier.show_viewport:
                raise Refusal(f"the modifier '{modifier.name}' moves the skin a second time: switch it off")
        require_posed(obj, armature_of(obj), depsgraph)
        armature = armature_of(obj).evaluated_get(depsgraph)
        posed, to_world = matrices_of(armature.pose.bones, "matrix"), np.array(armature.matrix_world)
        to_mesh, driver = np.array(obj.evaluated_get(depsgraph).matrix_world), driver_of(obj)
        values = self.controls.read(driver.evaluated_get(depsgraph))
        moment = (scene.frame_current_final, scene.frame_start, scene.render.fps / scene.render.fps_base,
                  obj.bodyopt.shows_error, obj.bodyopt.error_mm)
        inputs = (moment, posed.tobytes(), to_world.tobytes(), to_mesh.tobytes(), values.tobytes())
        if inputs == self.shown:
            return False
        joints, self.notes = self.rig.joints(posed, to_world, self.jiggles)
        skin = self._evaluate(driver, scene, joints[None], values)
        in_mesh = self._in_mesh(part_of(self.model, skin, self.worn)[0], to_world, to_mesh)
        point_attribute(obj.data, SKIN, "FLOAT_VECTOR").foreach_set("vector", in_mesh.ravel())
        self.world = moved(to_mesh, in_mesh)
        self._tell(obj, skin)
        obj.data.update_tag()
        self.shown = inputs
        return True

    def _evaluate(self, driver, scene, joints, values):
        rate, frame = scene.render.fps / scene.render.fps_base, scene.frame_current
        goes_on, come_to = {}, self.come_to
        self.come_to = None  # until all went well
        if self.model.channels:
            if frame > scene.frame_start and come_to != (frame - 1, rate, scene.frame_start):
                if self.controls.are_moved_by_others(driver):
                    self.notes.append("a driver or an NLA strip moves sliders, whose past is taken to be as they are now: play "
                                      "from the first frame, or bake")
                past = self.controls.of_frames(driver, values, range(scene.frame_start, frame))
                self.instance.skip(np.repeat(joints, len(past), axis=0), rate, past)
            goes_on = {"frames_per_second": rate, "channels": self.controls.channels_of(values),
                       "goes_on": frame > scene.frame_start}
        parts = {"controls": self.controls.learned_of(values), "normals": False, "tangents": False,
                 "attached": bool(self.worn), **goes_on}
        if self.jiggles:
            skin = self.instance.jiggle(joints, [frame], **parts)
        else:
            shows_error = driver.bodyopt.shows_error and self.model.knows_error and not self.worn
            skin = self.instance.evaluate(joints, vertex_errors=shows_error, **parts)
        self.come_to = frame, rate, scene.frame_start
        return skin

    def _in_mesh(self, skin, to_world, to_mesh):
        """The skin, N x 3, as vertices of the mesh, V x 3 in its own space."""
        if abs(np.linalg.det(to_mesh[:3, :3])) < 1e-12:
            raise Refusal("the mesh is scaled to nothing: clear its scale with Object > Clear > Scale")
        whole, scale = self.rig.stand(to_world)
        place = Z_UP * [scale, scale, scale, 1]
        if not self.jiggles:
            place[:3, 3] = whole[:3, 3]
        local = (np.linalg.inv(to_mesh) @ place).astype(np.float32)
        return moved(local, skin if self.is_in_order else skin[self.vertices])

    def _tell(self, obj, skin):
        if skin.expected_errors is not None:
            self.expected_mm = 1e3 * float(skin.expected_errors[0])
        excess = skin.excess[0]
        found = np.flatnonzero(excess > WORTH_TELLING)
        outside = [self.feature_names[f] for f in found[np.argsort(-excess[found])]]
        joints = [re.fullmatch("(?:place of )?joint (.*)", feature) for feature in outside]
        self.untrained = list(dict.fromkeys(bone_name(joint[1]) for joint in joints if joint))
        if outside:
            others = len(set(outside)) - 1
            self.notes.append(f"not trained for: {outside[0]}{f' and {others} more' if others else ''}; "
                              f"{100 * skin.fades[0]:.0f} % of what was learned is shown")
        if any(key.value and not key.mute for key in (obj.data.shape_keys.key_blocks[1:] if obj.data.shape_keys else ())):
            self.notes.append("shape keys of the mesh do not show: the skin takes their place")
        if skin.vertex_errors is None:
            return
        if ERROR not in obj.data.attributes:
            obj.data.color_attributes.new(ERROR, "FLOAT_COLOR", "POINT")
        share = np.clip(1e3 * skin.vertex_errors[0][self.vertices] / obj.bodyopt.error_mm, 0, 1)
        colours = np.stack([share, 0 * share, 1 - share, 1 + 0 * share], axis=1)
        obj.data.attributes[ERROR].data.foreach_set("color", colours.astype(np.float32).ravel())
