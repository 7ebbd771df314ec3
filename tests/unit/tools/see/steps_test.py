"""Steps that keep or thin points, each alone: box, colour, outliers, thinning, noise, time stamps, counters."""
import unittest

import support  # noqa: F401

import numpy as np

from palpate_see.camera_error import WITHIN_95, CameraError
from palpate_see.colour import ColourRange
from palpate_see.counters import Counters
from palpate_see.crop import Crop
from palpate_see.noise import NoiseModel
from palpate_see.outliers import OutlierFilter
from palpate_see.point_error import PointError
from palpate_see.thinning import Thinning, farthest, voxels
from palpate_see.timing import ExposureOrder, Timing

RANDOM = np.random.default_rng(3)
PLATE = np.column_stack([RANDOM.uniform(0, 0.5, 4000), RANDOM.uniform(0, 0.06, 4000), np.zeros(4000)])  # m


def largest_gap(points, chosen):
    """m, from any point to the nearest chosen one."""
    return np.linalg.norm(points[:, None] - points[chosen][None], axis=2).min(axis=1).max()


class Keeping(unittest.TestCase):
    def test_the_box_includes_its_faces(self):
        crop = Crop(np.array([0, 0, 0.0]), np.array([1, 1, 1.0]))
        points = np.array([[0.5, 0.5, 0.5], [1, 0, 1], [1.001, 0, 0], [0, -0.001, 0]])
        self.assertEqual(crop.keeps(points).tolist(), [True, True, False, False])

    def test_the_colour_counts_whatever_the_brightness(self):
        colour = ColourRange(np.array([0.95, 0.72, 0.3]), 0.09)
        colours = np.array([[0.95, 0.72, 0.3], [0.19, 0.144, 0.06], [0.6, 0.62, 0.65], [0.01, 0.01, 0.005]])
        self.assertEqual(colour.keeps(colours).tolist(), [True, True, False, False])

    def test_points_without_neighbours_are_outliers(self):
        stray = np.array([[0.25, 0.03, 0.05], [0.6, 0.03, 0]])
        keeps = OutlierFilter().keeps(np.vstack([PLATE, stray]))
        self.assertEqual(keeps[-2:].tolist(), [False, False])
        self.assertGreater(keeps[:-2].mean(), 0.93)

    def test_too_few_points_have_no_neighbours(self):
        self.assertFalse(OutlierFilter(neighbours=12).keeps(PLATE[:12]).any())
        self.assertEqual(OutlierFilter().keeps(np.zeros((0, 3))).shape, (0,))


class ThinningOfAPlate(unittest.TestCase):
    def test_no_more_than_asked_for_and_no_large_gap(self):
        for method, gap in (("voxel", 0.02), ("farthest", 0.012)):
            for most in (256, 100):
                chosen = Thinning(method, most).chosen(PLATE)
                self.assertLessEqual(len(chosen), most)
                self.assertGreater(len(chosen), 0.6 * most, method)
                self.assertLess(largest_gap(PLATE, chosen), gap * np.sqrt(256 / most), method)
                self.assertEqual(len(set(chosen.tolist())), len(chosen))

    def test_the_same_points_in_any_order_give_the_same_ones(self):
        order = RANDOM.permutation(len(PLATE))
        for method in ("voxel", "farthest"):
            thinning = Thinning(method)
            first = {tuple(point) for point in PLATE[thinning.chosen(PLATE)]}
            again = {tuple(point) for point in PLATE[order][thinning.chosen(PLATE[order])]}
            self.assertEqual(first, again, method)

    def test_few_points_and_none(self):
        for count in (0, 1, 5):
            self.assertEqual(farthest(PLATE[:count], 256).tolist(), list(range(count)))
            self.assertEqual(len(voxels(PLATE[:count], 1e-4, 256)), count)

    def test_a_voxel_gives_the_point_nearest_to_its_mean(self):
        points = np.array([[0.001, 0.001, 0.001], [0.002, 0.002, 0.002], [0.0031, 0.003, 0.003], [0.015, 0, 0]])
        self.assertEqual(voxels(points, 0.01, 256).tolist(), [1, 3])


class Noise(unittest.TestCase):
    def test_depths_of_a_kinect(self):
        # Nguyen 2012: 1.2 mm at 0.4 m, 1.88 mm at 1 m, 6.06 mm at 2 m.
        np.testing.assert_allclose(NoiseModel().deviation(np.array([0.4, 1, 2])), [1.2e-3, 1.884e-3, 6.064e-3], rtol=1e-9)

    def test_95_percent_of_drawn_errors_of_the_pose_are_within_what_is_stated(self):
        error = CameraError(0.002, 0.01)
        for stated, deviation in ((0.002, error.position_deviation), (0.01, error.angle_deviation)):
            sizes = np.linalg.norm(deviation * RANDOM.normal(size=(100_000, 3)), axis=1)
            self.assertAlmostEqual((sizes <= stated).mean(), 0.95, delta=0.003)

    def test_the_error_of_the_pose_adds_and_the_variance_is_averaged(self):
        # Across the ray a rotation by 0.003 rad displaces a point 1 m away by 3 mm, one 2 m away by 6 mm.
        points, camera = np.array([[0, 0, 1.0], [0, 1.2, 1.6]]), CameraError(0.002 * WITHIN_95, 0.003 * WITHIN_95)
        np.testing.assert_allclose(PointError(NoiseModel(0.006, 0), camera).in_base(points), [7e-3, np.sqrt(76) * 1e-3])
        exact = PointError(NoiseModel(), CameraError(1e-9, 1e-9))
        expected = np.sqrt((1.2e-3**2 + 6.064e-3**2) / 2)
        self.assertAlmostEqual(exact.common_deviation(np.array([[0, 0, 0.4], [0, 0, 2.0]])), expected)

    def test_margins_hold_four_deviations_of_the_depth_and_three_of_the_places(self):
        points = np.array([[0, 0, 1.0]])
        error = PointError(NoiseModel(0.006, 0), CameraError(0.002 * WITHIN_95, 0.003 * WITHIN_95))
        np.testing.assert_allclose(error.margins(points, 0.0), np.sqrt(24**2 + 13 * 9) * 1e-3)
        np.testing.assert_allclose(error.margins(points, 0.006), np.sqrt(24**2 + 49 * 9) * 1e-3)
        np.testing.assert_allclose(error.margins_of_fit(points), 0.024)


class Stamps(unittest.TestCase):
    def test_only_later_exposures_are_accepted(self):
        order = ExposureOrder(Timing())
        self.assertEqual([order.refusal(at, None) for at in (10, 20, 20, 15, 21)],
                         [None, None, "out_of_order", "out_of_order", None])  # fmt: skip

    def test_old_ones_and_those_of_another_clock(self):
        order = ExposureOrder(Timing(most_age_us=1000))
        self.assertEqual(order.refusal(5000, 6000), None)
        self.assertEqual(order.refusal(5001, 6002), "old")
        self.assertEqual(order.refusal(1_000_000, 6002), "ahead")
        self.assertEqual(order.refusal(5002, 6002), None)  # what was ahead does not stop those after it

    def test_the_delay_and_the_clock_of_reception(self):
        self.assertEqual(ExposureOrder(Timing(delay_us=300)).exposure(1000, 5000), 700)
        received = ExposureOrder(Timing(clock="received", delay_us=300))
        self.assertEqual(received.exposure(1000, 5000), 4700)
        self.assertEqual(received.exposure(1000, None), 700)


class Counting(unittest.TestCase):
    def test_lines_name_what_occurred(self):
        counters = Counters()
        counters.clouds["received"] = 3
        counters.clouds["out_of_order"] = 1
        self.assertEqual(counters.line(), "clouds: 3 received, 1 out of order, 0 published\npoints: 0 received, 0 published")
        self.assertEqual(counters.as_json()["clouds"]["old"], 0)
        counters.refused_states = 2
        self.assertIn("\njoint states: 2 refused", counters.line())


if __name__ == "__main__":
    unittest.main(verbosity=2)
