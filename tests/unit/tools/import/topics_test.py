"""MCAP files and ROS 2 bags to messages, and what is wrong with them. Where mcap and rosbags are not installed only the remedy is tested."""

import importlib.util
import json
import unittest

from support import ImportTest

import yaml

from palpate_import.message_paths import ABSENT, getter, leaves

INSTALLED = all(importlib.util.find_spec(name) for name in ("mcap", "rosbags"))
WRENCH = "/wrist/wrench"
STATE = "/franka_robot_state_broadcaster/robot_state"
# As franka_ros2 defines it, without what is not imported.
FRANKA = """std_msgs/Header header
sensor_msgs/JointState measured_joint_state
geometry_msgs/PoseStamped o_t_ee
geometry_msgs/PoseStamped f_t_ee
"""


class Paths(unittest.TestCase):
    def test_take_members_elements_and_named_elements(self):
        message = {
            "header": {"stamp": {"sec": 2, "nanosec": 5}},
            "name": ["b", "a"],
            "position": [1.5, 2.5],
            "text": "x",
            "w": {"x": 3},
        }
        for path, value in [("w.x", 3), ("position[1]", 2.5), ("position[name=a]", 2.5), ("position[2]", ABSENT), ("w.y", ABSENT),
                            ("position[name=c]", ABSENT), ("text[0]", ABSENT), ("w.x.y", ABSENT)]:  # fmt: skip
            self.assertEqual(getter(path)(message), value, path)
        self.assertEqual(list(leaves(message)), ["header.stamp", "position[0]", "position[1]", "w.x"])
        for path in ("a[", "a[x]", "]", "a[1"):
            with self.assertRaises(ValueError):
                getter(path)


@unittest.skipIf(INSTALLED, "mcap and rosbags are installed")
class Remedies(ImportTest):
    def test_are_named(self):
        (self.folder / "in.mcap").write_bytes(b"\x89MCAP0\r\n")
        (self.folder / "bag").mkdir()
        (self.folder / "bag/metadata.yaml").write_text("")
        for name, package in (("in.mcap", "mcap"), ("bag", "rosbags")):
            text = self.refused(self.folder / name, "--format", "imu", "--channel", "IMU", "--topic", "/imu")
            self.assertIn(f"need the Python package {package}: ", text)
            self.assertIn("pip install mcap rosbags", text)


@unittest.skipUnless(INSTALLED, "no Python packages mcap and rosbags; tools/packaging/install-worlds installs them")
class Topics(ImportTest):
    def setUp(self):
        super().setUp()
        from rosbags.typesys import Stores, get_types_from_msg, get_typestore

        self.store = get_typestore(Stores.ROS2_HUMBLE)
        self.store.register(get_types_from_msg(FRANKA, "franka_msgs/msg/FrankaRobotState"))

    def made(self, kind, **fields):
        return self.store.types[kind](**fields)

    def header(self, nanoseconds):
        stamp = self.made("builtin_interfaces/msg/Time", sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9)
        return self.made("std_msgs/msg/Header", stamp=stamp, frame_id="")

    def pose(self, nanoseconds, position, wxyz):
        point = self.made("geometry_msgs/msg/Point", **dict(zip("xyz", position)))
        turn = self.made("geometry_msgs/msg/Quaternion", **dict(zip("wxyz", wxyz)))
        pose = self.made("geometry_msgs/msg/Pose", position=point, orientation=turn)
        return self.made("geometry_msgs/msg/PoseStamped", header=self.header(nanoseconds), pose=pose)

    def wrench(self, nanoseconds, values):
        vectors = [self.made("geometry_msgs/msg/Vector3", **dict(zip("xyz", values[at : at + 3]))) for at in (0, 3)]
        both = self.made("geometry_msgs/msg/Wrench", force=vectors[0], torque=vectors[1])
        return self.made("geometry_msgs/msg/WrenchStamped", header=self.header(nanoseconds), wrench=both)

    def franka(self, nanoseconds):
        import numpy as np

        joints = self.made("sensor_msgs/msg/JointState", header=self.header(nanoseconds), name=[f"j{i}" for i in range(7)],
                           position=np.arange(7.0), velocity=0.1 * np.arange(7), effort=10.0 * np.arange(7))  # fmt: skip
        return self.made(
            "franka_msgs/msg/FrankaRobotState",
            header=self.header(nanoseconds),
            measured_joint_state=joints,
            o_t_ee=self.pose(nanoseconds, (1, 2, 3), (0, 1, 0, 0)),
            f_t_ee=self.pose(nanoseconds, (0, 0, 0.5), (1, 0, 0, 0)),
        )

    def bag(self, storage, topics):
        """topics: {topic: (type, [(received, ns, message)])}."""
        from rosbags.rosbag2 import StoragePlugin, Writer

        path = self.folder / f"bag_{storage}"
        with Writer(path, version=9, storage_plugin=StoragePlugin[storage]) as writer:
            connections = {
                topic: writer.add_connection(topic, kind, typestore=self.store) for topic, (kind, _) in topics.items()
            }
            for received, topic, message in sorted(
                ((r, t, m) for t, (_, ms) in topics.items() for r, m in ms), key=lambda row: row[0]
            ):
                kind = topics[topic][0]
                writer.write(connections[topic], received, self.store.serialize_cdr(message, kind))
        return path

    def words(self, path, *more):
        columns = {f"{kind[0]}{axis}": f"wrench.{kind}.{axis}" for kind in ("force", "torque") for axis in "xyz"}
        return [path, "--format", "force_torque", "--channel", "FT_WRENCH", "--topic", WRENCH, *more,
                *(word for field, column in columns.items() for word in ("--column", f"{field}={column}"))]  # fmt: skip

    def test_bags_of_both_storages_as_folder_and_as_file(self):
        times = [1_700_000_000_123_456_500 + i * 10**7 for i in range(3)]
        values = [[1 / (3 + i + k) for k in range(6)] for i in range(3)]
        topics = {WRENCH: ("geometry_msgs/msg/WrenchStamped", [(t + 2500, self.wrench(t, v)) for t, v in zip(times, values)])}
        for storage, suffix in (("SQLITE3", "db3"), ("MCAP", "mcap")):
            folder = self.bag(storage, topics)
            for path in (folder, next(folder.glob(f"*.{suffix}"))):
                stamped = self.imported(*self.words(path, "--time-column", "header.stamp"))["FT_WRENCH"]
                self.assertEqual([utime for utime, _ in stamped], [(t + 500) // 1000 for t in times], path)
                self.assertEqual([list(m.wrench) for _, m in stamped], values, path)
                received = self.imported(*self.words(path))["FT_WRENCH"]
                self.assertEqual(received[0][0], (times[0] + 3000) // 1000)
        self.log.unlink()
        for words, expected in [(self.words(folder, "--topic", "/no"), f"no topic '/no'; the topics are {WRENCH}"),
                                ([*self.words(folder), "--column", "fx=wrench.force.q"], "no column 'wrench.force.q'; the columns are header.stamp, wrench.force.x"),
                                ([folder, "--format", "imu", "--channel", "IMU"], "IMU: has no topic; allowed: " + WRENCH)]:  # fmt: skip
            self.assertIn(expected, self.refused(*words, code=78 if "has no topic" in expected else 1))
        (folder / "metadata.yaml").write_text("rosbag2_bagfile_information: {}\n")
        self.assertIn(f"{folder}: ", self.refused(*self.words(folder)))

    def test_franka_ros2(self):
        topics = {STATE: ("franka_msgs/msg/FrankaRobotState", [(10**9 + i, self.franka(10**9 + i * 10**6)) for i in range(2)])}
        made = self.imported(self.bag("MCAP", topics), "--preset", "franka_ros2")["ROBOT_STATE"]
        utime, state = made[1]
        self.assertEqual((utime, state.joint_count, state.q[6], state.tau[6]), (1001000, 7, 6, 60))
        for got, expected in zip([*state.position, *state.quaternion], [1, 2, 3.5, 0, 1, 0, 0]):  # half a turn about x
            self.assertAlmostEqual(got, expected, 14)

    def json_file(self, name, rows, encoding="json"):
        from mcap.writer import CompressionType, Writer

        with open(self.folder / name, "wb") as file:
            writer = Writer(file, compression=CompressionType.ZSTD)
            writer.start()
            schema = writer.register_schema("wrench", "jsonschema", b"{}")
            channel = writer.register_channel(WRENCH, encoding, schema)
            for nanoseconds, row in rows:
                writer.add_message(channel, log_time=nanoseconds, data=json.dumps(row).encode(), publish_time=nanoseconds)
            writer.finish()
        return self.folder / name

    def test_json_in_mcap(self):
        rows = [(10**9 + i * 10**6, {"t_ms": 5 + i, "side": side, "wrench": {"force": {"x": i, "y": 0.1, "z": -1e-3}, "torque": [1, 2, 3]}})
                for i, side in enumerate(["left", "right", "left"])]  # fmt: skip
        path = self.json_file("in.mcap", rows)
        torque = [word for i, axis in enumerate("xyz") for word in ("--column", f"t{axis}=wrench.torque[{i}]")]
        made = self.imported(*self.words(path), *torque)["FT_WRENCH"]
        self.assertEqual(made[2][0], 1002000)
        self.assertEqual(list(made[2][1].wrench), [2, 0.1, -1e-3, 1, 2, 3])
        made = self.imported(*self.words(path), *torque, "--time-column", "t_ms", "--time-unit", "ms", "--where", "side=left")[
            "FT_WRENCH"
        ]
        self.assertEqual([utime for utime, _ in made], [5000, 7000])
        self.log.unlink()
        del rows[1][1]["wrench"]["force"]["y"]
        path = self.json_file("in.mcap", rows)
        self.assertIn(f"in.mcap:{WRENCH}: message 2: wrench.force.y is absent", self.refused(*self.words(path), *torque))
        path = self.json_file("in.mcap", rows, "protobuf")
        self.assertIn("encoding 'protobuf'; allowed: json, cdr", self.refused(*self.words(path)))
        path.write_bytes(path.read_bytes()[:300])
        self.assertIn("in.mcap: ", self.refused(*self.words(path)))

    def test_files_of_both_kinds_in_one_log(self):
        folder = self.bag("SQLITE3", {WRENCH: ("geometry_msgs/msg/WrenchStamped", [(10**9, self.wrench(10**9, range(6)))])})
        self.write("t,ax,ay,az\n0.5,1,2,3\n", "imu.csv")
        columns = {f"f{axis}": f"wrench.force.{axis}" for axis in "xyz"} | {
            f"t{axis}": f"wrench.torque.{axis}" for axis in "xyz"
        }
        streams = [{"topic": WRENCH, "channel": "FT_WRENCH", "format": "force_torque", "columns": columns},
                   {"topic": "/no", "channel": "IMU_1", "format": "imu", "optional": True}]  # fmt: skip
        files = [
            {"file": folder.name, "streams": streams},
            {"file": "imu.csv", "start": 1, "streams": [{"channel": "IMU", "format": "imu"}]},
        ]
        self.write(yaml.safe_dump({"files": files}), "map.yaml")
        made = self.imported("--map", self.folder / "map.yaml")
        self.assertEqual({name: events[0][0] for name, events in made.items()}, {"FT_WRENCH": 1000000, "IMU": 1500000})
        self.assertIn("without IMU_1: no /no", self.said)


if __name__ == "__main__":
    unittest.main(verbosity=2)
