"""Derivatives, symmetries, information and proposals of tools/register."""
import os
import pathlib
import sys
import unittest

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
TOOLS = pathlib.Path(os.environ["PALPATE_SOURCE_DIR"], "tools")
sys.path[:0] = [str(TOOLS / "register"), str(TOOLS / "common")]

import numpy as np  # noqa: E402

from palpate_common.pose import Pose  # noqa: E402
from palpate_common.rotations import exp_rotation  # noqa: E402
from palpate_common.surface import Surface, box_surface  # noqa: E402
from palpate_register.information import cramer_rao  # noqa: E402
from palpate_register.next_touch import Reach, next_touches  # noqa: E402
from palpate_register.observations import Cloud, Guess, Observations, Touches  # noqa: E402
from palpate_register.residuals import residuals, start_at  # noqa: E402
from palpate_register.symmetry import find_symmetries  # noqa: E402

BAR, CUBE = box_surface([0.5, 0.06, 0.06]), box_surface([0.06, 0.06, 0.06])


def prism(corners, length):
    """Along z, over the polygon `corners`, (n, 2), counter-clockwise and star-shaped about its first corner."""
    n = len(corners)
    bottom, top = np.column_stack([corners, np.zeros(n)]), np.column_stack([corners, np.full(n, length)])
    sides = [t for i in range(n) for t in ((i, (i + 1) % n, n + (i + 1) % n), (i, n + (i + 1) % n, n + i))]
    caps = [t for i in range(1, n - 1) for t in ((0, i + 1, i), (n, n + i, n + i + 1))]
    return Surface(np.vstack([bottom, top]), np.array(sides + caps))


def cylinder(radius, length, count=48):
    angle = 2 * np.pi * np.arange(count) / count
    return prism(radius * np.column_stack([np.cos(angle), np.sin(angle)]), length)


class Derivatives(unittest.TestCase):
    def test_are_those_of_differences(self):
        random = np.random.default_rng(6)
        pose = Pose(exp_rotation([0.3, -0.2, 0.4]), np.array([0.5, 0.1, 0.2]))
        on, of = BAR.samples(14, seed=7)
        touches = Touches(pose.of(on + 2e-3 * random.normal(size=on.shape)), (BAR.normals[of] @ pose.R.T)[::1].copy(),
                          np.full(14, 1e-3), radius=0.004)  # fmt: skip
        touches.normals[::3] = 0
        cloud = Cloud(pose.of(BAR.samples(25, seed=8)[0] + 2e-3))
        observed = Observations(touches, cloud, Guess(Pose(np.eye(3), pose.p + 0.01)))
        state = start_at(pose).stepped(np.array([0] * 6 + [4e-3, -3e-3, 2e-3, 0.02, 0.01, -0.03]), BAR.center)
        J = residuals(BAR, state, observed).J
        priors = 12  # their rotations are exact at the origin only
        h = 1e-6
        for i in range(12):
            step = np.zeros(12)
            step[i] = h
            up = residuals(BAR, state.stepped(step, BAR.center), observed).r
            down = residuals(BAR, state.stepped(-step, BAR.center), observed).r
            np.testing.assert_allclose(J[:-priors, i], ((up - down) / (2 * h))[:-priors], atol=2e-3 * np.abs(J).max())


class Symmetry(unittest.TestCase):
    def test_boxes(self):
        for surface, count, words in ((CUBE, 24, "a quarter turn about"), (BAR, 8, "a quarter turn about its long axis (x)"),
                                      (box_surface([0.3, 0.2, 0.1]), 4, "half a turn about")):  # fmt: skip
            found = find_symmetries(surface)
            self.assertEqual(len(found.rotations), count)
            self.assertIn(words, found.text)
            pose = Pose(exp_rotation([0.1, 0.2, 0.3]), np.array([1.0, 2.0, 3.0]))
            points = surface.samples(50, seed=9)[0]
            for alike in found.equivalents(pose):
                away = surface.closest(alike.inverse_of(pose.of(points)))[0] - alike.inverse_of(pose.of(points))
                self.assertLess(np.abs(away).max(), 1e-9)

    def test_a_cylinder_turns_freely(self):
        found = find_symmetries(cylinder(0.03, 0.2))
        self.assertIn("any turn about its long axis (z)", found.text)
        np.testing.assert_allclose(np.abs(found.free_axis()), [0, 0, 1], atol=1e-3)

    def test_an_uneven_solid_has_none(self):
        found = find_symmetries(prism(np.array([[0, 0], [0.1, 0], [0.08, 0.03], [0.01, 0.05]]), 0.07))
        turned = [R for R in found.rotations if abs(R[2, 2] - 1) > 1e-6]
        self.assertEqual(len(found.rotations) - len(turned), 1)  # a prism is the same upside down at most
        self.assertEqual(len(found.rotations), 1, found.text)


class Information(unittest.TestCase):
    def test_the_bound_of_touches_on_one_face_each(self):
        pose = Pose(np.eye(3), np.zeros(3))
        points = np.array([[0.06, 0.03, 0.03], [0.03, 0.06, 0.03], [0.03, 0.03, 0.06]])
        touches = Touches(points, np.zeros((3, 3)), np.full(3, 2e-4), common_deviation=1e-3)
        bound = cramer_rao(CUBE, pose, touches, points, np.eye(3))
        np.testing.assert_allclose(np.diag(bound)[:3], 2e-4**2 + 1e-3**2, rtol=1e-3)

    def test_the_next_touch_is_where_least_is_known(self):
        pose = Pose(np.eye(3), np.array([0.5, 0, 0.2]))
        covariance = np.diag([0.01, 2e-4, 2e-4, 1e-3, 1e-3, 1e-3]) ** 2
        best = next_touches(BAR, pose, covariance, 3e-4, np.inf, Reach(table=0.1))[0]
        self.assertGreater(abs(best.approach[0]), 0.99)  # along the bar, whose place there is unknown
        self.assertGreater(best.gain, 2)

    def test_no_touch_from_below_nor_in_the_clamp(self):
        pose = Pose(np.eye(3), np.array([0.5, 0, 0.2]))
        hidden = [(np.zeros(3), np.array([0.1, 0.06, 0.06]))]
        covariance = np.diag([0.01, 0.01, 0.01, 0.1, 0.1, 0.1]) ** 2
        found = next_touches(BAR, pose, covariance, 3e-4, np.inf, Reach(0.1, hidden=hidden), count=200)
        self.assertGreater(len(found), 4)
        for touch in found:
            self.assertLessEqual(touch.approach[2], 0.5)
            self.assertGreater(touch.point[0], 0.6)


if __name__ == "__main__":
    unittest.main(verbosity=2)
