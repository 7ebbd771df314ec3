"""The plane on which the object stands: found next to it, and not where it is not seen."""
import unittest

import support  # noqa: F401

import numpy as np

from palpate_common.pose import Pose
from palpate_common.rotations import exp_rotation, from_rpy
from palpate_see.camera_error import CameraError
from palpate_see.noise import NoiseModel
from palpate_see.obstacles import Obstacle
from palpate_see.point_error import PointError
from palpate_see.shapes import HalfSpace
from palpate_see.support_plane import fitted_plane

X_WC = Pose(from_rpy(np.radians([-130, 0, 0])), np.array([1.1, -0.7, 0.9]))  # looks down at the table
TABLE = Pose(exp_rotation(np.array([0, 0, 0.5])), np.array([0, 0, 0.3]))  # as configured
ERROR = PointError(NoiseModel(0.002, 0), CameraError(0.006, np.radians(0.3)))


def fitted(points_C, position=0.001, rotation=0.0):
    """Pose that is found of a table whose configured pose has these deviations, m and rad."""
    return fitted_plane(Obstacle("table", HalfSpace(), TABLE, None, False, position, rotation), TABLE, points_C, X_WC, ERROR)


def on_table(random, count, height=0.3, tilt=0.0):
    """(count, 3), m, in W: without noise, tilted about the axis x below the camera."""
    places = np.array([1.1, 0.0]) + random.uniform(-0.3, 0.3, (count, 2))
    return np.column_stack([places, height + tilt * (places[:, 1] - X_WC.p[1])])


def seen(random, points_W):
    """(n, 3), m, in C, with noise along the rays."""
    points = X_WC.inverse_of(points_W)
    return points * (1 + 0.002 * random.normal(size=len(points)) / points[:, 2])[:, None]


def side_of_a_bar(random, count):
    """(count, 3), m, in W: upright, from the table upwards."""
    return np.column_stack([random.uniform(0.9, 1.3, count), np.full(count, -0.03), random.uniform(0.3, 0.36, count)])


class SupportPlane(unittest.TestCase):
    def heights(self, found, points_W):
        return found.inverse_of(points_W)[:, 2]

    def test_height_and_tilt_are_found_next_to_an_object(self):
        random = np.random.default_rng(1)
        for shift, tilt in ((0.0, 0.0), (0.006, 0.0), (-0.006, 0.002), (0.002, -0.003)):
            true = on_table(random, 20_000, 0.3 + shift, tilt)
            bar = side_of_a_bar(random, 8000)
            found = fitted(seen(random, np.vstack([true, bar])))
            self.assertLess(np.abs(self.heights(found, true)).max(), 4e-4, (shift, tilt))

    def test_a_table_that_is_hardly_known_is_found(self):
        random = np.random.default_rng(5)
        for shift, tilt in ((0.02, 0.0), (-0.025, 0.02), (0.01, -0.02)):
            true = on_table(random, 20_000, 0.3 + shift, tilt)
            bar = side_of_a_bar(random, 4000) + [0, 0, shift]
            found = fitted(seen(random, np.vstack([true, bar])), 0.01, np.radians(1))
            self.assertLess(np.abs(self.heights(found, true)).max(), 4e-4, (shift, tilt))

    def test_few_points_leave_the_tilt_to_the_prior(self):
        random = np.random.default_rng(2)
        corner = on_table(random, 20_000, 0.303)
        corner = corner[np.linalg.norm(corner[:, :2] - [0.9, 0.2], axis=1) < 0.05][:300]
        found = fitted(seen(random, corner))
        self.assertLess(np.abs(self.heights(found, corner)).mean(), 5e-4)
        self.assertLess(np.abs(self.heights(found, on_table(random, 1000, 0.303))).max(), 4e-3)

    def test_a_plane_that_is_not_seen_is_not_found(self):
        random = np.random.default_rng(3)
        self.assertIsNone(fitted(np.zeros((0, 3))))
        self.assertIsNone(fitted(seen(random, on_table(random, 190))))
        self.assertIsNone(fitted(seen(random, on_table(random, 5000, 0.4))))

    def test_below_a_sheet_that_covers_most_of_it_the_table_is_found(self):
        random = np.random.default_rng(4)
        table = on_table(random, 1000, 0.298)
        both = np.vstack([on_table(random, 9000, 0.312), table])
        found = fitted(seen(random, both))
        self.assertLess(np.abs(self.heights(found, table)).max(), 1e-3)


if __name__ == "__main__":
    unittest.main(verbosity=2)
