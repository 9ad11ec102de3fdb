"""The bones of an armature as the joints of a basis."""
import numpy as np

from .space import Z_UP, Refusal, compose, decompose, moved, named, scale_of


def bone_name(joint):
    """Of a joint's name the 63 bytes that Blender keeps."""
    return joint.encode()[:63].decode(errors="ignore")


def matrices_of(collection, attribute):
    """The matrices, N x 4 x 4, that all members of a collection have in an attribute."""
    flat = np.empty(16 * len(collection), np.float32)
    collection.foreach_get(attribute, flat)
    return flat.reshape(-1, 4, 4).transpose(0, 2, 1).astype(float)


def bind_matrices(model):
    """Where the joints of a model stand at rest, J x 4 x 4, Y up and metres."""
    matrices = compose(model.bind_pose)
    for joint, parent in enumerate(model.joint_parents):
        if parent >= 0:
            matrices[joint] = matrices[parent] @ matrices[joint]
    return matrices


class Rig:
    """Which bone is which joint, and the difference of their axes at rest.

    `rest`: 4 x 4, from the space of the basis to that of the armature at rest. Raises Refusal for another armature.
    """

    def __init__(self, model, armature, rest=None):
        self.names = [bone.name for bone in armature.data.bones]
        self.rest_matrices = matrices_of(armature.data.bones, "matrix_local")
        self.parents = np.array(model.joint_parents)
        self.bind = bind_matrices(model)
        self.joint_names = [bone_name(name) for name in model.joint_names]
        self.bones = self._find_bones()
        self.heads = self.rest_matrices[self.bones, :3, 3]
        if rest is not None:
            self.settle(rest)

    def _find_bones(self):
        numbers = {name: number for number, name in enumerate(self.names)}
        missing = [name for name in self.joint_names if name not in numbers]
        if len(missing) == len(self.joint_names):
            raise Refusal("another armature: none of its bones has the name of a joint that the basis was trained "
                          f"with ({named(self.joint_names)})")
        if missing:
            spare = [name for name in self.names if name not in self.joint_names]
            raise Refusal(f"the armature lacks {len(missing)} of {len(self.joint_names)} bones: {named(missing)}"
                          + (f"; was one renamed to {named(spare)}? Give it its name back" if spare else ""))
        return np.array([numbers[name] for name in self.joint_names])

    def settle(self, rest):
        """Takes `rest`. Raises Refusal where bones do not stand where it has the joints."""
        self.rest = rest
        places = moved(rest, self.bind[:, :3, 3])
        off = np.linalg.norm(places - self.heads, axis=1)
        # Of all bones the size is that of the armature; one bone alone has none.
        extent = max(np.ptp(places, axis=0).max(), 0.1 * np.abs(places).max())
        if off.max() > 2e-3 * extent:
            worst = int(off.argmax())
            raise Refusal(f"another rest pose: bone '{self.joint_names[worst]}' stands {100 * off[worst] / extent:.1f} % "
                          "of the rig's size from where the basis has its joint. Bind again, or train with this armature")
        self.to_joint = np.linalg.inv(self.rest_matrices[self.bones]) @ rest @ self.bind

    def fits(self, armature):
        """Whether the armature is still the one that this was made of: neither renamed nor edited."""
        bones = armature.data.bones
        return (len(bones) == len(self.names) and np.array_equal(matrices_of(bones, "matrix_local"), self.rest_matrices)
                and [bone.name for bone in bones] == self.names)

    def stand(self, to_world):
        """Where the character stands, 4 x 4: a similarity from its space to Blender's world, and its scale."""
        whole = to_world @ self.rest
        return whole, scale_of(whole)

    def joints(self, posed, to_world, keeps_place):
        """The joints, J x 10 relative to their parents, of the bones' pose matrices, B x 4 x 4.

        In the world of the basis, turned as the armature is (gravity has a direction there), in metres; at the
        armature's place if `keeps_place`, or else at the origin, where float32 is finest. Returns warnings beside them.
        """
        whole, scale = self.stand(to_world)
        world = np.linalg.inv(Z_UP) @ to_world @ posed[self.bones] @ self.to_joint
        origin = 0 if keeps_place else (np.linalg.inv(Z_UP) @ whole)[:3, 3]
        world[:, :3, 3] -= origin
        world[:, :3] /= scale
        flat = np.linalg.det(world[:, :3, :3]) <= 1e-9
        if flat.any():
            raise Refusal(f"bones are mirrored or scaled to nothing: {named(self._names_of(flat))}. "
                          "Clear their scale with Pose > Clear Transform > Scale")
        local = world.copy()
        children = self.parents >= 0
        local[children] = np.linalg.solve(world[self.parents[children]], world[children])
        numbers, shear = decompose(local)
        sheared = shear > 1e-3
        return numbers, ([f"scaled across their axes, which joints cannot be: {named(self._names_of(sheared))}"]
                         if sheared.any() else [])

    def _names_of(self, mask):
        return [self.joint_names[joint] for joint in np.flatnonzero(mask)]
