"""Which vertex of a mesh is which of a basis."""
import numpy as np

from .space import Z_UP, Refusal, moved, nearest, similarity, size_of


def mesh_points(mesh):
    """The vertices of a mesh as they are without modifiers, V x 3."""
    flat = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", flat)
    return flat.reshape(-1, 3)


def match(skin, points, rig, to_world):
    """The vertex of the skin at rest, N x 3, for each point of the mesh, V x 3 in the armature's space; and `rest` for
    Rig.settle(). Raises Refusal where the mesh is another.
    """
    if not len(points):
        raise Refusal("the mesh has no vertices")
    tolerance = 1e-3 * size_of(skin)
    in_order = len(points) == len(skin)
    for rest in _placements(skin, points, rig, to_world):
        back = moved(np.linalg.inv(rest), points)
        if in_order and np.linalg.norm(back - skin, axis=1).max() < tolerance:
            return np.arange(len(skin)), rest
        found, off = nearest(back, skin)
        if off.max() < 0.1 * tolerance:
            return found, rest
    mirrored = similarity(skin, points * [-1, 1, 1]) if in_order else None
    if mirrored is not None and np.abs(moved(mirrored, skin) - points * [-1, 1, 1]).max() < tolerance:
        raise Refusal("the mesh is mirrored against the one that the basis was trained with")
    raise Refusal(f"another mesh: it has {len(points)} vertices, the basis {len(skin)}, and they do not lie on each "
                  "other at rest. Import the character that the basis was trained with, or use Add Skin")


def _placements(skin, points, rig, to_world):
    """Where the basis may stand in the armature: by vertices in order, by bones, or as glTF is imported."""
    by_joints = similarity(rig.bind[:, :3, 3], rig.heads)
    if len(points) == len(skin):
        yield similarity(skin, points)
    if by_joints is not None:
        yield by_joints
    yield np.linalg.inv(to_world) @ Z_UP


def refuse_parting(found, rest_skin, posed_skin):
    """Raises Refusal where a matched vertex, `found`, lies at rest on another that a pose moves elsewhere."""
    tolerance = 1e-5 * size_of(rest_skin)
    _, places = np.unique(np.round(rest_skin / tolerance), axis=0, return_inverse=True)
    first = np.full(places.max() + 1, -1)
    first[places[::-1]] = np.arange(len(places))[::-1]
    apart = np.linalg.norm(posed_skin - posed_skin[first[places]], axis=1) > 10 * tolerance
    parting = np.isin(places[found], places[apart])
    if parting.any():
        raise Refusal(f"{parting.sum()} vertices lie at rest on others that part from them, so that nothing tells which is "
                      "which. Import the character's own file with its vertices in order, or use Add Skin")


def require_unchanged(skin, points, found):
    """Raises Refusal where a bound mesh, V x 3, is no longer the skin at rest, N x 3, at its matched vertices."""
    fits = len(found) == len(points) and found.min(initial=0) >= 0 and found.max(initial=0) < len(skin)
    laid = similarity(skin[found], points) if fits else None
    if laid is not None:
        off = np.linalg.norm(moved(laid, skin[found]) - points, axis=1)
        if off.max() < 1e-3 * size_of(points):
            return
    raise Refusal("the mesh was changed since it was bound: its vertices no longer lie where the basis has them at "
                  "rest. Undo the change, or bind again")
