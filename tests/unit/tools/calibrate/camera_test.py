"""Poses of a camera by touches, by the tool in clouds and by a marker: exact cases, derivatives, gross errors, intervals."""

import unittest

import support

import numpy as np

from palpate_calibrate.camera.closed_form import eye_to_hand, pose_of_square
from palpate_calibrate.camera.defaults import ARM
from palpate_calibrate.camera.depth_error import DepthError
from palpate_calibrate.camera.flange_poses import ArmError, moved_flanges
from palpate_calibrate.camera.intrinsics import Intrinsics
from palpate_calibrate.camera.least_squares import CONSISTENT, estimate
from palpate_calibrate.camera.marker import CORNERS, KnownPlace, MarkerProblem, MarkerState, SeenMarker, fit_marker
from palpate_calibrate.camera.pick_file import with_depths_of
from palpate_calibrate.camera.tool import ToolClouds, ToolProblem, ToolState, fit_tool
from palpate_calibrate.camera.touches import PickedTouches, TouchProblem, fit_touches, rigid_fit, start_pose
from palpate_common import robust
from palpate_common.input_error import InputError
from palpate_common.pose import Pose, difference, moved
from palpate_common.rotations import exp_rotation, log_rotation
from palpate_common.surface import Surface, box_surface

# Looks from the side and from above at about (0.6, 0, 0.3).
DOWNWARDS = np.array([[1.0, 0, 0], [0, -0.6, 0.8], [0, -0.8, -0.6]])
CAMERA = Pose(exp_rotation([0.0, 0.0, 0.1]) @ DOWNWARDS, np.array([0.6, -0.8, 0.9]))
LENS = Intrinsics(580.0, 575.0, 320.0, 240.0)
MIDDLE = np.array([0.6, 0.0, 0.3])
TOUCH = 3e-4  # m
EXACT = DepthError(1e-5, 1e-5)


def difference_of(pose):
    return difference(pose, CAMERA, np.zeros(3))


def check_derivatives(test, problem, state, tolerance=1e-4):
    """By central differences of all residuals."""
    groups = problem.groups(state)
    count = groups[0].J.shape[1]
    for k in range(count):
        step = np.zeros(count)
        step[k] = 1e-6
        plus, minus = problem.groups(problem.stepped(state, step)), problem.groups(problem.stepped(state, -step))
        for group, high, low in zip(groups, plus, minus):
            expected = (high.r * high.deviation / group.deviation - low.r * low.deviation / group.deviation) / 2e-6
            scale = max(np.abs(group.J).max(), 1.0)
            np.testing.assert_allclose(group.J[:, k] / scale, expected / scale, atol=tolerance, err_msg=f"{group.name}, {k}")


def touched(count, random, depth=DepthError(2e-3, 1.5e-3), touch=TOUCH, noise=1.0):
    points_W = MIDDLE + random.uniform(-0.25, 0.25, (count, 3))
    points_C = CAMERA.inverse_of(points_W)
    rays = points_C / np.linalg.norm(points_C, axis=1, keepdims=True)
    along, aside = depth.along(points_C), depth.across(points_C)
    error = aside[:, None] * random.normal(size=(count, 3))
    error += ((along * random.normal(size=count)) - np.einsum("ij,ij->i", error, rays))[:, None] * rays
    touched_at = points_W + noise * touch * random.normal(size=(count, 3))
    return PickedTouches("touches.csv", touched_at, points_C + noise * error, touch, depth)


class Touches(unittest.TestCase):
    def test_exact_pairs_give_the_exact_pose(self):
        exact = touched(6, np.random.default_rng(1), noise=0.0)
        # fit_rotation prefers its start a little.
        self.assertLess(np.abs(difference_of(rigid_fit(exact.points_W, exact.points_C))).max(), 1e-7)
        self.assertLess(np.abs(difference_of(fit_touches(exact).pose)).max(), 1e-6)

    def test_derivatives(self):
        problem = TouchProblem(touched(7, np.random.default_rng(2)))
        check_derivatives(self, problem, moved(CAMERA, np.array([0.01, -0.02, 0.01, 0.1, 0.05, -0.1]), np.zeros(3)))

    def test_the_start_withstands_a_third_of_wrong_pairs_and_they_are_named(self):
        picked = touched(18, np.random.default_rng(3))
        wrong = np.arange(0, 18, 3)
        picked.points_C[wrong] += np.random.default_rng(4).uniform(0.05, 0.2, (6, 3))
        self.assertLess(np.linalg.norm(log_rotation(start_pose(picked).R.T @ CAMERA.R)), 0.05)
        fit = fit_touches(picked)
        self.assertTrue((np.abs(difference_of(fit.pose)) < 2 * fit.half_widths).all())
        depth = fit.estimate.groups[0]
        across = fit.estimate.groups[1]
        self.assertEqual(set(fit.gross(depth)) | set(fit.gross(across) // 2), set(wrong))

    def test_with_exact_isotropic_errors_the_covariance_is_the_closed_form(self):
        # Of n pairs with deviation s of each axis: rotation s^2 (sum over |y|^2 I - y y')^-1 about the middle, position
        # there s^2 / n.
        random = np.random.default_rng(5)
        picked = touched(400, random, DepthError(1e-12, 1e-12), touch=1e-3)
        fit = fit_touches(picked)
        y = picked.points_W - picked.points_W.mean(axis=0)
        rotation = 1e-6 * np.linalg.inv((y**2).sum() * np.eye(3) - y.T @ y)
        np.testing.assert_allclose(fit.covariance[3:, 3:], rotation, atol=0.15 * rotation.max())
        arm = fit.pose.p - picked.points_W.mean(axis=0)
        turn = np.cross(np.eye(3), arm)
        position = 1e-6 / 400 * np.eye(3) + turn.T @ rotation @ turn
        np.testing.assert_allclose(fit.covariance[:3, :3], position, atol=0.15 * position.max())

    def test_errors_are_as_large_as_stated_over_many_draws_although_the_stated_deviations_are_wrong(self):
        squares, held = [], []
        for seed in range(60):
            picked = touched(25, np.random.default_rng(100 + seed))
            wrong = PickedTouches("t", picked.points_W, picked.points_C, TOUCH, DepthError(6e-3, 5e-4))
            fit = fit_touches(wrong)
            error = difference_of(fit.pose)
            squares.append(error @ np.linalg.solve(fit.covariance, error))
            held.append(np.abs(error) <= fit.half_widths)
        self.assertGreater(np.mean(squares), 4.5)  # 6 are expected; more with Student's distribution
        self.assertLess(np.mean(squares), 9)
        self.assertGreater(np.mean(held), 0.90)
        self.assertLess(np.mean(held), 0.99)

    def test_points_on_a_line_or_too_few_are_refused(self):
        line = np.outer(np.linspace(0, 0.3, 8), [1.0, 0, 0]) + MIDDLE
        with self.assertRaisesRegex(InputError, "t.csv: the points lie on a line"):
            PickedTouches("t.csv", line, CAMERA.inverse_of(line), TOUCH, EXACT)
        with self.assertRaisesRegex(InputError, "3 points; allowed: 4 or more"):
            PickedTouches("t.csv", line[:3], line[:3], TOUCH, EXACT)

    def test_depths_come_from_the_plane_through_the_cloud(self):
        random = np.random.default_rng(6)
        normal, offset = np.array([0.3, 0.2, -1.0]), -0.9  # normal . x = offset, m
        in_image = random.uniform(-0.2, 0.2, (20000, 2))
        rays = np.column_stack([in_image, np.ones(len(in_image))])
        exact = offset / (rays @ normal)
        cloud = rays * (exact + 2e-3 * random.normal(size=len(rays)))[:, None]
        picks = rays[:6] * (exact[:6] + np.array([3, -3, 2, -2, 0, 1]) * 1e-3)[:, None]
        picked = PickedTouches("t", CAMERA.of(picks), picks, TOUCH, DepthError(2e-3, 1e-3))
        found, kept = with_depths_of(cloud, picked, 0.015)
        self.assertEqual(kept, [])
        self.assertLess(np.abs(found.points_C[:, 2] - exact[:6]).max(), 1.2e-3)
        np.testing.assert_allclose(found.points_C[:, :2] / found.points_C[:, 2:], in_image[:6], atol=1e-12)
        with self.assertRaisesRegex(InputError, "no pick lies within"):
            with_depths_of(cloud + [0, 0, 0.5], picked, 0.015)


def flanges_of(count, random, angle=0.8):
    found = []
    for _ in range(count):
        axis = random.normal(size=3)
        R = exp_rotation(angle * random.uniform(0.3, 1) * axis / np.linalg.norm(axis))
        found.append(Pose(R, MIDDLE + random.uniform(-0.15, 0.15, 3)))
    return found


def reported(flanges, random, arm=ARM):
    errors = np.repeat([arm.position, arm.rotation], 3) * random.normal(size=(len(flanges), 6))
    return moved_flanges(flanges, errors)


MARKER = Pose(exp_rotation([2.2, 0.3, -0.4]), np.array([0.05, -0.03, 0.08]))


def seen_marker(count, random, pixel=0.05, arm=ARM, side=0.08, stated=0.08, place=None):
    flanges = flanges_of(count, random) if place is None else [Pose(np.eye(3), np.zeros(3))] * count
    on = MARKER if place is None else place.pose
    corners = [LENS.projected(CAMERA.inverse_of(flange.of(on.of(side * CORNERS)))) for flange in flanges]
    corners = [c + pixel * random.normal(size=(4, 2)) for c in corners]
    stated_flanges = reported(flanges, random, arm) if place is None else flanges
    return SeenMarker("images.csv", LENS, corners, stated_flanges, stated, 0.005 * stated, max(pixel, 1e-3), arm, place)


class Marker(unittest.TestCase):
    def test_closed_forms_are_exact_without_errors(self):
        flanges = flanges_of(6, np.random.default_rng(1))
        in_C = [CAMERA.inverse().times(flange).times(MARKER) for flange in flanges]
        for pose in in_C:
            corners = pose.of(0.08 * CORNERS)
            found = pose_of_square(corners / corners[:, 2:], 0.08 * CORNERS)
            self.assertLess(np.abs(difference(found, pose, np.zeros(3))).max(), 1e-8)
        camera, marker = eye_to_hand(flanges, in_C)
        self.assertLess(np.abs(difference_of(camera)).max(), 1e-7)
        self.assertLess(np.abs(difference(marker, MARKER, np.zeros(3))).max(), 1e-7)

    def test_a_mirrored_pose_of_one_image_is_left_out_of_the_start(self):
        flanges = flanges_of(8, np.random.default_rng(2))
        in_C = [CAMERA.inverse().times(flange).times(MARKER) for flange in flanges]
        in_C[3] = Pose(exp_rotation([1.2, 0, 0]) @ in_C[3].R, in_C[3].p)
        self.assertLess(np.abs(difference_of(eye_to_hand(flanges, in_C)[0])).max(), 1e-6)

    def test_derivatives(self):
        random = np.random.default_rng(3)
        seen = seen_marker(5, random)
        off = moved(CAMERA, 0.01 * random.normal(size=6), np.zeros(3))
        state = MarkerState(off, MARKER, 0.081, 1e-3 * random.normal(size=(5, 6)))
        check_derivatives(self, MarkerProblem(seen), state, 2e-3)  # the arm's rotations add up to the first order only
        exact = MarkerState(state.camera, MARKER, 0.081, np.zeros((5, 6)))
        check_derivatives(self, MarkerProblem(seen), exact)

    def test_the_true_side_of_the_marker_is_found_by_the_motion(self):
        fit = fit_marker(seen_marker(15, np.random.default_rng(4), 0.01, ArmError(1e-5, 1e-5), side=0.0806))
        self.assertLess(np.linalg.norm(difference_of(fit.pose)[:3]), 5e-4)
        self.assertLess(abs(fit.estimate.state.side - 0.0806), 3e-5)

    def test_errors_are_as_large_as_stated_over_many_draws(self):
        squares, held = [], []
        for seed in range(25):
            fit = fit_marker(seen_marker(12, np.random.default_rng(200 + seed)))
            error = difference_of(fit.pose)
            squares.append(error @ np.linalg.solve(fit.covariance, error))
            held.append(np.abs(error) <= fit.half_widths)
        self.assertGreater(np.mean(squares), 3.5)
        self.assertLess(np.mean(squares), 9.5)
        self.assertGreater(np.mean(held), 0.88)

    def test_turns_about_one_axis_only_leave_a_direction_open_which_is_named(self):
        random = np.random.default_rng(5)
        axis = np.array([0.0, 0, 1])
        angles = np.linspace(-0.6, 0.6, 8)
        flanges = [Pose(exp_rotation(angle * axis), MIDDLE + random.uniform(-0.1, 0.1, 3)) for angle in angles]
        corners = [LENS.projected(CAMERA.inverse_of(flange.of(MARKER.of(0.08 * CORNERS)))) for flange in flanges]
        fit = fit_marker(SeenMarker("i", LENS, corners, flanges, 0.08, 4e-4, 0.05, ARM))
        self.assertIn("position along (0.00 0.00 1.00)", fit.undetermined)

    def test_a_marker_on_a_known_place_needs_one_image(self):
        place = KnownPlace(Pose(exp_rotation([2.2, 0.3, -0.4]), MIDDLE), 5e-4, np.radians(0.1))
        fit = fit_marker(seen_marker(1, np.random.default_rng(6), 0.01, place=place))
        error = difference_of(fit.pose)
        self.assertTrue((np.abs(error) <= 1.5 * fit.half_widths).all(), (error, fit.half_widths))

    def test_distortion_is_undone(self):
        lens = Intrinsics(500, 510, 310, 250, (0.1, -0.2, 0.001, -0.002, 0.05))
        ideal = np.random.default_rng(7).uniform([20, 20], [620, 460], (50, 2))
        x, y = ((ideal - [310, 250]) / [500, 510]).T
        square = x**2 + y**2
        radial = 1 + 0.1 * square - 0.2 * square**2 + 0.05 * square**3
        u = x * radial + 2 * 0.001 * x * y - 0.002 * (square + 2 * x**2)
        v = y * radial + 0.001 * (square + 2 * y**2) - 2 * 0.002 * x * y
        np.testing.assert_allclose(lens.undistorted(np.column_stack([500 * u + 310, 510 * v + 250])), ideal, atol=1e-6)


PALM, THUMB = box_surface([0.12, 0.09, 0.1]), box_surface([0.03, 0.03, 0.09])
TOOL = Surface(np.concatenate([PALM.nodes, THUMB.nodes + [0.02, 0.03, 0.1]]),
               np.concatenate([PALM.triangles, THUMB.triangles + 8]))  # fmt: skip


def seen_tool(count, random, noise=1e-3, arm=ARM, guess=CAMERA):
    """Points of the outer surface that face the camera; what hides them is of no concern here."""
    flanges, clouds = flanges_of(count, random), []
    for k, flange in enumerate(flanges):
        points, of = TOOL.samples(800, seed=k)
        eye = flange.inverse_of(CAMERA.p[None])[0]
        inside = ((points > 1e-6) & (points < [0.12 - 1e-6, 0.09 - 1e-6, 0.1 + 1e-6])).all(axis=1)
        faces = (np.einsum("ij,ij->i", TOOL.normals[of], eye - points) > 0.05) & ~inside
        in_C = CAMERA.inverse_of(flange.of(points[faces]))
        clouds.append(in_C * (1 + noise * in_C[:, 2:] * random.normal(size=(len(in_C), 1))))
    error = DepthError(max(noise, 1e-4), 1e-4)
    return ToolClouds("clouds.csv", TOOL, reported(flanges, random, arm), clouds, guess, 0.1, error, arm)


class Tool(unittest.TestCase):
    def test_from_20_mm_and_2_degrees_off_exact_clouds_give_the_exact_pose(self):
        off = moved(CAMERA, np.array([0.012, -0.012, 0.011, 0.02, 0.02, -0.02]), np.zeros(3))
        fit = fit_tool(seen_tool(5, np.random.default_rng(1), 0.0, ArmError(1e-6, 1e-6), off))
        self.assertLess(np.abs(difference_of(fit.pose)).max(), 2e-4)

    def test_derivatives(self):
        random = np.random.default_rng(2)
        seen = seen_tool(3, random)
        points = [cloud[:40] for cloud in seen.clouds]
        # The deviation's own change with the direction is left out of the derivatives, as check_derivatives allows for.
        check_derivatives(self, ToolProblem(seen, points), ToolState(CAMERA, np.zeros((3, 6))), 2e-3)

    def test_background_is_left_out(self):
        random = np.random.default_rng(3)
        seen = seen_tool(5, random)
        for k, cloud in enumerate(seen.clouds):
            wall = np.column_stack([random.uniform(-0.5, 0.5, (3000, 2)), np.full(3000, 2.0)])
            stray = cloud[:20] + random.uniform(-0.08, 0.08, (20, 3))
            seen.clouds[k] = np.concatenate([cloud, wall, stray])
        fit = fit_tool(seen)
        self.assertTrue((np.abs(difference_of(fit.pose)) < 2 * fit.half_widths).all())

    def test_the_intervals_hold_over_draws(self):
        held = []
        for seed in range(8):
            fit = fit_tool(seen_tool(6, np.random.default_rng(300 + seed)))
            held.append(np.abs(difference_of(fit.pose)) <= fit.half_widths)
        self.assertGreater(np.mean(held), 0.8)

    def test_a_tool_that_is_not_there_is_reported(self):
        away = moved(CAMERA, np.array([0.6, 0, 0, 0, 0, 0]), np.zeros(3))
        with self.assertRaisesRegex(InputError, "clouds.csv: cloud 1: 0 points within 0.1 m of the tool where --guess"):
            fit_tool(seen_tool(4, np.random.default_rng(4), guess=away))


class Weights(unittest.TestCase):
    def test_the_factor_for_consistency_is_that_of_the_loss(self):
        r = np.linspace(-12, 12, 200001)
        density = np.exp(-0.5 * r**2)
        w = robust.weights(r)
        self.assertAlmostEqual((w * r**2 * density).sum() / (w * density).sum(), CONSISTENT, places=3)

    def test_factors_of_the_stated_deviations_are_found(self):
        random = np.random.default_rng(8)
        picked = touched(300, random, DepthError(4e-3, 5e-4), touch=1e-6)
        wrong = PickedTouches("t", picked.points_W, picked.points_C, 1e-6, DepthError(2e-3, 1e-3))
        found = estimate(TouchProblem(wrong), start_pose(wrong))
        self.assertAlmostEqual(found.factors["depth of picks"], 2, delta=0.2)
        self.assertAlmostEqual(found.factors["picks across the ray"], 0.5, delta=0.05)


if __name__ == "__main__":
    unittest.main(verbosity=2)
