"""palpate-ros2 with a node by Fast DDS and one by Dust DDS: messages in both directions, byte for byte as
rosbags encodes them; malformed ones; a bag.
"""

from __future__ import annotations

import math
import random
import re
import tempfile
import time
import unittest
from pathlib import Path
from typing import Any, Callable

from fast_node import BIN, SOURCE, STORE, FastNode, header, message, utime_of, wall_clock_us  # first: finds the next

# isort: split
import drake
import numpy as np
import palpate
from live_run import Program, private_urls
from palpate.messages import compensated_wrench_t, health_t, robot_state_t, shape_mesh_t, shape_t
from pydrake.lcm import DrakeLcm
from rosbags.rosbag2 import Reader, Writer
from steered_arm import wait_for

WRENCH, POSE = "geometry_msgs/msg/WrenchStamped", "geometry_msgs/msg/PoseStamped"
MARKER = "visualization_msgs/msg/Marker"
IMU, CLOUD, STRING = "sensor_msgs/msg/Imu", "sensor_msgs/msg/PointCloud2", "std_msgs/msg/String"
DIAGNOSTICS = "diagnostic_msgs/msg/DiagnosticArray"
INPUTS = {"rt/ft": WRENCH, "rt/imu": IMU, "rt/points": CLOUD, "rt/say": STRING}
OUTPUTS = {"rt/out/wrench": WRENCH, "rt/out/hand": POSE, "rt/out/shape": MARKER, "rt/out/diagnostics": DIAGNOSTICS}
RELIABLE = ("rt/say", "rt/out/shape", "rt/out/diagnostics")


def zero(kind: Any) -> Any:
    """A message of fixed size, all of whose fields are zero."""
    return kind.decode(kind._get_packed_fingerprint() + bytes(65536))


def vector(kind: str, x: float, y: float, z: float) -> Any:
    return message(f"geometry_msgs/msg/{kind}", x=x, y=y, z=z)


def wrench(utime: int) -> Any:
    force, torque = vector("Vector3", 1.5, -2, 0.1), vector("Vector3", 0.3, 4, 5)
    values = message("geometry_msgs/msg/Wrench", force=force, torque=torque)
    return message(WRENCH, header=header(utime, "a frame of odd length"), wrench=values)


def imu(utime: int) -> Any:
    upright, unknown = message("geometry_msgs/msg/Quaternion", x=0.0, y=0.0, z=0.0, w=1.0), np.zeros(9)
    turn, acceleration = vector("Vector3", 0.1, 0.2, 0.3), vector("Vector3", 0, 0, 9.81)
    return message(
        IMU, header=header(utime, "imu"), orientation=upright, orientation_covariance=unknown, angular_velocity=turn,
        angular_velocity_covariance=unknown, linear_acceleration=acceleration, linear_acceleration_covariance=unknown,
    )  # fmt: skip


def cloud(utime: int, points: np.ndarray) -> Any:
    fields = [
        message("sensor_msgs/msg/PointField", name=name, offset=4 * i, datatype=7, count=1)
        for i, name in enumerate("xyz")
    ]
    data = np.frombuffer(points.astype("<f4").tobytes(), np.uint8)
    return message(
        CLOUD, header=header(utime, "camera"), height=1, width=len(points), fields=fields, is_bigendian=False,
        point_step=12, row_step=12 * len(points), data=data, is_dense=True,
    )  # fmt: skip


class Wire(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.domain = random.randint(1, 200)
        self.control, self.housekeeping = private_urls(2)
        (self.folder / "ros2.yaml").write_text(
            f"ros: {{domain: {self.domain}, interface: lo, most_age_ms: 1000}}\n"
            "wrench: {topic: ft, polarity: -1}\nimu: imu\ncloud: {topic: points}\nshape: {topic: out/shape}\n"
            "outputs: {wrench: out/wrench, hand_pose: out/hand, diagnostics: out/diagnostics}\n"
            "requests: {commands: say}\n"
            f"bus: {{control: '{self.control}', housekeeping: '{self.housekeeping}'}}\n"
        )
        words = [BIN / "palpate-ros2", "--config", self.folder / "ros2.yaml"]
        self.bridge = Program("palpate-ros2", words, self.folder)
        self.addCleanup(self.bridge.end)
        self.bridge.wait_for("waits for")
        self.bus, self.house = palpate.Bus(self.control), palpate.Bus(self.housekeeping)
        self.addCleanup(self.bus.close)
        self.addCleanup(self.house.close)
        self.heard: "dict[str, list[Any]]" = {}
        for channel in ("FT_WRENCH", "IMU"):
            self.heard[channel] = []
            self.bus.subscribe(channel, self.heard[channel].append)

    def start_node(self) -> FastNode:
        node = FastNode(self.domain)
        self.addCleanup(node.close)
        for what, topics in (("writer", INPUTS), ("reader", OUTPUTS)):
            for topic, name in topics.items():
                node.connect(what, topic, name, "reliable" if topic in RELIABLE else "stream")
        for topic in (*INPUTS, *OUTPUTS):
            node.wait_for_match(topic)
        return node

    def arrives(self, channel: str, send: Callable[[], None]) -> Any:
        """The first message of the channel, sent again until it arrives."""

        def has_arrived() -> bool:
            send()
            time.sleep(0.05)
            self.bus.drain()
            return bool(self.heard[channel])

        wait_for(has_arrived, channel)
        return self.heard[channel][-1]

    def publish(self) -> None:
        """One message of palpated's of each kind."""
        pose = zero(robot_state_t)
        pose.joint_count, pose.position, pose.quaternion = 7, [0.1, 0.2, 0.3], [0.5, 0.5, -0.5, 0.5]
        contact = zero(compensated_wrench_t)
        contact.valid, contact.wrench_s, contact.reading_utime = 1, [1, 2, 3, 4, 5, 6.5], 1_700_000_000_123_456
        mesh, shape = shape_mesh_t(), shape_t()
        mesh.chunks, mesh.node_count, mesh.element_size = 1, 4, 4
        mesh.rest_xyz = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1]
        mesh.elements, mesh.triangles, mesh.rest_xyz_count = [0, 1, 2, 3], [3, 1, 2, 0, 2, 1], 12
        mesh.element_index_count, mesh.triangle_index_count = 4, 6
        shape.chunks, shape.node_count, shape.xyz, shape.xyz_count = 1, 4, mesh.rest_xyz, 12
        health = zero(health_t)
        health.state = health_t.STATE_DEGRADED
        self.bus.publish("ROBOT_STATE", pose)
        self.bus.publish("WRENCH_COMPENSATED", contact)
        for channel, one in (("SHAPE_MESH", mesh), ("SHAPE", shape), ("HEALTH", health)):
            self.house.publish(channel, one)

    def test_messages_of_fast_dds(self) -> None:
        node = self.start_node()
        with self.subTest("in"):
            now = wall_clock_us()
            reading = self.arrives("FT_WRENCH", lambda: node.write("rt/ft", wrench(wall_clock_us())))
            np.testing.assert_array_equal(reading.wrench, [-1.5, 2, -0.1, -0.3, -4, -5])
            self.assertLess(abs(reading.utime - now), 20_000_000)
            reading = self.arrives("IMU", lambda: node.write("rt/imu", imu(wall_clock_us())))
            np.testing.assert_array_equal(reading.acceleration, [0, 0, 9.81])
            self.cloud_arrives(node, 4)
            self.cloud_arrives(node, 10_000)  # several fragments of DDS and of LCM

        with self.subTest("malformed"):
            drawn = random.Random(1)
            for topic in INPUTS:
                for size in (0, 3, 4, 5, 20, 200):
                    node.write_bytes(topic, bytes([0, 1, 0, 0][: min(size, 4)]) + drawn.randbytes(max(size - 4, 0)))
            node.write("rt/ft", wrench(wall_clock_us() - 5_000_000))
            bad = wrench(wall_clock_us())
            bad.wrench.force.x = math.nan
            node.write("rt/ft", bad)
            self.bridge.wait_for("ft: late")
            self.bridge.wait_for("ft: the wrench is not finite")
            node.write("rt/say", message(STRING, data="jump"))
            self.bridge.wait_for("say: is none of start")
            self.heard["FT_WRENCH"].clear()
            self.arrives("FT_WRENCH", lambda: node.write("rt/ft", wrench(wall_clock_us())))

        with self.subTest("out, and byte for byte as rosbags encodes"):

            def all_arrive() -> bool:
                self.publish()
                time.sleep(0.05)
                return all(node.heard_bytes(topic) for topic in OUTPUTS)

            wait_for(all_arrive, "messages of palpate-ros2")
            for topic in OUTPUTS:
                node.check_encoding(topic)
            contact = node.heard("rt/out/wrench")[-1]
            self.assertEqual(utime_of(contact), 1_700_000_000_123_456)
            self.assertEqual(contact.wrench.torque.z, 6.5)
            hand = node.heard("rt/out/hand")[-1].pose
            self.assertEqual((hand.position.y, hand.orientation.y, hand.orientation.w), (0.2, -0.5, 0.5))
            marker = node.heard("rt/out/shape")[-1]
            self.assertEqual((marker.type, len(marker.points)), (11, 6))
            self.assertEqual((marker.points[0].z, marker.points[1].x), (1, 1))
            wait_for(lambda: any(entry.name == "palpated" and entry.message.startswith("degraded")
                                 for array in node.heard("rt/out/diagnostics") for entry in array.status),
                     "HEALTH among the diagnostics")  # fmt: skip

        with self.subTest("a bag"):
            count = 0
            with Writer(self.folder / "bag", version=9) as bag:
                for topic, name in OUTPUTS.items():
                    connection = bag.add_connection(topic[2:], name, typestore=STORE)
                    for data in node.heard_bytes(topic):
                        count += 1
                        bag.write(connection, count, data)
            with Reader(self.folder / "bag") as bag:
                read = [STORE.deserialize_cdr(data, connection.msgtype) for connection, _, data in bag.messages()]
            self.assertEqual(len(read), count)
        self.bridge.end()
        self.assertRegex(self.bridge.output(), r"ft: \d+ accepted, [1-9]\d* malformed, [1-9]\d* late")

    def cloud_arrives(self, node: FastNode, count: int) -> None:
        heard: "list[Any]" = []
        lcm = DrakeLcm(self.control)
        lcm.Subscribe("POINT_CLOUD", lambda data: heard.append(drake.lcmt_point_cloud.decode(data)))
        points = np.random.default_rng(1).normal(size=(count, 3)).astype("<f4")

        def has_arrived() -> bool:
            node.write("rt/points", cloud(wall_clock_us(), points))
            lcm.HandleSubscriptions(500)
            return bool(heard)

        wait_for(has_arrived, "POINT_CLOUD")
        self.assertEqual((heard[-1].width, heard[-1].frame_name), (count, "camera"))
        np.testing.assert_array_equal(np.frombuffer(bytes(heard[-1].data), "<f4").reshape(-1, 3), points)

    def test_messages_of_dust_dds(self) -> None:
        try:
            from dust_node import DustNode
        except ImportError:
            self.skipTest("no Dust DDS; tools/packaging/install-worlds installs it")
        node = DustNode(self.domain)
        reading = self.arrives("FT_WRENCH", lambda: node.write(wall_clock_us(), (1, 2, 3, 4, 5, 6)))
        np.testing.assert_array_equal(reading.wrench, [-1, -2, -3, -4, -5, -6])

        def has_arrived() -> bool:
            self.publish()
            time.sleep(0.05)
            return node.heard() is not None

        wait_for(has_arrived, "a wrench by Dust DDS")
        self.assertEqual(node.heard(), (1, 2, 3, 4, 5, 6.5))


class Types(unittest.TestCase):
    def test_have_the_hashes_of_ros(self) -> None:
        text = (SOURCE / "tools/bridge/ros2/messages.hpp").read_text()
        pairs = re.findall(r"return \{&(\w+)_msg_dds__(\w+)__desc,\s*\"(\w{64})\"\}", text)
        self.assertEqual(len(pairs), 11)
        for package, name, own in pairs:
            self.assertEqual("RIHS01_" + own, STORE.hash_rihs01(f"{package}/msg/{name}"), name)


if __name__ == "__main__":
    unittest.main(verbosity=2)
