"""Clouds of palpate-sim's camera: decoded by palpate-see's decoder, and the bar that palpate-see finds in them.

usage: simulator_test.py BINARIES SOURCE
"""
import csv
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

BINARIES, SOURCE = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path[:0] = [str(BINARIES.parent / "python"), *(str(SOURCE / "tools" / folder) for folder in ("see", "common"))]

import numpy as np  # noqa: E402
from scipy.spatial import cKDTree  # noqa: E402

import palpate  # noqa: E402
from palpate.mesh import PointsInMesh  # noqa: E402
from palpate_common.pose import Pose  # noqa: E402
from palpate_common.rotations import from_rpy  # noqa: E402
from palpate_see.point_cloud_message import decode_point_cloud  # noqa: E402

SCENE = SOURCE / "sim/scenes/bar_long_soft_control_cloud.yaml"
CONFIGURATION = SOURCE / "tools/see/examples/bar_long_soft.yaml"
X_WC = Pose(from_rpy(np.radians([-124.98927385, 0, -0.81845546])), np.array([1.1, -0.7, 0.8]))
X_WO = Pose(from_rpy(np.array([0, 0, np.pi])), np.array([1.36, 0.03, 0.28]))
MOTION = "motion={start_delay: 0.2, poses: [{move: 0.8, hold: 0.3, translation: [0, 0.02, 0.04]}]}"
NEAR = 0.0055  # m: half the diagonal of 5 mm, and five times the noise of 0.3 mm


def surface():
    """(n, 3), m, in O: points of the bar's surface at rest."""
    x, y = np.linspace(0, 0.5, 101), np.linspace(0, 0.06, 13)
    sides = [(a, b) for a in y for b in y if a in (0, 0.06) or b in (0, 0.06)]
    ends = [(end, a, b) for end in (0, 0.5) for a in y for b in y]
    return np.array([(s, a, b) for s in x for a, b in sides] + ends)


class Simulated(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        settings = [MOTION, "camera.occlusions=[]", "sensors.camera.jitter=0"]
        words = [word for setting in settings for word in ("--set", setting)]
        done = subprocess.run([BINARIES / "palpate-sim", SCENE, "--record", cls.folder, "--duration", "1.3", *words],
                              capture_output=True, text=True, timeout=500)  # fmt: skip
        if done.returncode != 0:
            raise RuntimeError(done.stdout + done.stderr)
        cls.events = list(palpate.EventLog(cls.folder / "clouds.log"))
        cls.clouds = [decode_point_cloud(event.data) for event in cls.events]
        log = palpate.read_log(cls.folder / "truth.log")
        truth = log["TRUTH_SHAPE"]
        cls.truth_times, cls.truth = truth.sent_utime, truth.positions
        cls.surface = PointsInMesh(next(iter(log.meshes("TRUTH_MESH").values())), surface())

    def distances(self, points, utime):
        """(n,), m, of points in W from the true object's surface at the nearest time, known every 5 mm."""
        shape = self.truth[int(np.abs(self.truth_times - utime).argmin())]
        return cKDTree(X_WO.of(self.surface.at(shape))).query(points)[0]

    def test_clouds_come_at_their_rate_and_late(self):
        self.assertEqual({event.channel for event in self.events}, {"POINT_CLOUD"})
        self.assertIn(len(self.clouds), (12, 13))
        stamps = np.array([cloud.utime for cloud in self.clouds])
        self.assertTrue((np.abs(np.diff(stamps) - 100_000) <= 1000).all(), stamps)
        self.assertEqual({event.utime - stamp for event, stamp in zip(self.events, stamps)}, {60_000})

    def test_sizes_are_bounded(self):
        for event, cloud in zip(self.events, self.clouds):
            self.assertLessEqual(len(cloud.points), 160 * 120)
            self.assertGreater(len(cloud.points), 500)
            self.assertLessEqual(len(event.data), 16 * 160 * 120 + 300)

    def test_amber_points_lie_on_the_bar_and_others_do_not(self):
        for cloud in self.clouds[::4]:
            share = cloud.colours / cloud.colours.sum(axis=1, keepdims=True)
            amber = np.linalg.norm(share - np.array([0.95, 0.72, 0.3]) / 1.97, axis=1) < 0.05
            points = X_WC.of(cloud.points[amber])
            self.assertGreater(len(points), 200)
            self.assertLess(np.quantile(self.distances(points, cloud.utime), 0.99), NEAR)
            self.assertGreater((~amber).sum(), 100)  # arm, hand and rig

    def test_palpate_see_finds_the_bar(self):
        output = self.folder / "seen.csv"
        done = subprocess.run([BINARIES / "palpate-see", "--config", CONFIGURATION, "--log", self.folder / "clouds.log", "--joints",
                               self.folder / "sensors.log", "--output", output], capture_output=True, text=True, timeout=300)  # fmt: skip
        self.assertEqual(done.returncode, 0, done.stderr)
        with output.open() as file:
            rows = [[float(value) for value in row.values()] for row in csv.DictReader(file)]
        seen = np.array(rows)
        self.assertGreaterEqual(len(np.unique(seen[:, 0])), len(self.clouds) - 1, done.stdout)
        off = 0
        for utime in np.unique(seen[:, 0]):
            points = seen[seen[:, 0] == utime, 2:]
            self.assertGreater(len(points), 100)
            off += int((self.distances(points, utime) > NEAR).sum())
        self.assertLess(off, 0.01 * len(seen))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
