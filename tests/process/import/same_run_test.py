"""One run as LCM log, MCAP file, ROS 2 bag and CSV of a UR arm: the same replay and the same fit.

usage: same_run_test.py BINARIES SOURCE
"""

from __future__ import annotations

import csv
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from typing import Any

import numpy as np
import palpate
from palpate.messages import ft_wrench_t, robot_state_t
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from scipy.spatial.transform import Rotation

BIN, SOURCE = (Path(sys.argv.pop(1)).resolve() for _ in range(2))
CONFIGURATION = SOURCE / "rt/config/examples/bar_long_soft.yaml"
MOTION = ("motion={start_delay: 0.5, poses: [{move: 0.6, hold: 0.9, translation: [0, 0, -0.06]}, "
          "{move: 0.6, hold: 0.9, translation: [0, 0.05, 0.03], rotation_deg: [15, 0, 0]}]}")  # fmt: skip
JOINTS = 6  # of a UR arm
STATE = """std_msgs/Header header
geometry_msgs/Pose pose
geometry_msgs/Twist twist
float64[6] q
float64[6] dq
"""
QUATERNION = ("qw", "qx", "qy", "qz")
TWIST = ("vx", "vy", "vz", "wx", "wy", "wz")
WRENCH = ("fx", "fy", "fz", "tx", "ty", "tz")


def program(name: str, *words: Any) -> str:
    done = subprocess.run([str(BIN / name), *map(str, words)], capture_output=True, text=True, timeout=240)
    if done.returncode != 0:
        raise AssertionError(f"{name} {' '.join(map(str, words))}: {done.stderr}")
    return done.stdout


class Row:
    """Robot and wrench at one time."""

    def __init__(self, state: Any, wrench: Any) -> None:
        self.utime = int(state.utime)
        self.position = np.array(state.position)
        self.turn = Rotation.from_quat(np.roll(state.quaternion, -1))
        self.twist = np.array(state.twist)
        self.q, self.dq = np.array(state.q[:JOINTS]), np.array(state.dq[:JOINTS])
        self.wrench = np.array(wrench.wrench)

    @property
    def wxyz(self) -> np.ndarray:
        return np.roll(self.turn.as_quat(), 1)


def recorded(folder: Path) -> list[Row]:
    """A run of palpate-sim at the times at which robot and wrench have been read together."""
    program("palpate-sim", SOURCE / "sim/scenes/bar_long_soft_six_poses.yaml", "--record", folder, "--set", MOTION)
    states, wrenches = [], {}
    for event in palpate.EventLog(folder / "sensors.log"):
        if event.channel == "ROBOT_STATE":
            states.append(palpate.decode(event.channel, event.data))
        elif event.channel == "FT_WRENCH":
            message = palpate.decode(event.channel, event.data)
            wrenches[message.utime] = message
    return [Row(state, wrenches[state.utime]) for state in states if state.utime in wrenches]


def as_lcm(rows: list[Row], file: Path) -> None:
    log = palpate.EventLogWriter(file)
    for number, row in enumerate(rows, 1):
        state = robot_state_t()
        state.utime, state.joint_count = row.utime, JOINTS
        state.position, state.quaternion, state.twist = list(row.position), list(row.wxyz), list(row.twist)
        state.q = [*row.q, *[0.0] * (16 - JOINTS)]
        state.dq = [*row.dq, *[0.0] * (16 - JOINTS)]
        wrench = ft_wrench_t()
        wrench.utime, wrench.wrench = row.utime, list(row.wrench)
        for channel, message in (("ROBOT_STATE", state), ("FT_WRENCH", wrench)):
            message.seq, message.session = number, 1
            log.write(row.utime, channel, message.encode())
    log.close()


def as_ur_csv(rows: list[Row], file: Path) -> None:
    """As startFileRecording() of ur_rtde writes it."""
    six = range(6)
    names = ["timestamp"]
    for name in ("actual_TCP_pose", "actual_TCP_speed", "actual_q", "actual_qd", "ft_raw_wrench"):
        names += [f"{name}_{i}" for i in six]
    with open(file, "w", newline="") as text:
        writer = csv.writer(text)
        writer.writerow(names)
        for row in rows:
            numbers = [row.position, row.turn.as_rotvec(), row.twist, row.q, row.dq, -row.wrench]
            writer.writerow([repr(row.utime / 1e6), *(repr(float(v)) for part in numbers for v in part)])


def as_bag(rows: list[Row], folder: Path) -> None:
    store = get_typestore(Stores.ROS2_HUMBLE)
    store.register(get_types_from_msg(STATE, "lab_msgs/msg/State"))

    def made(kind: str, **fields: Any) -> Any:
        return store.types[kind](**fields)

    def vector(values: Any) -> Any:
        return made("geometry_msgs/msg/Vector3", **dict(zip("xyz", map(float, values))))

    with Writer(folder, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        kinds = {"/state": "lab_msgs/msg/State", "/wrench": "geometry_msgs/msg/WrenchStamped"}
        topics = {topic: writer.add_connection(topic, kind, typestore=store) for topic, kind in kinds.items()}
        for row in rows:
            seconds, rest = divmod(row.utime, 10**6)
            stamp = made("builtin_interfaces/msg/Time", sec=seconds, nanosec=1000 * rest)
            header = made("std_msgs/msg/Header", stamp=stamp, frame_id="")
            position = made("geometry_msgs/msg/Point", **dict(zip("xyz", map(float, row.position))))
            turn = made("geometry_msgs/msg/Quaternion", **dict(zip("wxyz", map(float, row.wxyz))))
            pose = made("geometry_msgs/msg/Pose", position=position, orientation=turn)
            twist = made("geometry_msgs/msg/Twist", linear=vector(row.twist[:3]), angular=vector(row.twist[3:]))
            wrench = made("geometry_msgs/msg/Wrench", force=vector(row.wrench[:3]), torque=vector(row.wrench[3:]))
            messages = {
                "/state": made(kinds["/state"], header=header, pose=pose, twist=twist, q=row.q, dq=row.dq),
                "/wrench": made(kinds["/wrench"], header=header, wrench=wrench),
            }
            for topic, message in messages.items():
                writer.write(topics[topic], 1000 * row.utime, store.serialize_cdr(message, kinds[topic]))


def description(file: Path, time: dict[str, str], topics: list[str], state: dict[str, str], wrench: dict[str, str]) -> dict[str, Any]:
    streams = [{"channel": "ROBOT_STATE", "format": "robot_state", "topic": topics[0], "columns": state},
               {"channel": "FT_WRENCH", "format": "force_torque", "topic": topics[1], "columns": wrench}]  # fmt: skip
    return {"files": [{"file": str(file), **time, "streams": streams}]}


class SameRun(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        cls.folder = Path(scratch.name)
        rows = recorded(cls.folder / "run")
        assert len(rows) > 1500, len(rows)
        cls.logs = {"lcm": cls.folder / "lcm.log"}
        as_lcm(rows, cls.logs["lcm"])
        as_ur_csv(rows, cls.folder / "ur.csv")
        cls.imported("ur", cls.folder / "ur.csv", "--preset", "ur_rtde")
        as_bag(rows, cls.folder / "bag")
        joints = {f"{name}{i + 1}": f"{name}[{i}]" for name in ("q", "dq") for i in range(JOINTS)}
        parts = ("force", "torque")
        cls.described("bag", description(
            cls.folder / "bag", {"time_column": "header.stamp"}, ["/state", "/wrench"],
            {**{f"p{a}": f"pose.position.{a}" for a in "xyz"}, **{f"q{a}": f"pose.orientation.{a}" for a in "wxyz"},
             **{f"v{a}": f"twist.linear.{a}" for a in "xyz"}, **{f"w{a}": f"twist.angular.{a}" for a in "xyz"}, **joints},
            {f"{part[0]}{a}": f"wrench.{part}.{a}" for part in parts for a in "xyz"}))  # fmt: skip
        program("palpate-export", "mcap", cls.logs["lcm"], "--scene-rate", 0, "--output", cls.folder / "run.mcap", "--quiet")
        cls.described("mcap", description(
            cls.folder / "run.mcap", {"time_column": "utime", "time_unit": "us"}, ["ROBOT_STATE", "FT_WRENCH"],
            {**{f"p{a}": f"position[{i}]" for i, a in enumerate("xyz")}, **{n: f"quaternion[{i}]" for i, n in enumerate(QUATERNION)},
             **{n: f"twist[{i}]" for i, n in enumerate(TWIST)}, **joints},
            {n: f"wrench[{i}]" for i, n in enumerate(WRENCH)}))  # fmt: skip

    @classmethod
    def imported(cls, name: str, *words: Any) -> None:
        cls.logs[name] = cls.folder / f"{name}.log"
        done = subprocess.run([sys.executable, str(BIN / "palpate-import"), *map(str, words), "-o", str(cls.logs[name])],
                              capture_output=True, text=True, timeout=120)  # fmt: skip
        assert done.returncode == 0, done.stderr

    @classmethod
    def described(cls, name: str, content: dict[str, Any]) -> None:
        file = cls.folder / f"{name}.yaml"
        file.write_text(json.dumps(content))
        cls.imported(name, "--map", file)

    def replayed(self, name: str) -> palpate.Log:
        output = self.folder / f"{name}.replayed.log"
        program("palpate-replay", self.logs[name], "--config", CONFIGURATION, "--start", "--output", output)
        return palpate.read_log(output)

    def test_messages_agree(self) -> None:
        reference = palpate.read_log(self.logs["lcm"])
        for name in ("ur", "bag", "mcap"):
            log = palpate.read_log(self.logs[name])
            for channel in ("ROBOT_STATE", "FT_WRENCH"):
                with self.subTest(f"{name} {channel}"):
                    np.testing.assert_array_equal(log[channel].utime, reference[channel].utime)
            for field in ("position", "twist", "q", "dq", "quaternion"):
                a, b = getattr(log["ROBOT_STATE"], field), getattr(reference["ROBOT_STATE"], field)
                if field == "quaternion":  # of either sign
                    a = a * np.sign((a * b).sum(axis=1, keepdims=True))
                np.testing.assert_allclose(a, b, rtol=0, atol=1e-12, err_msg=f"{name} {field}")
            np.testing.assert_array_equal(log["FT_WRENCH"].wrench, reference["FT_WRENCH"].wrench)

    def test_replays_agree(self) -> None:
        reference = self.replayed("lcm")
        shape, reaction = reference["SHAPE"].positions, reference["ESTIMATE"].reaction
        self.assertGreater(len(shape), 300)
        self.assertGreater(np.linalg.norm(shape[-1] - shape[0], axis=-1).max(), 0.02)
        for name in ("bag", "mcap"):
            log = self.replayed(name)
            with self.subTest(name):
                np.testing.assert_array_equal(log["SHAPE"].positions, shape)
                np.testing.assert_array_equal(log["ESTIMATE"].reaction, reaction)
        # A rotation vector is another rounding of the rotation; positions of SHAPE are of single precision.
        log = self.replayed("ur")
        error = np.linalg.norm(log["SHAPE"].positions - shape, axis=-1)
        self.assertLess(error.mean(), 1e-9)
        self.assertLess(error.max(), 2 * np.spacing(np.float32(np.abs(shape).max())))
        np.testing.assert_allclose(log["ESTIMATE"].reaction, reaction, rtol=0, atol=1e-4)

    def test_fits_agree(self) -> None:
        reference = self.fitted("lcm")
        self.assertGreater(reference["young_modulus"], 20e3)
        for name in ("ur", "bag", "mcap"):
            with self.subTest(name):
                values = self.fitted(name)
                self.assertEqual(values.keys(), reference.keys())
                for key, value in values.items():
                    self.assertAlmostEqual(value, reference[key], delta=1e-9 * max(1, abs(value)), msg=key)

    def fitted(self, name: str) -> dict[str, float]:
        """Parameters without the name of their recording."""
        plan = self.folder / f"{name}.fit.yaml"
        plan.write_text(
            f"name: bar\nrecordings:\n  - {{kind: held_object, log: {self.logs[name]}, configuration: {CONFIGURATION}, "
            "sought: [bias], calm: {settle: 0.2, window: 0.2, every: 0.2}}\n"
        )
        results = self.folder / f"{name}.fit.json"
        program("palpate-fit", plan, "--json", results)
        (fit,) = json.loads(results.read_text())["fits"]
        return {key.split(".")[-1]: entry["value"] for key, entry in fit["parameters"].items()}


if __name__ == "__main__":
    unittest.main(verbosity=2)
