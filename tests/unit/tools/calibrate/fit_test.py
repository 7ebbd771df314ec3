"""Loads at rest and in motion are found within their intervals; what is not observable is named."""

import unittest

import support
import numpy as np

import wrist_scores as scores
from palpate_calibrate.fit import Options, fit_wrist
from palpate_calibrate.observability import weaknesses
from palpate_calibrate.quantities import deviations, is_determined
from palpate_calibrate.recording import Mounting
from palpate_common.input_error import InputError
from palpate_common.rotations import exp_rotation, log_rotation

MASS, CENTER = 1.3, np.array([0.01, -0.02, 0.08])
BIAS = np.array([2, -1, 3, 0.1, -0.05, 0.02])
R_ES = exp_rotation(np.array([0.02, -0.03, 1.6]))
NEAR = Mounting(sensor_rotation=exp_rotation(np.array([0, 0, np.pi / 2])))


def poses(count=30, axis=None, **more):
    return support.at_rest(support.random_rotations(np.random.default_rng(3), count, axis), MASS, CENTER, R_ES, BIAS, **more)


class AtRest(unittest.TestCase):
    def test_load_bias_and_rotation_are_found(self):
        fit = fit_wrist(poses(), NEAR, Options(drift="none", pose_errors=False))
        p = fit.parameters
        self.assertEqual(fit.polarity, 1)
        self.assertLess(abs(p.mass - MASS), 4 * deviations(fit, "mass")[0])
        self.assertLess(deviations(fit, "mass")[0], 0.002)
        self.assertTrue(np.all(np.abs(p.center_of_mass - CENTER) < 4 * deviations(fit, "moment")))
        self.assertTrue(np.all(np.abs(log_rotation(R_ES.T @ p.R_ES)) < 4 * deviations(fit, "sensor_rotation")))
        self.assertTrue(np.all(np.abs(p.force_bias - BIAS[:3]) < 4 * deviations(fit, "force_bias")))
        self.assertTrue(np.all(np.abs(p.torque_bias - BIAS[3:]) < 4 * deviations(fit, "torque_bias")))

    def test_the_sign_of_gravity_is_that_of_the_messages(self):
        # A hand that hangs at rest reads its weight upwards (docs/own_robot.md).
        recording = support.at_rest(np.eye(3)[None], 2, np.zeros(3), np.eye(3), np.zeros(6), noise=(0, 0))
        np.testing.assert_allclose(recording.wrench.values[0, :3], [0, 0, 19.62], atol=1e-9)

    def test_a_sensor_of_the_other_polarity_is_recognised(self):
        fit = fit_wrist(poses(polarity=-1), NEAR, Options(drift="none", pose_errors=False))
        self.assertEqual(fit.polarity, -1)
        self.assertLess(abs(fit.parameters.mass - MASS), 0.01)

    def test_an_outlier_has_little_weight(self):
        recording = poses()
        recording.wrench.values[7] += [20, 0, 0, 1, 0, 0]
        fit = fit_wrist(recording, NEAR, Options(drift="none", pose_errors=False))
        self.assertGreaterEqual(fit.outliers, 1)
        self.assertLess(abs(fit.parameters.mass - MASS), 0.05)

    def test_what_poses_at_rest_do_not_determine_is_named(self):
        named = {name: w.advice for w in weaknesses(fit_wrist(poses(), NEAR)) for name in w.parameters}
        self.assertIn("while moving", named["inertia_xx"])
        self.assertIn("while moving", named["wrench_delay"])
        self.assertNotIn("mass", named)

    def test_a_turn_about_the_vertical_determines_no_mass(self):
        fit = fit_wrist(poses(axis=[0, 0, 1]), NEAR)
        named = {name for w in weaknesses(fit) for name in w.parameters}
        self.assertIn("mass", named)
        self.assertFalse(is_determined(fit, "mass").any())

    def test_too_few_poses_are_refused(self):
        with self.assertRaisesRegex(InputError, "3 poses; allowed: 4 or more"):
            fit_wrist(poses(3), NEAR)


class InMotion(unittest.TestCase):
    def test_a_drawn_wrist_is_found_within_the_goals(self):
        result = scores.score(2000, False)
        for name, (goal, _, _) in scores.GOALS.items():
            self.assertLess(result["goals"][name], goal, name)
        ratios = np.concatenate([np.abs(result["errors"][n]) / np.array(result["half_widths"][n]) for n in result["errors"]])
        self.assertGreater(np.mean(ratios < 1.5), 0.9)


if __name__ == "__main__":
    unittest.main()
