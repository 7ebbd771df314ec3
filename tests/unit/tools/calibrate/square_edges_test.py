"""Corners of a marker in rendered images, from the edges of its square."""

import unittest

import support  # noqa: F401

import numpy as np

import drawn_camera
import simulated_marker
from palpate_calibrate.camera.marker import CORNERS
from palpate_calibrate.camera.square_edges import square_corners
from scipy.spatial.transform import Rotation

SIDE = 0.08  # m


def seen(random):
    """An image and the true corners, (4, 2), px."""
    turn = Rotation.from_euler("x", 180, degrees=True) * Rotation.from_rotvec(0.5 * drawn_camera.unit(random))
    marker = drawn_camera.Frame(turn, np.array([0.1, -0.05, random.uniform(0.7, 1.1)]))
    in_C = marker.of(SIDE * CORNERS)
    pixels = drawn_camera.FOCAL * in_C[:, :2] / in_C[:, 2:] + [drawn_camera.WIDTH / 2, drawn_camera.HEIGHT / 2]
    return simulated_marker.render(marker, SIDE, random), pixels


class Corners(unittest.TestCase):
    def test_are_found_from_a_pixel_off_in_spite_of_blur_and_noise(self):
        random = np.random.default_rng(1)
        errors = []
        for _ in range(12):
            image, truth = seen(random)
            errors.append(square_corners(image, truth + random.uniform(-1, 1, (4, 2))) - truth)
        errors = np.array(errors)
        self.assertLess(np.sqrt(np.mean(errors**2)), 0.1)
        self.assertLess(np.abs(errors.mean(axis=(0, 1))).max(), 0.05)

    def test_an_image_without_edges_leaves_them_where_they_are(self):
        rough = np.array([[100.0, 100], [140, 100], [140, 140], [100, 140]])
        np.testing.assert_array_equal(square_corners(np.full((480, 640), 128, np.uint8), rough), rough)


if __name__ == "__main__":
    unittest.main(verbosity=2)
