"""Closest points of triangles and surfaces, and gradients of signed distances."""

import os
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(os.environ["PALPATE_SOURCE_DIR"], "tools/common")))

import numpy as np  # noqa: E402

from palpate_common.surface import Surface, box_surface, gradients  # noqa: E402
from palpate_common.triangles import Triangles  # noqa: E402

CUBE = box_surface([0.06, 0.06, 0.06])


class ClosestPoints(unittest.TestCase):
    def test_none_of_many_places_on_the_triangle_is_nearer(self):
        random = np.random.default_rng(1)
        corners, points = random.normal(size=(200, 3, 3)), 2 * random.normal(size=(200, 3))
        found = np.linalg.norm(Triangles(corners).closest(points, np.arange(200)) - points, axis=1)
        a, b = np.meshgrid(np.linspace(0, 1, 60), np.linspace(0, 1, 60))
        inside = a + b <= 1
        weights = np.column_stack([a[inside], b[inside], 1 - a[inside] - b[inside]])
        tried = np.linalg.norm(np.einsum("wk,nkc->nwc", weights, corners) - points[:, None], axis=2).min(axis=1)
        self.assertTrue((found <= tried + 1e-12).all())
        self.assertLess((tried - found).max(), 0.1)

    def test_a_fine_mesh_has_those_of_its_box(self):
        n = 15
        grid = np.linspace(0, 1, n + 1)
        nodes, triangles = [], []
        for axis in range(3):
            for side in (0.0, 1.0):
                first = len(nodes)
                for u in grid:
                    for v in grid:
                        nodes.append(np.roll([side, u, v], axis))
                for i in range(n):
                    for j in range(n):
                        a, b = first + i * (n + 1) + j, first + (i + 1) * (n + 1) + j
                        two = [(a, b, b + 1), (a, b + 1, a + 1)]
                        triangles += two if side else [t[::-1] for t in two]
        fine, coarse = Surface(np.array(nodes), triangles), box_surface([1, 1, 1])
        points = np.random.default_rng(2).uniform(-0.5, 1.5, (300, 3))
        np.testing.assert_allclose(fine.closest(points)[0], coarse.closest(points)[0], atol=1e-12)
        np.testing.assert_allclose(fine.center, [0.5, 0.5, 0.5], atol=1e-12)

    def test_a_measured_normal_decides_between_faces(self):
        point = np.array([[0.0601, 0.03, 0.0595]])
        for normal in ([1.0, 0, 0], [0, 0, 1.0]):
            _, chosen = CUBE.closest(point, np.array([normal]))
            np.testing.assert_allclose(CUBE.normals[chosen[0]], normal)

    def test_open_surfaces_are_refused(self):
        with self.assertRaises(ValueError):
            Surface([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])


class Gradients(unittest.TestCase):
    def test_are_those_of_differences_inside_and_outside(self):
        random = np.random.default_rng(3)
        points = random.uniform(-0.03, 0.09, (200, 3))

        def distances(places):
            feet, chosen = CUBE.closest(places)
            return gradients(places, feet, CUBE.normals[chosen])

        found, g = distances(points)
        inside = ((points > 0) & (points < 0.06)).all(axis=1)
        np.testing.assert_array_equal(found < 0, inside)
        np.testing.assert_allclose(np.linalg.norm(g, axis=1), 1, atol=1e-12)
        step = 1e-7 * random.normal(size=points.shape)
        change = distances(points + step)[0] - distances(points - step)[0]
        np.testing.assert_allclose(change, 2 * np.einsum("ij,ij->i", g, step), atol=1e-11)

    def test_on_the_surface_they_are_the_normals(self):
        points, chosen = CUBE.samples(30)
        distance, g = gradients(points, points, CUBE.normals[chosen])
        np.testing.assert_array_equal(distance, 0)
        np.testing.assert_array_equal(g, CUBE.normals[chosen])


if __name__ == "__main__":
    unittest.main(verbosity=2)
