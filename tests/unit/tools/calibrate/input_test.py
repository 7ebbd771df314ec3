"""Descriptions of CSV files: what is wrong is named with file, key and what is allowed."""

import pathlib
import tempfile
import unittest

import support  # noqa: F401
import numpy as np

from palpate_calibrate.plan import Room, plan_poses
from palpate_calibrate.table_input import read_description
from palpate_common.input_error import InputError
from palpate_common.section import read_section

TABLE = "t,x,y,z,qw,qx,qy,qz,fx,fy,fz,tx,ty,tz\n" + "".join(f"{i}000,0,0,0,1,0,0,0,0,0,{i},0,0,0\n" for i in range(5))
DESCRIPTION = """
pose: {file: a.csv, quaternion: [qw, qx, qy, qz], position: [x, y, z], time: t, time_unit: ms}
wrench: {force: [fx, fy, fz], torque: [tx, ty, tz]}
"""


class Input(unittest.TestCase):
    def read(self, description, table=TABLE):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "a.csv").write_text(table)
            (folder / "a.yaml").write_text(description)
            return read_description(read_section(folder / "a.yaml"), folder)

    def test_units_and_columns(self):
        recording = self.read(DESCRIPTION).recording
        self.assertFalse(recording.at_rest)
        np.testing.assert_allclose(recording.pose.time, [0, 1, 2, 3, 4])
        np.testing.assert_allclose(recording.wrench.values[:, 2], [0, 1, 2, 3, 4])
        np.testing.assert_allclose(recording.pose.values[0, 3:], np.eye(3).ravel())
        self.assertTrue(self.read(DESCRIPTION.replace(", time: t, time_unit: ms", "")).recording.at_rest)

    def test_wrong_descriptions(self):
        for old, new, expected in (
            ("time_unit: ms", "time_unit: hours", "pose.time_unit: hours; allowed: s, ms, us, ns"),
            ("qw, ", "", "pose.quaternion: .* names of 4 columns"),
            ("torque:", "torqe:", "wrench.torque: is absent; required"),
            ("position: [x, y, z], ", "", "pose.position: is absent; required for poses in motion"),
            ("pose:", "posse: 1\npose:", "posse: is unknown; allowed: "),
            ("pose:", "gravity: [0, 0, down]\npose:", "gravity: .* 3 numbers from -100 to 100"),
        ):
            with self.assertRaisesRegex(InputError, r"a.yaml(:\d+)?: " + expected):
                self.read(DESCRIPTION.replace(old, new, 1))

    def test_wrong_tables(self):
        for table, expected in (
            (TABLE.replace("fx", "f_x"), "a.csv: no column fx; it has: t, x"),
            (TABLE.replace("2000,0", "2000,zero"), "a.csv, line 4, column x: zero; allowed: a number"),
            (TABLE.replace("3000,0,0,0,1", "3000,0,0,0,2"), "a.csv, line 5: a quaternion of length 2; allowed: 1"),
            ("t\n", "a.csv: no rows"),
        ):
            with self.assertRaisesRegex(InputError, expected):
                self.read(DESCRIPTION, table)


class Plan(unittest.TestCase):
    def test_poses_stay_in_the_room_and_beat_as_many_random_ones(self):
        start = np.array([0.6, 0, 0.5])
        room = Room(start, np.eye(3), start - 0.05, start + 0.05, np.radians(60))
        plan = plan_poses(room, 8, 1.0, np.array([0, 0, 0.1]), np.eye(3), support.GRAVITY, most=100)
        self.assertEqual(len(plan.positions), 9)  # the first again at the end
        for position, rotation in zip(plan.positions, plan.rotations):
            self.assertTrue(room.holds(position))
            self.assertLessEqual(np.degrees(np.arccos((np.trace(rotation) - 1) / 2)), 60 + 1e-6)
        others = [plan_poses(room, 8, 1.0, np.array([0, 0, 0.1]), np.eye(3), support.GRAVITY, most=8, seed=seed) for seed in (2, 3, 4)]
        for other in others:
            self.assertLess(np.log(plan.expected["sensor_rotation"]).sum(), np.log(other.expected["sensor_rotation"]).sum())


if __name__ == "__main__":
    unittest.main()
