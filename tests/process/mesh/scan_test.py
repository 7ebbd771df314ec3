"""palpate-mesh scan from synthetic clouds to meshes: volume, deviation, nodes, quality, messages. Skipped without Open3D or gmsh.

usage: scan_test.py BINARIES SOURCE
"""
import importlib.util
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

BINARIES, SOURCE = (pathlib.Path(word).resolve() for word in sys.argv[1:3])

import numpy as np  # noqa: E402

COUNT, NOISE, HOLE = 20000, 5e-4, 0.01  # points, m, m


def box(random, count):
    sides = np.array([0.1, 0.06, 0.04])
    areas = np.repeat(sides.prod() / sides, 2)
    face = random.choice(6, count, p=areas / areas.sum())
    points = random.uniform(size=(count, 3)) * sides
    points[np.arange(count), face // 2] = (face % 2) * sides[face // 2]
    return points - [0.05, 0.03, 0], sides.prod()


def cylinder(random, count):
    radius, height = 0.03, 0.08
    areas = np.array([2 * height, radius, radius])
    part = random.choice(3, count, p=areas / areas.sum())
    angle, r = random.uniform(0, 2 * np.pi, count), radius * np.sqrt(random.uniform(size=count))
    r = np.where(part == 0, radius, r)
    z = np.where(part == 0, height * random.uniform(size=count), np.where(part == 1, 0, height))
    return np.stack([r * np.cos(angle), r * np.sin(angle), z], axis=1), np.pi * radius**2 * height


def ellipsoid(random, count):
    axes = np.array([0.05, 0.03, 0.03])
    way = random.normal(size=(8 * count, 3))
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    stretch = np.linalg.norm(way / axes, axis=1)
    points = (way * axes)[random.uniform(size=len(way)) < stretch / stretch.max()]
    return points[:count] + [0, 0, 0.03], 4 / 3 * np.pi * axes.prod()


def torus(random, count):
    large, small = 0.04, 0.015
    u, v = random.uniform(0, 2 * np.pi, (2, 4 * count))
    keep = random.uniform(size=len(u)) < (large + small * np.cos(v)) / (large + small)
    u, v = u[keep][:count], v[keep][:count]
    r = large + small * np.cos(v)
    return np.stack([r * np.cos(u), r * np.sin(u), small * np.sin(v) + small], axis=1), 2 * np.pi**2 * large * small**2


def cloud(shape, seed):
    """Points with noise and a hole at the bottom, and the true volume, m^3."""
    random = np.random.default_rng(seed)
    points, volume = shape(random, COUNT + 1500)
    at = [0.04, 0, 0] if shape is torus else [0, 0, 0]
    points = points[np.linalg.norm(points - at, axis=1) > HOLE][:COUNT]
    return points + NOISE * random.normal(size=points.shape), volume


@unittest.skipUnless(importlib.util.find_spec("open3d"), "python3-open3d is not installed")
@unittest.skipUnless(shutil.which("gmsh"), "gmsh is not installed")
class Scan(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_scan(self, points, *words, scale=1.0):
        np.save(self.folder / "cloud.npy", points * scale)
        return subprocess.run([BINARIES / "palpate-mesh", "scan", self.folder / "cloud.npy", self.folder / "made.msh", *words],
                              capture_output=True, text=True)  # fmt: skip

    def check(self, shape, seed, volume_error, ratio, deviation, *words):
        points, volume = cloud(shape, seed)
        done = self.run_scan(points, "--json", self.folder / "all.json", *words)
        self.assertEqual(done.returncode, 0, done.stderr)
        found = json.loads((self.folder / "all.json").read_text())
        quality, measured = found["quality"], found["scan"]["deviation"]["cloud_from_surface"]
        print(f"{shape.__name__}: {quality['nodes_at_order_2']} nodes, volume {100 * quality['volume_m3'] / volume:.2f} %, "
              f"radius ratio {quality['radius_ratio']['least']:.3f}, deviation {1e3 * measured['mean_m']:.2f} mm mean, "
              f"{1e3 * measured['largest_m']:.2f} mm largest", flush=True)  # fmt: skip
        self.assertTrue(found["good"])
        self.assertTrue(525 <= quality["nodes_at_order_2"] <= 700, quality["nodes_at_order_2"])
        self.assertLess(abs(quality["volume_m3"] / volume - 1), volume_error)
        self.assertGreater(quality["radius_ratio"]["least"], ratio)
        self.assertLess(measured["mean_m"], deviation)
        self.assertEqual(quality["parts"], 1)
        self.assertLess(abs(found["scan"]["surface"]["volume_m3"] / volume - 1), 0.01)
        return done

    def test_box(self):
        picture = self.folder / "deviation.png"
        done = self.check(box, 1, 0.015, 0.2, 1.2e-3, "--deviation", picture)
        self.assertEqual(picture.read_bytes()[:4], b"\x89PNG")
        self.assertIn("deviation of cloud from mesh", done.stdout)

    def test_cylinder(self):
        self.check(cylinder, 2, 0.015, 0.2, 2e-3)

    def test_ellipsoid(self):
        self.check(ellipsoid, 3, 0.015, 0.2, 2e-3)

    def test_torus(self):
        self.check(torus, 4, 0.04, 0.03, 3e-3)

    def test_a_scan_of_one_side_is_refused(self):
        points, _ = cloud(ellipsoid, 5)
        done = self.run_scan(points[points[:, 2] > 0.04])
        self.assertEqual(done.returncode, 1)
        self.assertIn("cloud.npy", done.stderr)
        self.assertIn("one side only", done.stderr)
        self.assertFalse((self.folder / "made.msh").exists())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
