"""Touches of the robot in palpate-setup: their order, their file, and motions that meet nothing."""
import contextlib
import csv
import os
import pathlib
import sys
import tempfile
import unittest
from types import SimpleNamespace
from unittest import mock

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
TOOLS = pathlib.Path(os.environ["PALPATE_SOURCE_DIR"], "tools")
sys.path[:0] = [str(TOOLS / "setup"), str(TOOLS / "common")]

import numpy as np  # noqa: E402

from palpate_common.input_error import InputError  # noqa: E402
from palpate_setup import touching  # noqa: E402
from palpate_setup.step import Setting  # noqa: E402

PLANE = 0.3  # m, height of the surface that is touched


class Robot:
    """Touches the plane from 20 mm above it when it moves down; any other motion meets nothing."""

    def __init__(self):
        self.directions, self.started = [], False

    def start(self):
        self.started = True

    def touch(self, direction, force, progress):
        self.directions.append(direction)
        touched = direction[2] < -0.5
        return SimpleNamespace(touched=touched, state="touched" if touched else "no contact", reason="nothing within 60 mm", stiffness=200.0,
                               point=np.array([0.5, 0.0, PLANE]), centre=np.array([0.5, 0.0, PLANE + 0.01]), point_deviation=None)


class Touching(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name, "touches.csv")
        self.robot, self.asked = Robot(), []
        person = SimpleNamespace(ready=self.asked.append, say=lambda text: None, check=lambda: None)
        sensing = Setting("sensing", [{"name": "wrist", "payload": {"mass": 4.8}}])
        self.work = SimpleNamespace(person=person, project=SimpleNamespace(settings=lambda: [sensing]), answers={
            "count": 3, "touch_force": 0.3, "force_play": 0.1, "deviation": 2e-4, "probe_radius": 0.01, "tip_in_grasp": [0, 0, 0.1]})

    def touch(self, propose):
        with mock.patch.object(touching, "configuration_of"), \
                mock.patch.object(touching, "daemon", lambda work, path: contextlib.nullcontext((self.robot, None))):
            touching.touch_until_known(self.work, Setting("frames.object_in_base", {}), self.path, propose)

    def rows(self):
        with self.path.open() as file:
            return list(csv.DictReader(file))

    def test_the_centre_of_the_tip_the_normal_and_a_deviation_are_written(self):
        self.touch(lambda: (np.array([0.6, 0.0, PLANE]), np.array([0.0, 0.0, -1.0])))
        self.assertTrue(self.robot.started)
        self.assertEqual(len(self.rows()), 3)
        row = {key: float(value) for key, value in self.rows()[1].items()}
        self.assertEqual(row, {"x": 0.5, "y": 0.0, "z": PLANE + 0.01, "nx": 0.0, "ny": 0.0, "nz": 1.0, "deviation": 2e-4})
        self.assertIn("[0.6, 0.0, 0.3] m", self.asked[2])

    def test_it_ends_where_nothing_is_proposed(self):
        self.touch(lambda: None)
        self.assertEqual(len(self.rows()), 1)

    def test_motions_that_meet_nothing_end_with_a_reason(self):
        with self.assertRaisesRegex(InputError, "5 motions in a row.*60 mm"):
            self.touch(lambda: (np.zeros(3), np.array([1.0, 0.0, 0.0])))
        self.assertEqual(len(self.robot.directions), 6)
        self.assertEqual(len(self.rows()), 1)

    def test_an_empty_hand_tares_and_holds_nothing(self):
        changed = {setting.path: setting.value for setting in touching.settings(self.work, Setting("frames.object_in_base", {}))}
        self.assertTrue(changed["sensing"][0]["tare_at_start"])
        self.assertEqual(changed["control"]["law"], "guarded_motion")
        self.assertEqual(changed["control"]["tip_radius"], 0.01)
        self.assertEqual(changed["control"]["force_play"], 0.1)
        self.assertIsNone(changed["object.grasp_box"])


if __name__ == "__main__":
    unittest.main()
