"""palpate_scan without Open3D: normals, fit, removal of folds, the side an object stands on, deviations."""
import os
import pathlib
import sys
import unittest
from unittest import mock

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
SOURCE = pathlib.Path(os.environ["PALPATE_SOURCE_DIR"])
sys.path[:0] = [str(SOURCE / "tools/mesh"), str(SOURCE / "tools/common")]

import numpy as np  # noqa: E402

from palpate_common.input_error import InputError  # noqa: E402
from palpate_common.surface import Surface, box_surface  # noqa: E402
from palpate_scan.deviation import measure  # noqa: E402
from palpate_scan.fit import _moved, filtered_normals  # noqa: E402
from palpate_scan.reconstruction import open3d  # noqa: E402
from palpate_scan.support import support_points  # noqa: E402
from palpate_scan.triangles import areas_and_normals, collapsed, enclosed_volume  # noqa: E402


def divided(surface, times):
    """Each triangle in four, `times` times."""
    nodes, triangles = surface.nodes, surface.triangles
    for _ in range(times):
        middle, places, made = {}, list(nodes), []

        def between(a, b):
            key = (min(a, b), max(a, b))
            if key not in middle:
                middle[key] = len(places)
                places.append(0.5 * (places[a] + places[b]))
            return middle[key]

        for a, b, c in triangles:
            ab, bc, ca = between(a, b), between(b, c), between(c, a)
            made += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        nodes, triangles = np.array(places), np.array(made)
    return nodes, triangles


def edges_of(triangles):
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    return np.unique(edges, axis=0, return_counts=True)[1]


class Triangles(unittest.TestCase):
    def test_volume_areas_and_normals_of_a_box(self):
        box = box_surface([0.1, 0.2, 0.3])
        self.assertAlmostEqual(enclosed_volume(box.nodes, box.triangles), 0.006)
        self.assertAlmostEqual(enclosed_volume(box.nodes, box.triangles[:, ::-1]), -0.006)
        areas, normals = areas_and_normals(box.nodes, box.triangles)
        self.assertAlmostEqual(areas.sum(), 0.22)
        np.testing.assert_allclose(np.abs(normals).max(axis=1), 1)

    def test_a_merged_edge_leaves_a_closed_surface(self):
        nodes, triangles = divided(box_surface([0.1, 0.1, 0.1]), 2)
        places, left, count = collapsed(nodes, triangles, np.array([5, 40, 77]))
        self.assertEqual(count, 3)
        self.assertEqual(len(left), len(triangles) - 2 * count)
        self.assertEqual(len(places), len(nodes) - count)
        self.assertTrue((edges_of(left) == 2).all())


class Fit(unittest.TestCase):
    def test_an_offset_box_with_blunt_edges_returns_to_the_points(self):
        sides = np.array([0.1, 0.06, 0.04])
        box = box_surface(sides)
        random = np.random.default_rng(1000)
        points, _ = box.samples(8000)
        points = points + 3e-4 * random.normal(size=points.shape)
        nodes, triangles = divided(box, 4)
        # Corners of the triangles at the box's edges are cut by 3 mm, and all is moved by 1 mm.
        on = (np.isclose(nodes, 0) | np.isclose(nodes, sides)).sum(axis=1)
        toward = np.where(np.isclose(nodes, 0), 1.0, np.where(np.isclose(nodes, sides), -1.0, 0.0))
        blunt = nodes + (on >= 2)[:, None] * 3e-3 * toward / np.maximum(on, 1)[:, None] + [1e-3, 0, 0]
        before = abs(enclosed_volume(blunt, triangles) / sides.prod() - 1)
        for _ in range(3):
            blunt = _moved(blunt, triangles, filtered_normals(blunt, triangles), points, 0.1)
        self.assertGreater(before, 0.01)
        self.assertLess(abs(enclosed_volume(blunt, triangles) / sides.prod() - 1), 0.005)
        corner = np.linalg.norm(blunt - sides, axis=1).min()
        self.assertLess(corner, 1e-3)

    def test_normals_of_a_noisy_box_become_those_of_its_sides(self):
        nodes, triangles = divided(box_surface([0.1, 0.1, 0.1]), 4)
        noisy = nodes + 3e-4 * np.random.default_rng(1001).normal(size=nodes.shape)
        normals = filtered_normals(noisy, triangles)
        truth = areas_and_normals(nodes, triangles)[1]
        before = np.einsum("ij,ij->i", areas_and_normals(noisy, triangles)[1], truth)
        after = np.einsum("ij,ij->i", normals, truth)
        self.assertLess(np.degrees(np.arccos(after.mean())), 0.4 * np.degrees(np.arccos(before.mean())))


class Support(unittest.TestCase):
    SPACING = 2e-3

    def cloud(self, hole):
        """A box of 100 x 60 x 40 mm without what `hole` selects of its bottom; points, normals and unseen places."""
        box = box_surface([0.1, 0.06, 0.04])
        points, of = box.samples(12000)
        normals = box.normals[of]
        is_hole = (normals[:, 2] < -0.5) & hole(points)
        return points[~is_hole], normals[~is_hole], points[is_hole]

    def test_the_missing_bottom_is_filled_with_its_plane(self):
        added = support_points(*self.cloud(lambda p: p[:, 0] > -1), self.SPACING)
        self.assertGreater(len(added.points), 0.8 * 0.1 * 0.06 / self.SPACING**2)
        self.assertLess(np.abs(added.points[:, 2]).max(), 0.75 * self.SPACING)
        self.assertTrue((added.points[:, :2] > -1e-3).all() and (added.points[:, :2] < [0.101, 0.061]).all())
        self.assertTrue((added.normals[:, 2] < -0.99).all())

    def test_a_hole_within_the_bottom_is_left_to_the_reconstruction(self):
        added = support_points(*self.cloud(lambda p: np.linalg.norm(p[:, :2] - [0.05, 0.03], axis=1) < 0.015), self.SPACING)
        self.assertEqual(len(added.points), 0)


class Deviations(unittest.TestCase):
    def test_of_points_at_a_known_distance(self):
        box = box_surface([0.1, 0.1, 0.1])
        on, of = box.samples(20000)
        found = measure(on + 1e-3 * box.normals[of], Surface(box.nodes, box.triangles))
        np.testing.assert_allclose(found.signed, 1e-3, atol=1e-9)
        self.assertAlmostEqual(found.facts["cloud_from_surface"]["mean_m"], 1e-3)
        self.assertAlmostEqual(found.facts["cloud_from_surface"]["signed_mean_m"], 1e-3)
        self.assertGreater(found.facts["surface_from_cloud"]["mean_m"], 1e-3)
        self.assertLess(found.facts["surface_from_cloud"]["p95_m"], 3e-3)

    def test_of_points_inside_is_negative(self):
        box = box_surface([0.1, 0.1, 0.1])
        on, of = box.samples(500)
        self.assertLess(measure(on - 1e-3 * box.normals[of], box).signed.max(), 0)


class Absent(unittest.TestCase):
    def test_open3d_is_named_with_its_package(self):
        with mock.patch.dict(sys.modules, {"open3d": None}), self.assertRaises(InputError) as caught:
            open3d()
        self.assertIn("apt-get install python3-open3d", str(caught.exception))


if __name__ == "__main__":
    unittest.main()
