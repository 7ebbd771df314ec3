"""Plausibility of messages, geometry of the object, and the check of the first motion of palpate-setup."""
import os
import pathlib
import sys
import unittest
from types import SimpleNamespace

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
TOOLS = pathlib.Path(os.environ["PALPATE_SOURCE_DIR"], "tools")
sys.path[:0] = [str(TOOLS / "setup"), str(TOOLS / "common")]

import numpy as np  # noqa: E402

from palpate_common.input_error import InputError  # noqa: E402
from palpate_common.surface import box_surface  # noqa: E402
from palpate_setup.steering import Steering  # noqa: E402
from palpate_setup.steps.motion import compare  # noqa: E402
from palpate_setup.steps.object import cells_of, controlled_point, face_box  # noqa: E402
from palpate_setup.traffic import Heard, judge  # noqa: E402

RATES = {"ROBOT_STATE": 500, "FT_WRENCH": 1000, "IMU": 300}
SECONDS = 2


def robot(i, **change):
    t = i / RATES["ROBOT_STATE"]
    message = dict(utime=int(1e6 * t), session=1, joint_count=7, position=[0.5 + 0.05 * t, 0.1, 0.4], quaternion=[1, 0, 0, 0],
                   twist=[0.05, 0, 0, 0, 0, 0])
    return SimpleNamespace(**{**message, **change})


def wrench(i, **change):
    return SimpleNamespace(**{**dict(utime=i, session=1, wrench=[0.01 * (i % 7), 0, 47, 0, 0, 0]), **change})


def imu(i, **change):
    return SimpleNamespace(**{**dict(utime=i, session=1, acceleration=[0.01 * (i % 5), 0, 9.81], angular_velocity=[0, 0, 0]), **change})


MAKERS = {"ROBOT_STATE": robot, "FT_WRENCH": wrench, "IMU": imu}


def traffic(**changes):
    """Two seconds of a moving arm with good messages; `changes`: of a channel's messages, or None: the channel is absent."""
    heard = {}
    for channel, make in MAKERS.items():
        change = changes.get(channel, {})
        if change is None:
            continue
        count = RATES[channel] * SECONDS
        heard[channel] = Heard(channel, [i / RATES[channel] for i in range(count)], [1e-3] * count, [make(i, **change) for i in range(count)])
    return heard


class Traffic(unittest.TestCase):
    def faults(self, **changes):
        return judge(traffic(**changes), False)[1]

    def test_good_messages_have_no_fault(self):
        lines, faults = judge(traffic(), False)
        self.assertEqual(faults, [])
        self.assertRegex("\n".join(lines), r"ROBOT_STATE +500 +1\.0")

    def test_each_mistake_is_named(self):
        for channel, change, text in (
            ("ROBOT_STATE", None, "required"),
            ("ROBOT_STATE", {"position": [500.0, 100.0, 400.0]}, "in mm"),
            ("ROBOT_STATE", {"quaternion": [0, 0, 0, 0.5]}, "w first"),
            ("ROBOT_STATE", {"twist": [0, 0.05, 0, 0, 0, 0]}, "twist says"),
            ("ROBOT_STATE", {"twist": [float("nan")] * 6}, "not finite"),
            ("FT_WRENCH", {"wrench": [1.0, 2, 3, 4, 5, 6]}, "equal readings"),
            ("FT_WRENCH", {"wrench": [9e3, 2, 3, 4, 5, 6]}, "up to 5000 N"),
            ("IMU", {"acceleration": [0, 0, 1.0]}, "in g"),
            ("IMU", {"acceleration": [0, 0, 0.01]}, "without gravity"),
        ):
            faults = self.faults(**{channel: change})
            self.assertEqual(len(faults), 1, (channel, change, faults))
            self.assertIn(channel, faults[0])
            self.assertIn(text, faults[0])

    def test_slow_old_and_doubled_senders(self):
        heard = traffic()
        heard["FT_WRENCH"].times = [10 * t for t in heard["FT_WRENCH"].times]
        heard["IMU"].ages = [30.0] * len(heard["IMU"].ages)
        heard["ROBOT_STATE"].messages[5].session = 2
        faults = " | ".join(judge(heard, False)[1])
        for text in ("100 Hz; allowed: 200 Hz or more", "30 s behind", "2 senders"):
            self.assertIn(text, faults)
        self.assertEqual(judge(heard, True)[1], ["ROBOT_STATE: 2 senders; allowed: one"])

    def test_a_clock_that_differs_little_is_remarked(self):
        heard = traffic()
        heard["IMU"].ages = [-1.5] * len(heard["IMU"].ages)
        lines, faults = judge(heard, False)
        self.assertEqual(faults, [])
        self.assertIn("by -1.5 s", "\n".join(lines))

    def test_an_inertial_unit_is_optional_and_other_channels_are_listed(self):
        heard = traffic(IMU=None)
        heard["ROBOT_STAT"] = Heard("ROBOT_STAT", undecodable=4)
        lines, faults = judge(heard, False)
        self.assertEqual(faults, [])
        self.assertIn("ROBOT_STAT (4)", lines[-1])


class Geometry(unittest.TestCase):
    def test_cells_are_about_cubic_and_keep_the_limit(self):
        self.assertEqual(cells_of(np.array([0.5, 0.06, 0.06]), 200), [10, 1, 1])
        self.assertEqual(cells_of(np.array([0.5, 0.06, 0.06]), 650), [12, 2, 2])
        self.assertEqual(cells_of(np.array([0.06, 0.06, 0.06]), 200), [2, 2, 2])
        random = np.random.default_rng(3)
        for _ in range(50):
            size = random.uniform(0.02, 0.5, 3)
            cells = np.array(cells_of(size, 650))
            self.assertLessEqual(np.prod(2 * cells + 1), 650)
            edges = size / cells
            self.assertLess(edges[cells > 1].max(initial=0), 3 * edges.max())

    def test_boxes_of_faces(self):
        lower, upper = np.zeros(3), np.array([0.5, 0.06, 0.06])
        self.assertEqual(face_box(lower, upper, "x-", 0.0), {"lower": [0, 0, 0], "upper": [0, 0.06, 0.06]})
        self.assertEqual(face_box(lower, upper, "x+", 0.05), {"lower": [0.45, 0, 0], "upper": [0.5, 0.06, 0.06]})
        self.assertEqual(face_box(lower, upper, "z+", 0.01), {"lower": [0, 0, 0.05], "upper": [0.5, 0.06, 0.06]})

    def test_the_controlled_point_is_on_the_upper_side(self):
        self.assertEqual(controlled_point(box_surface([0.5, 0.06, 0.06])), [0.25, 0.03, 0.06])


class Bus:
    """Delivers messages of an arm that executes `follows` times the commanded velocity; it is also to turn about x by 0.05 rad/s
    and turns by `turns` times that."""

    def __init__(self, follows, turns):
        self.callbacks, self.time, self.position, self.follows = {}, 0, np.array([0.5, 0.0, 0.4]), follows
        self.velocity, self.turn, self.turns = np.zeros(3), 0.0, turns

    def subscribe(self, channel, callback):
        self.callbacks[channel] = callback

    def run(self, seconds):
        for _ in range(int(round(seconds / 0.002))):
            self.time += 2000
            self.callbacks["TWIST_COMMAND"](SimpleNamespace(valid=1, twist=[*self.velocity, self.velocity[2] * 5, 0, 0]))
            moved = self.follows @ self.velocity
            self.position = self.position + 0.002 * moved
            self.turn += 0.002 * self.turns * 5 * self.velocity[2]
            self.callbacks["ROBOT_STATE"](SimpleNamespace(utime=10**15 + self.time, position=self.position.tolist(),
                                                          quaternion=[np.cos(self.turn / 2), np.sin(self.turn / 2), 0, 0],
                                                          twist=[*moved, 0, 0, 0]))
        left = 0.005 - (self.position - [0.5, 0.0, 0.4])
        self.velocity = np.array([0, 0, 0.01 if left[2] > 0 else 0.0])
        self.callbacks["FEATURE"](SimpleNamespace(value=self.position.tolist(), error=[0, 0, left[2]], error_count=3, revision=1))


def steered(follows, turns=1.0, allowed=1e-3):
    bus = Bus(np.array(follows, float), turns)
    client = SimpleNamespace(control=bus, target=lambda kind, values: None, state=lambda: "active")
    steering = Steering(client)
    steering.wait_for_value()
    steering.move([0.5, 0.0, 0.405], 1e-3, 20.0, lambda: compare(steering, allowed, 0.01))
    return steering


class FirstMotion(unittest.TestCase):
    def test_what_was_commanded_is_the_integral_of_the_velocity(self):
        steering = steered(np.eye(3))
        self.assertGreater(steering.measured[2], 0.004)
        np.testing.assert_allclose(steering.commanded, steering.measured, atol=1e-4)

    def test_an_arm_that_moves_otherwise_is_stopped_within_millimetres(self):
        for follows, turns, text in ((-np.eye(3), 1, "frame and sign"), (np.zeros((3, 3)), 1, "does not follow"),
                                     ([[1, 0, 0], [0, 0, 1], [0, 1, 0]], 1, "frame and sign"), (4 * np.eye(3), 1, "frame and sign"),
                                     (0.4 * np.eye(3), -3, "frame and sign")):
            with self.assertRaisesRegex(InputError, text) as caught:
                steered(follows, turns)
            self.assertIn("stopped", str(caught.exception))


if __name__ == "__main__":
    unittest.main()
