"""The Python module: the frames of the C interface, arrays where they are, and what it refuses.

    module_test.py BASIS DYNAMICS EXPECTED   (frames of the bind pose and of what turning_poses in c_api.h gives, float32)
"""
import os
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

    def test_describe_the_character(self):
        self.assertEqual(MODEL.triangles.max(), MODEL.vertex_count - 1)
        self.assertEqual(MODEL.joint_parents[0], -1)
        self.assertTrue(MODEL.has_dynamics)
        self.assertGreater(MODEL.frames_per_second, 0)

    def test_are_the_same_from_several_threads(self):
        found = [None] * 4

        def evaluate(k):
            found[k] = self.instance.evaluate(JOINTS).positions

        threads = [threading.Thread(target=evaluate, args=(k,)) for k in range(len(found))]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for positions in found:
            np.testing.assert_array_equal(positions, SKIN)

    def test_jiggle_goes_on_from_a_state(self):
        instance = MODEL.instance(jiggles=True)
        whole = instance.jiggle(JOINTS, range(len(JOINTS))).positions
        instance.set_state(None)
        instance.jiggle(JOINTS[:2], [0, 1])
        with tempfile.TemporaryDirectory() as folder:
            instance.save_state(instance.state(), folder + "/a.state")
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
        self.refuses(TypeError, "controls", lambda: evaluate(JOINTS, np.zeros((len(JOINTS), 1))))
        self.refuses(bodyopt.Error, "joints, the basis has", lambda: evaluate(JOINTS[:, :1]), 3)
        self.refuses(bodyopt.Error, "controls, the basis has", lambda: evaluate(JOINTS, np.zeros((len(JOINTS), 9), np.float32)), 3)
        self.refuses(bodyopt.Error, "finite", lambda: evaluate(nan), 3)
        self.refuses(bodyopt.Error, "without dynamics", lambda: instance.jiggle(JOINTS, range(len(JOINTS))), 64)
        self.refuses(ValueError, "frame_numbers", lambda: instance.jiggle(JOINTS, [1]))
        self.refuses(bodyopt.Error, "does not jiggle", instance.state, 64)
        np.testing.assert_array_equal(evaluate(JOINTS).positions, SKIN)

    def test_files_and_devices(self):
        self.refuses(bodyopt.Error, "/no/such.safetensors", lambda: bodyopt.load("/no/such.safetensors"), 4)
        self.refuses(bodyopt.Error, "'9999'", lambda: bodyopt.open_device("9999"), 5)
        self.refuses(bodyopt.Error, "without dynamics", lambda: bodyopt.load(BASIS).instance(jiggles=True), 64)

    def test_pipelines_are_kept_where_told(self):
        with tempfile.TemporaryDirectory() as folder:
            device = bodyopt.open_device(pipeline_cache=folder)
            MODEL.instance(device)
            del device
            self.assertEqual([name[:10] for name in os.listdir(folder)], ["pipelines-"])


if __name__ == "__main__":
    unittest.main(argv=["module_test.py"])
