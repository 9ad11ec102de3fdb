"""The Python module: the frames of the C interface, arrays where they are, and what it refuses.

    module_test.py BASIS DYNAMICS POSES EXPECTED   (frames of the bind pose and of what turning_poses in c_api.h gives, float32)
"""
import os
import pathlib
import sys
import tempfile
import threading
import unittest

import bodyopt
import numpy as np

BASIS, DYNAMICS, POSES, EXPECTED = sys.argv[1:]
MODEL = bodyopt.load(BASIS, DYNAMICS)
JOINTS = np.fromfile(POSES, np.float64).reshape(-1, len(MODEL.joint_names), 10)
SKIN = np.fromfile(EXPECTED, np.float32).reshape(len(JOINTS), MODEL.vertex_count, 3)


def in_threads(task, count):
    """Runs task(0) to task(count - 1) at once, and waits for all."""
    threads = [threading.Thread(target=task, args=(k,)) for k in range(count)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()


def skinning_matrices(joints):
    """Frames x joints x 3 x 4, rest space to world."""

    def world(pose):
        matrices = []
        for (*t, x, y, z, w, i, j, k), parent in zip(pose, MODEL.joint_parents):
            own = np.eye(4)
            own[:3, :3] = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                                    [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                                    [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]) * [i, j, k]
            own[:3, 3] = t
            matrices.append(matrices[parent] @ own if parent >= 0 else own)
        return np.array(matrices)

    to_joint = np.linalg.inv(world(MODEL.bind_pose))
    return np.array([world(pose) @ to_joint for pose in joints])[:, :, :3].astype(np.float32)


class Frames(unittest.TestCase):
    def setUp(self):
        self.instance = MODEL.instance()

    def test_are_those_of_the_library(self):
        skin = self.instance.evaluate(JOINTS)
        np.testing.assert_array_equal(skin.positions, SKIN)
        np.testing.assert_allclose(np.linalg.norm(skin.normals, axis=2), 1, atol=1e-5)
        self.assertEqual(skin.strains.shape, (len(JOINTS), len(MODEL.strain_names)))
        self.assertEqual(skin.outside.shape, (len(JOINTS),))
        self.assertTrue(MODEL.knows_error)
        self.assertEqual(skin.expected_errors.shape, (len(JOINTS),))
        self.assertTrue((skin.expected_errors > 0).all())
        self.assertTrue(((0 <= skin.fades) & (skin.fades <= 1)).all())

    def test_are_read_and_written_where_they_are(self):
        wide = np.full((2 * len(JOINTS), JOINTS.shape[1], 12), np.nan)
        wide[::2, :, :10] = JOINTS
        buffer = np.full((len(JOINTS), MODEL.vertex_count, 8), -7, np.float32)
        skin = self.instance.evaluate(wide[::2, :, :10], positions=buffer[:, :, :3], normals=buffer[:, :, 3:6])
        np.testing.assert_array_equal(buffer[:, :, :3], SKIN)
        self.assertTrue(np.shares_memory(skin.positions, buffer))
        self.assertTrue((buffer[:, :, 6:] == -7).all())

    def test_are_those_of_skinning_matrices(self):
        np.testing.assert_allclose(self.instance.evaluate(skinning_matrices(JOINTS)).positions, SKIN, atol=2e-6)
        wide = np.zeros((*JOINTS.shape[:2], 3, 8), np.float32)
        with self.assertRaisesRegex(TypeError, "joints: its numbers overlap|do not stand one after the other"):
            self.instance.evaluate(wide[:, :, :, :4])

    def test_have_what_is_attached(self):
        path = BASIS.replace(".safetensors", ".attached.safetensors")
        model = bodyopt.load(BASIS, DYNAMICS, attached=path)
        skin = model.instance().evaluate(JOINTS)
        np.testing.assert_array_equal(skin.positions, SKIN)
        for (name, triangles), points in zip(model.attached, skin.attached, strict=True):
            self.assertEqual(points.shape, (len(JOINTS), triangles.max() + 1, 3), name)
            self.assertLess(np.linalg.norm(points[0].mean(axis=0) - SKIN[0].mean(axis=0)), 1)
            self.assertTrue((points[-1] != points[0]).any())
        self.assertIsNone(model.instance().evaluate(JOINTS, attached=False).attached)
        call = bodyopt.Call(model.instance(), JOINTS)
        bodyopt.evaluate_together([call])
        np.testing.assert_array_equal(call.skin.attached[0], skin.attached[0])
        self.assertIsNone(self.instance.evaluate(JOINTS).attached)
        read = [pathlib.Path(file).read_bytes() for file in (BASIS, path)]
        again = bodyopt.load_from_memory(read[0], attached=read[1]).instance().evaluate(JOINTS)
        np.testing.assert_array_equal(again.attached[0], skin.attached[0])
        with self.assertRaisesRegex(bodyopt.Error, "carries no full skin"):
            self.instance.evaluate(JOINTS, full_positions=True)

    def test_have_tangents_where_the_texture_is_known(self):
        self.assertIsNone(self.instance.evaluate(JOINTS).tangents)
        wide = np.random.default_rng(1).random((MODEL.vertex_count, 5), np.float32)
        model = bodyopt.load(BASIS, DYNAMICS, texture=wide[:, 1:3])
        self.assertTrue(model.has_tangents and not MODEL.has_tangents)
        buffer = np.full((len(JOINTS), MODEL.vertex_count, 6), -7, np.float32)
        instance = model.instance()
        skin = instance.evaluate(JOINTS, tangents=buffer[:, :, :4])
        np.testing.assert_array_equal(instance.evaluate(JOINTS).tangents, buffer[:, :, :4])
        np.testing.assert_allclose(np.linalg.norm(skin.tangents[:, :, :3], axis=2), 1, atol=1e-5)
        np.testing.assert_allclose((skin.tangents[:, :, :3] * skin.normals).sum(axis=2), 0, atol=1e-5)
        np.testing.assert_array_equal(np.abs(skin.tangents[:, :, 3]), 1)
        self.assertTrue((buffer[:, :, 4:] == -7).all())
        call = bodyopt.Call(instance, JOINTS)
        bodyopt.evaluate_together([call])
        np.testing.assert_array_equal(call.skin.tangents, skin.tangents)

    def test_have_no_normals_and_tangents_where_these_are_not_wanted(self):
        model = bodyopt.load(BASIS, texture=np.random.default_rng(1).random((MODEL.vertex_count, 2), np.float32))
        instance = model.instance()
        whole = instance.evaluate(JOINTS, normals=True, tangents=True)
        for array in (whole.normals, whole.tangents):
            self.assertIsNotNone(array)
        skin = instance.evaluate(JOINTS, normals=False, tangents=False)
        np.testing.assert_array_equal(skin.positions, SKIN)
        self.assertIsNone(skin.normals)
        self.assertIsNone(skin.tangents)
        skin = instance.evaluate(JOINTS, normals=False)
        self.assertIsNone(skin.normals)
        np.testing.assert_array_equal(skin.tangents, whole.tangents)
        skin = instance.evaluate(JOINTS, normals=None, tangents=False)
        np.testing.assert_array_equal(skin.normals, whole.normals)
        self.assertIsNone(MODEL.instance(jiggles=True).jiggle(JOINTS, range(len(JOINTS)), normals=False).normals)
        call = bodyopt.Call(instance, JOINTS, normals=False, tangents=False)
        bodyopt.evaluate_together([call])
        self.assertIsNone(call.skin.normals)
        self.assertIsNone(call.skin.tangents)

    def test_tell_the_error_of_vertices_and_what_lies_outside(self):
        self.assertIsNone(self.instance.evaluate(JOINTS).vertex_errors)
        skin = self.instance.evaluate(JOINTS, vertex_errors=True)
        self.assertEqual(skin.vertex_errors.shape, SKIN.shape[:2])
        self.assertGreater(skin.vertex_errors.max(), 0)
        self.assertTrue((0 <= skin.vertex_errors).all())
        np.testing.assert_array_equal(skin.outside_features < 0, skin.outside == 0)
        self.assertEqual(skin.excess.shape, (len(JOINTS), len(MODEL.feature_names)))
        np.testing.assert_array_equal(skin.excess.max(axis=1), skin.outside)
        self.assertIn("joint " + MODEL.joint_names[1], MODEL.feature_names)

    def test_with_modifiers_of_a_character_without_any_are_the_same(self):
        self.assertEqual(MODEL.channels, [])
        none = np.zeros((len(JOINTS), 0), np.float32)
        skin = self.instance.evaluate(JOINTS, frames_per_second=24, channels=none)
        np.testing.assert_array_equal(skin.positions, SKIN)
        self.instance.skip(JOINTS, 24)
        with self.assertRaises(bodyopt.Error) as refused:
            self.instance.skip(JOINTS, 0)
        self.assertEqual(refused.exception.code, 64)
        with self.assertRaises(bodyopt.Error) as refused:
            self.instance.evaluate(JOINTS, frames_per_second=24, channels=np.ones((len(JOINTS), 2), np.float32))
        self.assertEqual(refused.exception.code, 3)

    def test_of_a_character_without_controls_take_none(self):
        self.assertEqual(MODEL.control_names, [])
        skin = self.instance.evaluate(JOINTS, np.zeros((len(JOINTS), 0), np.float32))
        np.testing.assert_array_equal(skin.positions, SKIN)

    def test_are_checked_on_a_device(self):
        skin = MODEL.instance(bodyopt.open_device(), check=True).evaluate(JOINTS)
        np.testing.assert_allclose(skin.positions, SKIN, atol=1e-5)

    def test_are_of_files_that_any_path_names(self):
        basis, dynamics = pathlib.Path(BASIS), pathlib.Path(DYNAMICS)
        for model in (bodyopt.load(basis, dynamics), bodyopt.load(os.fsencode(BASIS), os.fsencode(DYNAMICS))):
            np.testing.assert_array_equal(model.instance().evaluate(JOINTS).positions, SKIN)
            self.assertTrue(model.has_dynamics)

    def test_are_of_bytes_in_memory(self):
        basis, dynamics = pathlib.Path(BASIS).read_bytes(), pathlib.Path(DYNAMICS).read_bytes()
        model = bodyopt.load_from_memory(basis, dynamics)
        np.testing.assert_array_equal(model.instance().evaluate(JOINTS).positions, SKIN)
        self.assertTrue(model.has_dynamics)
        with self.assertRaises(bodyopt.Error) as refused:
            bodyopt.load_from_memory(basis[:-1])
        self.assertEqual(refused.exception.code, 4)

    def test_run_on_devices_that_are_listed(self):
        names = bodyopt.device_names()
        self.assertIn(bodyopt.open_device().name, names)

    def test_describe_the_character(self):
        self.assertEqual(MODEL.triangles.max(), MODEL.vertex_count - 1)
        self.assertEqual(MODEL.joint_parents[0], -1)
        self.assertTrue(MODEL.has_dynamics)
        self.assertGreater(MODEL.frames_per_second, 0)

    def test_are_the_same_from_several_threads(self):
        found = [None] * 4

        def evaluate(k):
            found[k] = self.instance.evaluate(JOINTS).positions

        in_threads(evaluate, len(found))
        for positions in found:
            np.testing.assert_array_equal(positions, SKIN)

    def test_are_the_same_together(self):
        device = bodyopt.open_device()
        buffer = np.full((len(JOINTS), MODEL.vertex_count, 4), -7, np.float32)
        numbers = range(len(JOINTS))
        for on in (None, device):
            expected = MODEL.instance(on).evaluate(JOINTS)
            jiggled = MODEL.instance(on, jiggles=True).jiggle(JOINTS, numbers)
            calls = [
                bodyopt.Call(MODEL.instance(on), JOINTS),
                bodyopt.Call(MODEL.instance(on), JOINTS[1:], positions=buffer[1:, :, :3]),
                bodyopt.Call(MODEL.instance(on, jiggles=True), JOINTS, frame_numbers=numbers),
            ]
            self.assertIsNone(calls[0].skin)
            bodyopt.evaluate_together(calls)
            np.testing.assert_array_equal(calls[0].skin.positions, expected.positions)
            np.testing.assert_array_equal(calls[0].skin.normals, expected.normals)
            np.testing.assert_array_equal(calls[0].skin.expected_errors, expected.expected_errors)
            np.testing.assert_array_equal(buffer[1:, :, :3], expected.positions[1:])
            np.testing.assert_array_equal(calls[2].skin.positions, jiggled.positions)
            self.assertTrue((buffer[0] == -7).all() and (buffer[:, :, 3] == -7).all())
        bodyopt.evaluate_together([])

    def test_are_the_same_together_from_several_threads(self):
        instances = [MODEL.instance() for _ in range(3)]
        found = [None] * 4

        def evaluate(k):
            order = instances if k % 2 else instances[::-1]
            for _ in range(20):
                calls = [bodyopt.Call(instance, JOINTS) for instance in order]
                bodyopt.evaluate_together(calls)
            found[k] = [call.skin.positions for call in calls]

        in_threads(evaluate, len(found))
        for positions in found:
            for skin in positions:
                np.testing.assert_array_equal(skin, SKIN)

    def test_jiggle_goes_on_from_a_state(self):
        instance = MODEL.instance(jiggles=True)
        whole = instance.jiggle(JOINTS, range(len(JOINTS))).positions
        instance.set_state(None)
        instance.jiggle(JOINTS[:2], [0, 1])
        with tempfile.TemporaryDirectory() as folder:
            instance.save_state(instance.state(), pathlib.Path(folder) / "a.state")
            instance.jiggle(JOINTS[2:], range(2, len(JOINTS)))
            instance.set_state(instance.load_state(folder + "/a.state"))
        rest = instance.jiggle(JOINTS[2:], range(2, len(JOINTS))).positions
        np.testing.assert_array_equal(rest, whole[2:])
        self.assertFalse(np.array_equal(whole, SKIN))

    def test_without_any_are_empty(self):
        self.assertEqual(self.instance.evaluate(JOINTS[:0]).positions.shape, (0, MODEL.vertex_count, 3))


class Refused(unittest.TestCase):
    def refuses(self, kind, said, call, code=None):
        with self.assertRaises(kind) as caught:
            call()
        self.assertIn(said, str(caught.exception))
        if code is not None:
            self.assertEqual(caught.exception.code, code)

    def test_arrays_and_arguments(self):
        instance = MODEL.instance()
        nan = JOINTS.copy()
        nan[1, 1, 0] = np.nan
        unturned = JOINTS.copy()
        unturned[1, 1, 3:7] = 0
        read_only = np.zeros_like(SKIN)
        read_only.flags.writeable = False
        evaluate = instance.evaluate
        self.refuses(TypeError, "float64, found float32", lambda: evaluate(JOINTS.astype(np.float32)))
        self.refuses(TypeError, "found <class 'list'>", lambda: evaluate(JOINTS.tolist()))
        self.refuses(TypeError, "ascontiguousarray(joints)", lambda: evaluate(JOINTS[:, :, ::-1]))
        self.refuses(TypeError, "ascontiguousarray(joints)", lambda: evaluate(JOINTS[::-1]))
        self.refuses(TypeError, "ascontiguousarray(joints)", lambda: evaluate(np.broadcast_to(JOINTS[0], JOINTS.shape)))
        self.refuses(TypeError, "ascontiguousarray(joints)", lambda: evaluate(np.asfortranarray(JOINTS)))
        self.refuses(ValueError, "expected the shape any x any x 10", lambda: evaluate(JOINTS[0]))
        self.refuses(ValueError, "positions: expected the shape", lambda: evaluate(JOINTS, positions=SKIN[:1].copy()))
        self.refuses(TypeError, "positions", lambda: evaluate(JOINTS, positions=SKIN.astype(np.float64)))
        self.refuses(ValueError, "read-only", lambda: evaluate(JOINTS, positions=read_only))
        self.refuses(ValueError, "without texture coordinates", lambda: evaluate(JOINTS, tangents=np.zeros((len(JOINTS), MODEL.vertex_count, 4), np.float32)))
        self.refuses(ValueError, "texture: expected the shape any x 2", lambda: bodyopt.load(BASIS, texture=np.zeros((MODEL.vertex_count, 3), np.float32)))
        for count in (MODEL.vertex_count - 1, MODEL.vertex_count + 1):
            self.refuses(bodyopt.Error, f"of {count} vertices, the model has {MODEL.vertex_count}", lambda: bodyopt.load(BASIS, texture=np.zeros((count, 2), np.float32)), 3)
        self.refuses(TypeError, "controls", lambda: evaluate(JOINTS, np.zeros((len(JOINTS), 1))))
        self.refuses(bodyopt.Error, "joints, the basis has", lambda: evaluate(JOINTS[:, :1]), 3)
        self.refuses(bodyopt.Error, "controls, the basis has", lambda: evaluate(JOINTS, np.zeros((len(JOINTS), 9), np.float32)), 3)
        self.refuses(bodyopt.Error, "finite", lambda: evaluate(nan), 3)
        self.refuses(bodyopt.Error, "has the length 0", lambda: evaluate(unturned), 3)
        self.refuses(bodyopt.Error, "without dynamics", lambda: instance.jiggle(JOINTS, range(len(JOINTS))), 64)
        self.refuses(ValueError, "frame_numbers", lambda: instance.jiggle(JOINTS, [1]))
        self.refuses(bodyopt.Error, "does not jiggle", instance.state, 64)
        np.testing.assert_array_equal(evaluate(JOINTS).positions, SKIN)

    def test_calls_among_others(self):
        nan = JOINTS.copy()
        nan[1, 1, 0] = np.nan
        instance = MODEL.instance()
        calls = [bodyopt.Call(MODEL.instance(), nan), bodyopt.Call(instance, JOINTS)]
        self.refuses(bodyopt.Error, "call 0: ", lambda: bodyopt.evaluate_together(calls), 3)
        self.assertIsNone(calls[0].skin)
        np.testing.assert_array_equal(calls[1].skin.positions, SKIN)
        again = bodyopt.Call(instance, JOINTS)
        self.refuses(bodyopt.Error, "call 1: the instance is in an earlier call", lambda: bodyopt.evaluate_together([calls[1], again]), 64)
        self.assertIsNone(again.skin)
        still = bodyopt.Call(instance, JOINTS, frame_numbers=range(len(JOINTS)))
        self.refuses(bodyopt.Error, "without dynamics", lambda: bodyopt.evaluate_together([still]), 64)
        self.refuses(TypeError, "found None", lambda: bodyopt.evaluate_together([None]))
        self.refuses(TypeError, "", lambda: bodyopt.Call(None, JOINTS))
        self.refuses(ValueError, "frame_numbers", lambda: bodyopt.Call(instance, JOINTS, frame_numbers=[1]))
        self.refuses(TypeError, "float64, found float32", lambda: bodyopt.Call(instance, JOINTS.astype(np.float32)))

    def test_files_and_devices(self):
        self.refuses(bodyopt.Error, "/no/such.safetensors", lambda: bodyopt.load("/no/such.safetensors"), 4)
        for path in (BASIS + "\0.old", pathlib.Path(BASIS + "\0.old")):
            self.refuses(ValueError, "null", lambda: bodyopt.load(path))
            self.refuses(ValueError, "null", lambda: bodyopt.load(BASIS, path))
            self.refuses(ValueError, "null", lambda: bodyopt.open_device(pipeline_cache=path))
        for path in (None, 7, SKIN):
            self.refuses(TypeError, "PathLike", lambda: bodyopt.load(path))
        self.refuses(bodyopt.Error, "of 0 vertices", lambda: bodyopt.load(BASIS, texture=np.zeros((0, 2), np.float32)), 3)
        self.refuses(bodyopt.Error, "'9999'", lambda: bodyopt.open_device("9999"), 5)
        self.refuses(bodyopt.Error, "name a device", lambda: MODEL.instance(check=True), 5)
        self.refuses(bodyopt.Error, "1000 m/s^2", lambda: MODEL.instance(jiggles=True, gravity_change=(0, 1e300, 0)), 64)
        self.refuses(bodyopt.Error, "weight", lambda: MODEL.instance().set_weights(3e38, 1), 64)
        self.refuses(bodyopt.Error, "without dynamics", lambda: bodyopt.load(BASIS).instance(jiggles=True), 64)

    def test_pipelines_are_kept_where_told(self):
        with tempfile.TemporaryDirectory() as folder:
            device = bodyopt.open_device(pipeline_cache=folder)
            MODEL.instance(device)
            del device
            self.assertEqual([name[:10] for name in os.listdir(folder)], ["pipelines-"])


if __name__ == "__main__":
    unittest.main(argv=["module_test.py"])
