"""Spaces of Blender (Z up, any unit) and of a basis (Y up, metres), and how a rig stands in one and the other."""
import bpy
import numpy as np
from mathutils.kdtree import KDTree

Z_UP = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]], float)  # of what is Y up, 4 x 4


class Refusal(Exception):
    """What cannot be shown rightly: a sentence for the panel, which says what to do."""


def file_of(path, library=None):
    """What a path of the panel names, in this file or a library. Raises Refusal for one beside a .blend file that has no
    place yet."""
    if path.startswith("//") and not library and not bpy.data.filepath:
        raise Refusal(f"'{path}' lies beside the .blend file, which was never saved: save it, or choose a folder")
    return bpy.path.abspath(path, library=library)


def named(names, at_most=4):
    """Some names in a sentence, with a count of the others."""
    shown = ", ".join(f"'{name}'" for name in names[:at_most])
    return shown if len(names) <= at_most else f"{shown} and {len(names) - at_most} more"


def moved(matrix, points):
    """Points, N x 3, by a matrix, 4 x 4."""
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def size_of(points):
    """The diagonal of the bounding box of N x 3 points."""
    return float(np.linalg.norm(np.ptp(points, axis=0)))


def similarity(source, target):
    """The rotation, scale and translation, 4 x 4, that lays N x 3 points on others best (Umeyama 1991).

    None where the points lie on a line, which leaves the rotation open.
    """
    middle, aim = source.mean(axis=0), target.mean(axis=0)
    a, b = source - middle, target - aim
    u, singular, v = np.linalg.svd(b.T @ a)
    if len(source) < 3 or singular[1] < 1e-4 * singular[0] or singular[0] == 0:
        return None
    signs = np.array([1, 1, np.sign(np.linalg.det(u @ v))])
    scale = (singular * signs).sum() / (a * a).sum()
    matrix = np.eye(4)
    matrix[:3, :3] = scale * (u * signs) @ v
    matrix[:3, 3] = aim - matrix[:3, :3] @ middle
    return matrix


def scale_of(matrix):
    """The scale of an armature's matrix, 4 x 4. Raises Refusal where that mirrors or stretches."""
    linear = matrix[:3, :3]
    scale = np.cbrt(np.linalg.det(linear))
    if scale < 0:
        raise Refusal("the armature is mirrored (a negative scale): apply its scale with Object > Apply > Scale")
    if scale < 1e-9 or np.abs(linear.T @ linear - scale**2 * np.eye(3)).max() > 2e-4 * scale**2:
        raise Refusal("the armature is scaled differently along its axes: apply its scale with Object > Apply > Scale")
    return scale


def compose(numbers):
    """Matrices, J x 4 x 4, of J x 10 translations, rotations x y z w and scales."""
    x, y, z, w = numbers[:, 3:7].T
    rotations = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                          [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                          [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]).transpose(2, 0, 1)
    matrices = np.tile(np.eye(4), (len(numbers), 1, 1))
    matrices[:, :3, :3] = rotations * numbers[:, None, 7:]
    matrices[:, :3, 3] = numbers[:, :3]
    return matrices


def decompose(matrices):
    """The opposite of compose(), and how far each matrix is from having one (the cosine between its axes), J."""
    linear = matrices[:, :3, :3]
    scales = np.linalg.norm(linear, axis=1)
    m = linear / np.maximum(scales, 1e-12)[:, None, :]
    shear = np.abs(m.transpose(0, 2, 1) @ m - np.eye(3)).max(axis=(1, 2))
    # Each row is the quaternion x y z w, times four of its numbers: the largest of these divides without loss.
    rows = np.empty((len(m), 4, 4))
    trace = np.trace(m, axis1=1, axis2=2)
    for i, (j, k) in enumerate(((1, 2), (2, 0), (0, 1))):
        rows[:, i, i] = 1 - trace + 2 * m[:, i, i]
        rows[:, i, j] = rows[:, j, i] = m[:, i, j] + m[:, j, i]
        rows[:, i, 3] = rows[:, 3, i] = m[:, k, j] - m[:, j, k]
    rows[:, 3, 3] = 1 + trace
    best = rows[np.arange(len(m)), np.argmax(np.einsum("jii->ji", rows), axis=1)]
    numbers = np.empty((len(m), 10))
    numbers[:, :3] = matrices[:, :3, 3]
    numbers[:, 3:7] = best / np.linalg.norm(best, axis=1)[:, None]
    numbers[:, 7:] = scales
    return numbers, shear


def nearest(points, targets):
    """Of each of N x 3 points the nearest target, N, and its distance, N."""
    tree = KDTree(len(targets))
    for index, target in enumerate(targets):
        tree.insert(target, index)
    tree.balance()
    found = [tree.find(point) for point in points]
    return np.array([hit[1] for hit in found]), np.array([hit[2] for hit in found])
