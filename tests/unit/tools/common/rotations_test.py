"""Rotations: conversions are inverse to each other and follow the configuration's conventions."""

import os
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(os.environ["PALPATE_SOURCE_DIR"], "tools/common")))

import numpy as np  # noqa: E402

from palpate_common import rotations  # noqa: E402


class Rotations(unittest.TestCase):
    def test_conversions_are_inverse_to_each_other(self):
        for vector in ([0.1, -0.2, 0.3], [3.0, 0.5, 0.1], [0, 0, 1e-10], [0, np.pi - 1e-6, 0]):
            r = rotations.exp_rotation(np.array(vector))
            np.testing.assert_allclose(r @ r.T, np.eye(3), atol=1e-12)
            np.testing.assert_allclose(rotations.log_rotation(r), vector, atol=1e-6)
            np.testing.assert_allclose(rotations.from_wxyz(rotations.to_wxyz(r)), r, atol=1e-12)
            np.testing.assert_allclose(rotations.from_rpy(rotations.to_rpy(r)), r, atol=1e-9)

    def test_roll_pitch_yaw_turn_about_x_then_y_then_z_of_the_base(self):
        r = rotations.from_rpy(np.radians([90, 0, 90]))
        np.testing.assert_allclose(r @ [0, 1, 0], [0, 0, 1], atol=1e-12)
        np.testing.assert_allclose(r @ [1, 0, 0], [0, 1, 0], atol=1e-12)

    def test_the_best_rotation_is_found_also_in_a_plane(self):
        expected = rotations.exp_rotation(np.array([0.3, -1, 0.4]))
        rows = np.random.default_rng(1).normal(size=(20, 3))
        np.testing.assert_allclose(rotations.fit_rotation(rows, rows @ expected.T), expected, atol=1e-6)
        rows[:, 2] = 0
        np.testing.assert_allclose(rotations.fit_rotation(rows, rows @ expected.T, expected), expected, atol=1e-6)


if __name__ == "__main__":
    unittest.main()
