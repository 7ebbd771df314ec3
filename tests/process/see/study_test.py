"""measure_see on two scenes; its rays compared with steps along them, its kinematics with those of tools/see. Goal, logs and
errors of measure_shape, without its runs.

usage: study_test.py BINARIES SOURCE
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
BINARIES, SOURCE = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
PROGRAM = SOURCE / "tools/lab/see/measure_see"
sys.path[:0] = [str(BINARIES.parent / "python"),
                *(str(SOURCE / "tools" / folder) for folder in ("see", "common", "lab/draws", "lab/goals", "lab/see"))]

import numpy as np  # noqa: E402
import palpate  # noqa: E402
import shape_run  # noqa: E402
from scipy.spatial.transform import Rotation  # noqa: E402

from palpate_see.kinematics import link_poses  # noqa: E402
from palpate_see.urdf import read_robot  # noqa: E402
from rays import Body, cast, distance_to_boxes  # noqa: E402
from robot_bodies import Model  # noqa: E402
from score import text_of  # noqa: E402

URDF = SOURCE / "sim/robot/lwr_hand.urdf"
RANDOM = np.random.default_rng(6)


def measure(folder, *words):
    return subprocess.run([PROGRAM, "--first", "3000", "--output", folder, *words], capture_output=True, text=True)


class Study(unittest.TestCase):
    def test_two_scenes(self):
        with tempfile.TemporaryDirectory() as folder:
            done = measure(folder, "--draws", "2")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(done.stdout.count("goal"), 2)
            found = json.loads(pathlib.Path(folder, "see.json").read_text())
        for kind in ("image", "cloud"):
            self.assertLess(found[kind]["values"]["wrong_percent"], 3)
            self.assertGreater(found[kind]["values"]["covered_percent"], 80)
            self.assertGreater(found[kind]["values"]["published_least"], 100)

    def test_wrong_command_lines_are_refused(self):
        for words in (["--dra", "x"], ["--draws", "0"], ["--first", "-1"]):
            self.assertEqual(measure("unused", *words).returncode, 64, words)

    def test_the_goal_is_met_or_missed(self):
        def of(wrong):
            result = {"published": 200, "wrong": wrong, "wrong_by_label": {"4": wrong}, "covered": 1, "seconds": 0.1}
            return text_of("image", [result])[0]

        self.assertRegex(of(2), r"1\.00 % +goal at most 1 % +met")
        self.assertRegex(of(3), r"1\.50 % +goal at most 1 % +MISSED")


class Shape(unittest.TestCase):
    def run_shape(self, folder, *words):
        program = SOURCE / "tools/lab/see/measure_shape"
        return subprocess.run([program, "--output", folder, *words], capture_output=True, text=True)

    def test_the_goal_counts_all_runs_together(self):
        def of(errors):
            return shape_run.text_of([{"seen": {"mean": seen, "observations": 9}, "truth": {"mean": truth, "observations": 10},
                                       "blind": {"mean": 3e-3}} for seen, truth in errors])[0]  # fmt: skip

        self.assertRegex(of([(2e-3, 1e-3), (0.99e-3, 1.5e-3)]), r"segmentation +1\.20 +goal at most 1\.2 +met")
        missed = of([(2e-3, 1e-3), (1.1e-3, 1.5e-3)])
        self.assertRegex(missed, r"segmentation +1\.24 +goal at most 1\.2 +MISSED")
        self.assertRegex(missed, r"in the worst run +2\.00")
        self.assertRegex(missed, r"share of the clouds +90 %")

    def test_wrong_command_lines_are_refused(self):
        for words in (["--draws", "0"], ["--first", "-1"], ["--bim", "x"]):
            self.assertEqual(self.run_shape("unused", *words).returncode, 64, words)

    def test_a_seed_gives_the_same_run(self):
        first, again, other = (shape_run.draw(seed) for seed in (3000, 3000, 3001))
        self.assertEqual(first.settings, again.settings)
        self.assertNotEqual(first.settings[3:], other.settings[3:])
        bar = (shape_run.MIDDLE - first.p) @ first.R
        self.assertTrue(0.7 < bar[2] < 1.2, bar)  # before the camera
        self.assertLess(np.hypot(*bar[:2]), 0.1)

    def test_observations_come_when_palpate_see_would_have_sent_them(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            cloud = bytes(8) + (1000).to_bytes(8, "big") + bytes(20)  # the message's stamp
            for log, events in (("sensors", [(50_000, "FT_WRENCH", b"a"), (90_000, "SHAPE_OBSERVATION", b"truth"),
                                             (120_000, "FT_WRENCH", b"b")]),
                                ("clouds", [(61_000, "POINT_CLOUD", cloud)]),
                                ("seen", [(1000, "SHAPE_OBSERVATION", b"seen")])):  # fmt: skip
                with palpate.EventLogWriter(folder / f"{log}.log") as writer:
                    for event in events:
                        writer.write(*event)
            found = {kind: [(event.utime, event.data) for event in palpate.EventLog(shape_run._log_of(kind, folder, palpate))]
                     for kind in shape_run.KINDS}  # fmt: skip
        self.assertEqual(found["seen"], [(50_000, b"a"), (111_000, b"seen"), (120_000, b"b")])
        self.assertEqual(found["truth"], [(50_000, b"a"), (90_000, b"truth"), (120_000, b"b")])
        self.assertEqual(found["blind"], [(50_000, b"a"), (120_000, b"b")])


class Rays(unittest.TestCase):
    def test_hits_are_where_steps_along_the_ray_first_lie_inside(self):
        def inside(body, local):
            if body.kind == "box":
                return (np.abs(local) < np.array(body.size) / 2).all(axis=1)
            if body.kind == "sphere":
                return np.linalg.norm(local, axis=1) < body.size[0]
            if body.kind == "cylinder":
                return (np.hypot(local[:, 0], local[:, 1]) < body.size[0]) & (np.abs(local[:, 2]) < body.size[1] / 2)
            return local[:, 2] < 0

        steps = np.linspace(0, 3, 30001)
        for kind, size in (("box", (0.3, 0.2, 0.4)), ("sphere", (0.2,)), ("cylinder", (0.15, 0.5)), ("half_space", ())):
            R = Rotation.from_rotvec(RANDOM.normal(size=3) * (kind != "half_space")).as_matrix()
            p = RANDOM.uniform(-0.2, 0.2, 3)
            body = Body(kind, size, R, p, 7)
            origin = np.array([0.9, -0.8, 1.1])
            ways = p + RANDOM.uniform(-0.3, 0.3, (60, 3)) - origin
            ways /= np.linalg.norm(ways, axis=1)[:, None]
            hits = cast(origin, ways, [body])
            for way, distance, label, normal in zip(ways, hits.distance, hits.label, hits.normal):
                reached = np.flatnonzero(inside(body, (origin + steps[:, None] * way - p) @ R))
                self.assertEqual(label, 7 if np.isfinite(distance) else -1)
                if len(reached) > 3:
                    self.assertAlmostEqual(distance, steps[reached[0]], delta=2e-4, msg=kind)
                    self.assertLess(normal @ way, 0)
                elif len(reached) == 0:
                    self.assertEqual(distance, np.inf)

    def test_the_nearest_body_is_seen(self):
        near, far = (Body("sphere", (0.1,), np.eye(3), np.array([x, 0, 0.0]), label) for x, label in ((1, 1), (2, 2)))
        self.assertEqual(cast(np.zeros(3), np.array([[1, 0, 0.0]]), [far, near]).label.tolist(), [1])

    def test_distances_to_boxes(self):
        boxes = [Body("box", (2, 2, 2), np.eye(3), np.array([x, 0, 0.0]), 1) for x in (0, 5)]
        points = np.array([[0, 0, 0], [2, 0, 0], [3.5, 0, 2.0]])
        self.assertEqual(distance_to_boxes(points, boxes).tolist(), [0, 1, np.hypot(0.5, 1)])


class Kinematics(unittest.TestCase):
    def test_both_calculations_agree_on_every_link(self):
        robot, model = read_robot(URDF), Model(URDF)
        for _ in range(3):
            angles = {joint.name: RANDOM.uniform(-1, 1) for joint in robot.joints if joint.is_free}
            for link, X in link_poses(robot, angles).items():
                R, p = model.pose(link, angles)
                np.testing.assert_allclose(X.R, R, atol=1e-12, err_msg=link)
                np.testing.assert_allclose(X.p, p, atol=1e-12, err_msg=link)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
