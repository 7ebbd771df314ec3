"""palpated steers an arm that is a node of ROS 2 by Fast DDS, in real time, and is asked by services."""

from __future__ import annotations

import random
import time
import unittest
from typing import Any

from fast_node import SOURCE, FastNode, header, message, utime_of, wall_clock_us  # first: finds the next

# isort: split
import numpy as np
from steered_arm import STOP, SteeredArm, holds, wait_for

URDF = SOURCE / "sim/robot/lwr_hand.urdf"
# rad: the hand of the URDF is at the bar's end.
HOLDING = (0.85090933, -1.57848722, -1.57624132, 1.73160306, 0.00126629, 0.8806686, 1.57936265)
JOINTS = [f"joint_{i + 1}={q}" for i, q in enumerate(HOLDING)]
POINT = "geometry_msgs/msg/PointStamped"
REQUEST, REPLY = "std_srvs/msg/Trigger_Request", "std_srvs/msg/Trigger_Response"


class Steering(SteeredArm):
    program = "palpate-ros2"
    connected = "the arm's driver has begun"

    def speed(self) -> float:
        return float(self.node.ask("state")[1])

    def start_arm(self, kind: str) -> None:
        domain = random.randint(1, 200)
        self.node = FastNode(domain)
        self.addCleanup(self.node.close)
        self.node.say("arm", kind, "joint_states", "commands", "ft", "contact", *JOINTS)
        # Late messages of a loaded machine are still its newest.
        self.start(
            f"ros: {{domain: {domain}, interface: lo, most_age_ms: 100}}\n"
            f"robot: {{urdf: {URDF}, command: {kind}, commands: commands}}\n"
            "wrench: {topic: ft}\noutputs: {wrench: contact}\nrequests: {services: palpate, target: target, "
            "rest_points: [[0.25, 0.03, 0.06]]}\n"
            f"bus: {{control: '{self.control}', housekeeping: '{self.housekeeping}'}}\n",
            ["sensing.0.payload={mass: 0, center_of_mass: [0, 0, 0]}", "frames.sensor_in_flange={position: [0, 0, 0]}"],
        )  # fmt: skip

    def call(self, service: str) -> Any:
        """As a client with rmw_cyclonedds_cpp; the reply."""
        request, reply = f"rq/palpate/{service}Request", f"rr/palpate/{service}Reply"
        self.node.connect("reader", reply, REPLY)
        self.node.connect("writer", request, REQUEST)
        self.node.wait_for_match(request)
        self.node.wait_for_match(reply)
        client = random.getrandbits(64)
        self.node.write(request, message(REQUEST, client=client, sequence_number=7, unused=0))
        wait_for(lambda: bool(self.node.heard(reply)), f"a reply of {service}")
        (answer,) = self.node.heard(reply)
        self.node.check_encoding(reply)
        self.assertEqual((answer.client, answer.sequence_number), (client, 7))
        return answer

    def command(self, name: str) -> Any:
        """The next one, as rosbags reads it, and would write it."""
        self.node.connect("reader", "rt/commands", name)
        wait_for(lambda: bool(self.node.heard("rt/commands")), "a command")
        self.node.check_encoding("rt/commands")
        return self.node.heard("rt/commands")[-1]

    def test_steers_and_stops(self) -> None:
        self.start_arm("velocities")
        holds(self, lambda: int(self.node.ask("state")[0]) == 0, 0.5, "no command before start")

        with self.subTest("by services and a topic"):
            self.assertTrue(self.call("zero").success)
            self.assertTrue(self.call("start").success)
            self.node.connect("writer", "rt/target", POINT)
            self.node.wait_for_match("rt/target")

            def moves() -> bool:
                place = message("geometry_msgs/msg/Point", x=0.25, y=0.03, z=0.08)
                self.node.write("rt/target", message(POINT, header=header(wall_clock_us(), "object"), point=place))
                time.sleep(0.3)
                return self.speed() > 0.01

            wait_for(moves, f"the arm moves; {self.bridge.output()}")
            self.assertTrue(self.call("stop").success)
            wait_for(lambda: self.speed() == 0, "the arm rests")

        with self.subTest("to the target"):
            self.move(0.02)

            said = "rests until palpated is stopped"
            stops = self.bridge.output().count(said)

            def is_near() -> bool:
                nonlocal stops
                time.sleep(0.05)
                if self.bridge.output().count(said) > stops:  # a machine that stalls for 50 ms
                    stops = self.bridge.output().count(said)
                    self.move(0.02)
                return bool(np.linalg.norm(self.latest(self.features).error[:3]) < 2e-3)

            wait_for(is_near, "the point is at its target")
            q = np.array([float(word) for word in self.node.ask("state")[2:]])
            self.assertGreater(np.abs(q - HOLDING).max(), 0.01)

        for count, fault in enumerate(("silent", "nan", "short", "late"), 1):
            with self.subTest(fault):
                self.move(0.03 * (-1) ** count)
                self.node.say("fault", fault)
                wait_for(lambda: len(self.node.rested()) >= count, f"the arm rests; {self.bridge.output()}")
                self.assertLess(self.node.rested()[-1], STOP)
                self.node.say("fault")
                holds(self, lambda: self.speed() == 0, 0.4, "rests until palpated is stopped")

        with self.subTest("ended by a signal while it moves"):
            self.move(0.03)
            command = self.command("std_msgs/msg/Float64MultiArray")
            self.assertEqual((len(command.data), len(command.layout.dim)), (7, 0))
            self.bridge.end()
            self.assertEqual(self.speed(), 0, "the last command is zero")
        self.assertRegex(self.bridge.output(), r"joint_states: \d+ accepted, [1-9]\d* malformed, [1-9]\d* late")

    def test_latency(self) -> None:
        """Prints it: the machine decides."""
        self.start_arm("twist")
        self.move(0.1)  # the joints rest, and the motion never ends
        self.node.ask("latency")
        time.sleep(5)
        words = [float(word) for word in self.node.ask("latency")]
        for name, row in (("compensated wrench", words[:5]), ("next command after it", words[5:])):
            p50, p99, p999, most, number = row
            print(f"wrench to {name}: p50 {p50:.2f}, p99 {p99:.2f}, p99.9 {p999:.2f}, max {most:.2f} ms, {number:.0f}",
                  flush=True)  # fmt: skip
            self.assertGreater(number, 1000)
        twist = self.command("geometry_msgs/msg/TwistStamped")
        self.assertEqual(twist.header.frame_id, "base_link")
        self.assertLess(abs(wall_clock_us() - utime_of(twist)), 10_000_000)
        # The target is above: O is turned about z only.
        self.assertGreater(twist.twist.linear.z, 0.01)


if __name__ == "__main__":
    unittest.main(verbosity=2)
