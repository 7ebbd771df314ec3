"""Configuration, obstacles and the steps together: what is kept of a made-up cloud, and how the rest is counted."""
import pathlib
import tempfile
import unittest

import support

import numpy as np

from palpate_common.input_error import InputError
from palpate_common.rotations import from_rpy
from palpate_see.cloud import Cloud
from palpate_see.configuration import read_settings
from palpate_see.pipeline import Pipeline
from palpate_see.robot_body import RobotBody

PALPATED = f"""
bus: {{control: "udpm://239.255.99.99:9999?ttl=0"}}
robot: {{urdf: {support.URDF}}}
obstacles:
  - {{name: table, shape: half_space, pose: {{position: [0, 0, 0.28]}}, friction: 0.3,
     pose_deviation: {{position: [0, 0, 0.004], rotation_deg: [0.1, 0, 0]}}}}
  - {{name: post, shape: cylinder, radius: 0.05, length: 0.5, pose: {{position: [1.0, 0.4, 0.5]}}}}
  - {{name: palm, shape: box, size: [0.1, 0.1, 0.1], link: hand, pose: {{position: [0, 0, 0.3]}}}}
  - {{name: door, shape: sphere, radius: 5, moved: true}}
"""
SEE = """
configuration: palpated.yaml
camera_in_base: {position: [1.0, 0, 1.3], rpy_deg: [180, 0, 0]}
crop: {lower: [0.5, -0.5, 0], upper: [1.5, 0.5, 1]}
robot: {hand_at_rest: [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]}
"""
RANDOM = np.random.default_rng(8)
# Where the hand is: the arm straight up, and its link `hand` with the base of the palm's box at 1.2185 m above the base.
UP = [0.0] * 7


def plate(count, middle, size):
    """(count, 3), m, in W, in a box."""
    return np.array(middle) + RANDOM.uniform(-0.5, 0.5, (count, 3)) * np.array(size)


class Case(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        (self.folder / "palpated.yaml").write_text(PALPATED)

    def settings(self, text=SEE):
        (self.folder / "see.yaml").write_text(text)
        return read_settings(self.folder / "see.yaml")


class Steps(Case):
    def pipeline(self, text=SEE):
        settings = self.settings(text)
        body = RobotBody(settings.robot)
        for utime in range(0, 100_000, 10_000):
            body.add_arm(utime, UP)
        return Pipeline(settings, body)

    @staticmethod
    def cloud(points, utime=1, colours=None):
        """Of points in W, as the camera of SEE, which looks down, has them."""
        R = from_rpy(np.radians([180, 0, 0]))
        return Cloud(utime, (points - np.array([1.0, 0, 1.3])) @ R, colours)

    def test_each_point_is_counted_by_what_removed_it(self):
        bar = plate(3000, [1.1, 0, 0.34], [0.5, 0.06, 0])
        others = {
            "obstacles": np.vstack([plate(500, [1, -0.2, 0.28], [0.5, 0.3, 0.004]),
                                    plate(100, [1, 0.4, 0.5], [0.1, 0.05, 0.2])]),
            "crop": plate(50, [1.0, 0.9, 0.5], [0.1, 0.1, 0.1]),
            "range": plate(40, [1.0, 0, 1.2], [0.01, 0.01, 0.01]),
            "not_finite": np.full((30, 3), np.nan),
            "outliers": np.array([[0.7, 0, 0.6], [1.4, 0.2, 0.6]]),
        }
        pipeline = self.pipeline()
        seen = pipeline.process(self.cloud(np.vstack([bar, *others.values()])))
        points = pipeline.counters.points
        for reason, removed in others.items():
            if reason != "outliers":
                self.assertEqual(points[reason], len(removed), reason)
        self.assertGreaterEqual(points["outliers"], 2)
        self.assertLess(points["outliers"], 200)
        self.assertEqual(points["published"], len(seen.points))
        # What the box and the table cut off was seen, too, and makes edges.
        self.assertLess(points["edges"], 100)
        self.assertEqual(points["received"], sum(points[name] for name in points if name != "received"))
        self.assertGreater(len(seen.points), 150)
        self.assertLessEqual(len(seen.points), 256)
        np.testing.assert_allclose(seen.points[:, 2], 0.34, atol=1e-12)
        self.assertEqual(seen.utime, 1)
        self.assertAlmostEqual(seen.deviation, np.hypot(0.0012 + 0.0019 * 0.56**2, 0.0014), delta=1e-4)  # at 0.96 m

    def test_a_table_that_is_higher_than_configured_is_removed_where_it_is_seen(self):
        bar = plate(3000, [1.1, 0, 0.35], [0.5, 0.06, 0])
        table = plate(20_000, [1.0, 0, 0.288], [0.9, 0.9, 0])
        table = table[np.abs(table[:, 1]) > 0.03]
        noise = np.array([0, 0, 0.0018]) * RANDOM.normal(size=(len(table), 1))
        seen = self.pipeline().process(self.cloud(np.vstack([bar, table + noise])))
        np.testing.assert_allclose(seen.points[:, 2], 0.35, atol=1e-12)

    def test_the_robot_and_what_it_carries_are_removed(self):
        near_the_arm = plate(2000, [0.066, 0, 0.5], [0.001, 0.02, 0.26])  # of link_2, of a radius of 60 mm
        free = plate(2000, [0.10, 0, 0.5], [0.001, 0.05, 0.3])
        palm = plate(300, [0.055, 0, 1.5185], [0.001, 0.05, 0.05])  # of the obstacle on the hand
        text = "configuration: palpated.yaml\ncamera_in_base: {}\nrange: {nearest: 0.01}\nedges: {pixels: 0}\n"
        settings = self.settings(text + f"robot: {{arm_at_rest: {UP}, hand_at_rest: {[0.0] * 20}}}\n")
        pipeline = Pipeline(settings, RobotBody(settings.robot))
        seen = pipeline.process(Cloud(1, np.vstack([near_the_arm, free, palm])))
        self.assertEqual(pipeline.counters.points["robot"], 2000)
        self.assertEqual(pipeline.counters.points["obstacles"], 300)
        np.testing.assert_allclose(seen.points[:, 0], 0.10, atol=1e-3)

    def test_colours_where_the_cloud_has_them(self):
        bar = plate(1000, [1.1, 0, 0.34], [0.5, 0.06, 0])
        text = SEE + "colour: {rgb: [0.95, 0.72, 0.3]}\n"
        colours = np.tile([0.475, 0.36, 0.15], (1000, 1))
        colours[:300] = 0.5
        pipeline = self.pipeline(text)
        self.assertIsNotNone(pipeline.process(self.cloud(bar, 1, colours)))
        self.assertEqual(pipeline.counters.points["colour"], 300)
        self.assertIsNotNone(pipeline.process(self.cloud(bar, 2)))
        self.assertEqual(pipeline.counters.points["colour"], 300)

    def test_clouds_that_are_not_used_are_counted(self):
        bar = plate(1000, [1.1, 0, 0.34], [0.5, 0.06, 0])
        pipeline = self.pipeline()
        self.assertIsNotNone(pipeline.process(self.cloud(bar, 50_000)))
        self.assertIsNone(pipeline.process(self.cloud(bar, 40_000)))
        self.assertIsNone(pipeline.process(self.cloud(bar, 200_000)))
        self.assertIsNone(pipeline.process(self.cloud(bar[:10], 200_001), 200_002))
        self.assertIsNone(pipeline.process(self.cloud(bar, 200_001), 2_000_000))
        pipeline = self.pipeline()
        self.assertIsNone(pipeline.process(self.cloud(bar[:15], 50_000)))
        self.assertIsNone(pipeline.process(self.cloud(bar[:0], 50_001)))
        self.assertEqual((pipeline.counters.clouds["too_few_points"], pipeline.counters.clouds["published"]), (2, 0))

    def test_the_same_cloud_gives_the_same_points(self):
        bar = plate(3000, [1.1, 0, 0.34], [0.5, 0.06, 0])
        first, again = (self.pipeline().process(self.cloud(bar)) for _ in range(2))
        np.testing.assert_array_equal(first.points, again.points)


class Configurations(Case):
    def refused(self, text, *parts):
        with self.assertRaises(InputError) as caught:
            self.settings(text)
        for part in parts:
            self.assertIn(part, str(caught.exception))

    def test_defaults_and_what_is_taken_from_palpated(self):
        settings = self.settings()
        self.assertEqual((settings.control_url, settings.clouds_url), ("udpm://239.255.99.99:9999?ttl=0",) * 2)
        self.assertEqual((settings.channel, len(settings.obstacles), settings.robot.deviation), ("POINT_CLOUD", 4, 0.002))
        self.assertEqual([(o.position_deviation, o.rotation_deviation) for o in settings.obstacles[:2]],
                         [(0.004, np.radians(0.1)), (0.001, 0)])
        self.assertIsNone(self.settings("camera_in_base: {}\noutliers: false\n").outliers)
        self.assertEqual(self.settings(SEE + "obstacles: {remove: false}\n").obstacles, [])

    def test_wrong_values_are_named(self):
        pose = "camera_in_base: {position: [1, 0, 1]}\n"
        self.refused("crop: {}\n", "see.yaml: camera_in_base: is absent; required")
        self.refused(pose + "crop: {lower: [0, 0, 0], upper: [1, 0, 1]}\n", "see.yaml:2: crop.upper", "above lower")
        self.refused(pose + "colour: {rgb: [0, 0, 0]}\n", "see.yaml:2: colour.rgb")
        self.refused(pose + "range: {nearest: 6}\n", "range.nearest: 6; allowed: below farthest, 5")
        self.refused(pose + "thinning: {points: 257}\n", "thinning.points: 257; allowed: a whole number from 1 to 256")
        self.refused(pose + "timing: {clock: mine}\n", "timing.clock: mine; allowed: sender, received")
        self.refused(pose + "noise: {bas: 1}\n", "noise.bas: is unknown; allowed: base")
        self.refused(pose + "camera_error: {angle: 1}\n", "camera_error.angle: is unknown; allowed: angle_deg, position")
        self.refused(pose + "crops: {}\n", "see.yaml:2: crops: is unknown", "crop")
        self.refused(pose + "intrinsics: {width: 640, height: 480}\n", "intrinsics.fx: is absent; required")
        self.refused(pose + "outliers: {neighbours: 0}\n", "outliers.neighbours: 0")
        self.refused(pose + "outliers: 5\n", "see.yaml:2: outliers: 5; allowed: a mapping of keys")
        self.refused(pose + "configuration: none.yaml\n", "none.yaml: No such file")
        self.refused(pose + "robot: {}\n", "robot.urdf: is absent here and in palpated's configuration")
        self.refused("camera_in_base: {quaternion: [1, 1, 0, 0]}\n", "quaternion", "length 1")
        self.refused(pose + "configuration: palpated.yaml\n", "robot: has no link hand, which carries the obstacle palm")

    def test_wrong_obstacles_of_palpated_are_named_there(self):
        (self.folder / "palpated.yaml").write_text("obstacles:\n  - {name: a, shape: cone}\n")
        self.refused(SEE, "palpated.yaml:2: obstacles.0.shape: cone; allowed: half_space, box")


if __name__ == "__main__":
    unittest.main(verbosity=2)
