"""Poses, their differences and covariances, and directions that a covariance leaves open."""

import os
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(os.environ["PALPATE_SOURCE_DIR"], "tools/common")))

import numpy as np  # noqa: E402

from palpate_common.pose import Pose, angle_of, covariance_at, difference, moved, random_rotations  # noqa: E402
from palpate_common.rotations import exp_rotation, from_wxyz, log_rotation, perpendiculars, to_wxyz  # noqa: E402
from palpate_common.undetermined import undetermined_directions  # noqa: E402


class Poses(unittest.TestCase):
    def test_notations_agree(self):
        for R in random_rotations(np.random.default_rng(3), 50):
            np.testing.assert_allclose(from_wxyz(to_wxyz(R)), R, atol=1e-12)
            np.testing.assert_allclose(exp_rotation(log_rotation(R)), R, atol=1e-9)
            self.assertAlmostEqual(angle_of(R), np.linalg.norm(log_rotation(R)), places=7)

    def test_a_step_is_the_difference_it_makes(self):
        random, about = np.random.default_rng(4), np.array([0.2, 0.1, -0.3])
        pose = Pose(random_rotations(random, 1)[0], random.normal(size=3))
        step = 0.1 * random.normal(size=6)
        np.testing.assert_allclose(difference(moved(pose, step, about), pose, about), step, atol=1e-9)

    def test_covariance_of_another_point(self):
        random = np.random.default_rng(5)
        A = random.normal(size=(6, 6))
        offset, steps = np.array([0.3, -0.2, 0.1]), 1e-4 * random.normal(size=(40000, 6)) @ A.T
        there = steps[:, :3] + np.cross(steps[:, 3:], offset)
        drawn = np.cov(np.hstack([there, steps[:, 3:]]).T)
        np.testing.assert_allclose(covariance_at(1e-8 * A @ A.T, offset), drawn, atol=3e-2 * np.abs(drawn).max())

    def test_the_inverse_undoes_a_pose(self):
        random = np.random.default_rng(6)
        a, b = (Pose(R, random.normal(size=3)) for R in random_rotations(random, 2))
        points = random.normal(size=(5, 3))
        np.testing.assert_allclose(a.times(b).of(points), a.of(b.of(points)), atol=1e-12)
        np.testing.assert_allclose(a.inverse().of(points), a.inverse_of(points), atol=1e-12)

    def test_perpendiculars_are_unit_vectors_at_right_angles(self):
        directions = random_rotations(np.random.default_rng(7), 40)[:, 0]
        axes = np.concatenate([directions[:, None], perpendiculars(directions)], axis=1)
        np.testing.assert_allclose(axes @ axes.transpose(0, 2, 1), np.tile(np.eye(3), (40, 1, 1)), atol=1e-12)


class Undetermined(unittest.TestCase):
    def test_directions_with_large_deviations_are_named(self):
        R = exp_rotation([0, 0, np.pi / 4])
        covariance = np.zeros((6, 6))
        covariance[:3, :3] = R @ np.diag([0.03, 0.001, 0.001]) ** 2 @ R.T
        covariance[3:, 3:] = np.diag([0.01, 0.01, 0.3]) ** 2
        self.assertEqual(undetermined_directions(covariance),
                         ["position along (0.71 0.71 0.00)", "rotation about (0.00 0.00 1.00)"])
        self.assertEqual(undetermined_directions(1e-6 * np.eye(6)), [])


if __name__ == "__main__":
    unittest.main(verbosity=2)
