"""The simulator's sensors really have the errors that a drawn set-up's truth states, by a computation of its own.

usage: simulator_test.py BINARIES SOURCE
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

BINARIES, SOURCE = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path[:0] = [str(BINARIES.parent / "python")]

import numpy as np  # noqa: E402
from scipy.interpolate import interp1d  # noqa: E402
from scipy.spatial.transform import Rotation  # noqa: E402

import palpate  # noqa: E402

SEED = 1001
G = np.array([0, 0, -9.81])
# Two poses at rest and a turn about two axes between them; without noise that does not average out.
MOTION = ("motion={start_delay: 1, poses: [{name: turned, move: 2, hold: 1.5, translation: [0, 0.05, 0.05], "
          "rotation_deg: [40, 25, 0]}]}")  # fmt: skip


def rotation(values):
    w, x, y, z = values
    return Rotation.from_quat([x, y, z, w])


def stamps(messages):
    return 1e-6 * np.array([message.utime for message in messages])


class Simulated(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        draw = SOURCE / "tools/lab/hidden_setups/draw_setup"
        subprocess.run([draw, "--seed", str(SEED), "--output", cls.folder / "drawn"], check=True, timeout=60)
        cls.truth = json.loads((cls.folder / "drawn/truth.json").read_text())
        done = subprocess.run([BINARIES / "palpate-sim", cls.folder / "drawn/scene.yaml", "--record", cls.folder / "run", "--set",
                               MOTION, "--set", "camera=null", "--duration", "4.5"], capture_output=True, text=True, timeout=500)
        if done.returncode != 0:
            raise RuntimeError(done.stdout + done.stderr)
        log = palpate.read_log(cls.folder / "run/sensors.log")
        cls.robot, cls.wrench, cls.imu = (list(log[name]) for name in ("ROBOT_STATE", "FT_WRENCH", "IMU"))
        cls.arrivals = {}
        for event in palpate.EventLog(cls.folder / "run/sensors.log"):
            cls.arrivals.setdefault(event.channel, []).append(1e-6 * event.utime)

    def flange(self, time):
        """R_WE at the state nearest to a time, s."""
        at = int(np.abs(stamps(self.robot) - time).argmin())
        return rotation(self.robot[at].quaternion)

    def at_rest(self, messages, begin, end):
        times = stamps(messages)
        return [message for message, time in zip(messages, times) if begin < time < end]

    def test_wrenches_at_rest_are_those_of_the_true_payload(self):
        payload = self.truth["payload"]
        center, bias = np.array(payload["center_of_mass"]), np.array(self.truth["bias"])
        R_ES = rotation(self.truth["sensor_in_flange"]["quaternion"])
        for begin, end in ((0.3, 0.95), (3.4, 4.4)):
            mean = np.mean([message.wrench for message in self.at_rest(self.wrench, begin, end)], axis=0)
            force = -payload["mass"] * (self.flange(0.5 * (begin + end)) * R_ES).inv().apply(G)
            expected = np.concatenate([force, np.cross(center, force)]) + bias
            np.testing.assert_allclose(mean[:3], expected[:3], atol=0.012)  # noise 25 mN, 600 samples, steps of 12.5 mN
            np.testing.assert_allclose(mean[3:], expected[3:], atol=0.001)

    def test_the_inertial_unit_is_turned(self):
        R_EI, bias = rotation(self.truth["imu_in_flange"]["quaternion"]), np.array(self.truth["imu_bias"])
        for begin, end in ((0.3, 0.95), (3.4, 4.4)):
            messages = self.at_rest(self.imu, begin, end)
            mean = np.mean([message.acceleration for message in messages], axis=0)
            expected = -(self.flange(0.5 * (begin + end)) * R_EI).inv().apply(G) + bias[:3]
            np.testing.assert_allclose(mean, expected, atol=0.012)  # noise 0.03 m/s^2, 200 samples
            rate = np.mean([message.angular_velocity for message in messages], axis=0)
            np.testing.assert_allclose(rate, bias[3:], atol=0.001)

    def test_stamps_are_late(self):
        """The delay at which the inertial unit's rates fit those of the flange, and the wrenches' weight fits its rotation."""
        times = stamps(self.robot)
        R_WE = [rotation(message.quaternion) for message in self.robot]
        R_EI = rotation(self.truth["imu_in_flange"]["quaternion"])
        rates = np.array([(R * R_EI).inv().apply(message.twist[3:]) for R, message in zip(R_WE, self.robot)])
        payload, R_ES = self.truth["payload"], rotation(self.truth["sensor_in_flange"]["quaternion"])
        weights = np.array([-payload["mass"] * (R * R_ES).inv().apply(G) for R in R_WE])
        bias, of_imu = np.array(self.truth["bias"]), np.array(self.truth["imu_bias"])
        for name, messages, model, values, tolerance in (
            ("imu", self.imu, rates, [np.array(m.angular_velocity) - of_imu[3:] for m in self.imu], 0.001),
            ("force_torque", self.wrench, weights, [np.array(m.wrench[:3]) - bias[:3] for m in self.wrench], 0.003),
        ):
            predicted, at, values = interp1d(times, model, axis=0), stamps(messages), np.array(values)
            inside = (at > 1.1) & (at < 2.9)
            delays = np.arange(-0.01, 0.05, 0.0005)
            misfits = [np.square(values[inside] - predicted(at[inside] - delay)).sum() for delay in delays]
            found = delays[int(np.argmin(misfits))]
            self.assertAlmostEqual(found, self.truth["stamp_delay"][name], delta=tolerance, msg=name)

    def test_no_message_states_a_time_to_come(self):
        for channel, messages in (("FT_WRENCH", self.wrench), ("IMU", self.imu), ("ROBOT_STATE", self.robot)):
            late = np.array(self.arrivals[channel]) - stamps(messages)
            self.assertGreaterEqual(late.min(), 0, channel)
            self.assertLess(late.max(), 0.02, channel)

    def test_no_message_states_what_was_drawn(self):
        """Of the channels that set-up programs read, none carries the truth: no number of it is in any message's floats."""
        names = {event.channel for event in palpate.EventLog(self.folder / "run/sensors.log")}
        self.assertFalse([name for name in names if name.startswith("TRUTH")], names)
        drawn = [np.float64(row["value"]).tobytes()[::-1] for row in self.truth["drawn"]]
        for event in palpate.EventLog(self.folder / "run/sensors.log"):
            for value in drawn:
                self.assertNotIn(value, event.data)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
