"""Poses from touches and clouds, gross errors, other sizes and other objects, by tools/register."""
import functools
import os
import pathlib
import sys
import unittest

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
TOOLS = pathlib.Path(os.environ["PALPATE_SOURCE_DIR"], "tools")
sys.path[:0] = [str(TOOLS / folder) for folder in ("register", "common", "lab/register")]

import numpy as np  # noqa: E402

from palpate_common import robust  # noqa: E402
from palpate_common.pose import Pose, difference, random_rotations  # noqa: E402
from palpate_common.rotations import exp_rotation  # noqa: E402
from palpate_common.surface import Surface, box_surface  # noqa: E402
from palpate_register import register as registering  # noqa: E402
from palpate_register.observations import Cloud, Guess, Observations, Touches  # noqa: E402
from palpate_register.refine import refine  # noqa: E402
from palpate_register.symmetry import find_symmetries  # noqa: E402
from set_up import CAMERA, SetUp  # noqa: E402

CUBE = box_surface([0.06, 0.06, 0.06])
# A wedge: no rotation maps it to itself.
WEDGE = Surface(np.array([[0, 0, 0], [0.12, 0, 0], [0.09, 0.05, 0], [0, 0.07, 0],
                          [0.01, 0, 0.05], [0.1, 0.01, 0.06], [0.08, 0.04, 0.04], [0, 0.05, 0.05]]),
                [[0, 3, 2], [0, 2, 1], [4, 5, 6], [4, 6, 7], [0, 1, 5], [0, 5, 4], [2, 3, 7], [2, 7, 6],
                 [0, 4, 7], [0, 7, 3], [1, 2, 6], [1, 6, 5]])  # fmt: skip
POSE = Pose(exp_rotation([0.2, -0.3, 0.25]), np.array([0.6, 0.1, 0.3]))
GUESS = Guess(Pose(np.eye(3), np.array([0.59, 0.12, 0.29])), 0.05, np.radians(30))
DEVIATION = 3e-4  # m


@functools.lru_cache(maxsize=None)
def symmetries_of(surface):
    return find_symmetries(surface)


def register(surface, observed, starts=60, keep=6):
    return registering.register(surface, observed, starts, keep, symmetries=symmetries_of(surface))


def touched(surface, count, deviation=DEVIATION, seed=1, pose=POSE, has_normals=True):
    random = np.random.default_rng(seed)
    on, of = surface.samples(count, seed=seed)
    normals = surface.normals[of] @ pose.R.T if has_normals else np.zeros((count, 3))
    return Touches(pose.of(on) + deviation * random.normal(size=on.shape), normals, np.full(count, max(deviation, 1e-5)))


class Poses(unittest.TestCase):
    def distance(self, result, surface, pose=POSE):
        step = difference(result.symmetries.nearest(result.pose, pose), pose, surface.center)
        return np.linalg.norm(step[:3]), np.linalg.norm(step[3:])

    def test_exact_touches_give_the_exact_pose(self):
        result = register(CUBE, Observations(touched(CUBE, 18, 0.0), None, GUESS))
        position, angle = self.distance(result, CUBE)
        self.assertLess(position, 1e-6)
        self.assertLess(angle, 1e-5)

    def test_without_a_guess_the_one_pose_of_an_uneven_solid_is_found(self):
        for seed, R in enumerate(random_rotations(np.random.default_rng(2), 2)):
            pose = Pose(R, np.array([0.5, -0.2, 0.4]))
            result = register(WEDGE, Observations(touched(WEDGE, 16, seed=seed, pose=pose)), 300, 16)
            position, angle = self.distance(result, WEDGE, pose)
            self.assertLess(position, 1.5e-3)
            self.assertLess(angle, np.radians(2))
            self.assertEqual(len(result.symmetries.rotations), 1)

    def test_touches_need_no_normals(self):
        result = register(WEDGE, Observations(touched(WEDGE, 30, has_normals=False), None, GUESS))
        position, angle = self.distance(result, WEDGE)
        self.assertLess(position, 1e-3)
        self.assertLess(angle, np.radians(1))

    def test_the_tip_of_the_probe_has_a_radius(self):
        exact = touched(CUBE, 18, 0.0)
        tip = Touches(exact.points + 0.006 * exact.normals, exact.normals, exact.deviation, radius=0.006)
        self.assertLess(self.distance(register(CUBE, Observations(tip, None, GUESS)), CUBE)[0], 1e-6)

    def test_a_gross_error_is_left_out_and_named(self):
        touches = touched(WEDGE, 20)
        touches.points[4] += 0.012 * touches.normals[4]
        result = register(WEDGE, Observations(touches, None, GUESS))
        self.assertLess(self.distance(result, WEDGE)[0], 1e-3)
        self.assertEqual(result.verdict.gross, [4])
        self.assertTrue(result.verdict.fits)
        self.assertIn("touch 5 left out", result.verdict.text)

    def test_what_few_touches_leave_open_is_named(self):
        on = np.array([[x, y, 0.06] for x in (0.01, 0.05) for y in (0.01, 0.05)])
        touches = Touches(POSE.of(on), np.tile(POSE.R[:, 2], (4, 1)), np.full(4, DEVIATION))
        result = register(CUBE, Observations(touches, None, GUESS))
        self.assertEqual(sum("position" in words for words in result.undetermined), 2)
        self.assertIsNone(result.verdict.fits)

    def test_the_loss_is_that_of_its_weights(self):
        r = np.linspace(-9, 9, 181)
        slope = (robust.loss(r + 1e-6) - robust.loss(r - 1e-6)) / 2e-6
        np.testing.assert_allclose(slope, robust.weights(r) * r, atol=1e-5)


class Intervals(unittest.TestCase):
    def test_stated_deviations_are_those_of_many_draws(self):
        normalised = []
        for seed in range(30):
            random = np.random.default_rng(100 + seed)
            exact = touched(CUBE, 18, 0.0, seed=3)
            noisy = Touches(exact.points + DEVIATION * random.normal(size=(18, 3)), exact.normals, np.full(18, DEVIATION))
            found = refine(CUBE, POSE, Observations(noisy), widenings=(1.0,))
            step = difference(found.state.pose, POSE, CUBE.center)
            normalised.append(step @ np.linalg.solve(found.covariance, step))
        self.assertGreater(np.mean(normalised), 4)  # 6 are expected
        self.assertLess(np.mean(normalised), 9)


class Clouds(unittest.TestCase):
    def test_touches_correct_a_camera_that_is_off(self):
        set_up = SetUp("cube", 2000)
        cloud = set_up.cloud()
        alone = register(CUBE, Observations(cloud=cloud, guess=set_up.guess))
        touches = touched(CUBE, 9, pose=set_up.truth, seed=5)
        both = register(CUBE, Observations(touches, cloud, set_up.guess))
        errors = [np.linalg.norm(difference(both.symmetries.nearest(one.pose, set_up.truth), set_up.truth, CUBE.center)[:3])
                  for one in (alone, both)]  # fmt: skip
        self.assertGreater(errors[0], 0.5 * CAMERA)
        self.assertLess(errors[1], 1.5e-3)
        self.assertGreater(alone.deviations[0], 0.015)
        self.assertTrue(both.verdict.fits, both.verdict.text)
        self.assertGreater(np.linalg.norm(both.refined.state.shift), 0.5 * CAMERA)

    def test_a_thinned_cloud_weighs_the_same(self):
        cloud = Cloud(np.random.default_rng(1).normal(size=(5000, 3)))
        weight = len(cloud.points) / cloud.point_deviation**2
        thin = cloud.thinned(200)
        self.assertAlmostEqual(len(thin.points) / thin.point_deviation**2 / weight, 1)


class OtherObjects(unittest.TestCase):
    def test_another_size_is_named_with_its_interval(self):
        verdict = register(WEDGE, Observations(touched(WEDGE.scaled(1.08), 25), None, GUESS)).verdict
        self.assertFalse(verdict.fits)
        self.assertTrue(verdict.fits_scaled, verdict.text)
        self.assertLess(abs(verdict.scale - 1.08), 2.6 * verdict.scale_deviation)
        self.assertLess(verdict.scale_deviation, 0.01)

    def test_another_object_does_not_fit_at_any_scale(self):
        verdict = register(CUBE, Observations(touched(WEDGE, 25), None, GUESS)).verdict
        self.assertFalse(verdict.fits)
        self.assertFalse(verdict.fits_scaled)
        self.assertIn("another object", verdict.text)

    def test_the_right_one_fits_in_nearly_all_draws(self):
        fits = [register(CUBE, Observations(touched(CUBE, 16, seed=seed), None, GUESS), 30, 3).verdict.fits for seed in range(6)]
        self.assertGreaterEqual(sum(fits), 5)


if __name__ == "__main__":
    unittest.main(verbosity=2)
