"""palpate-franka and palpated with a mock of a Franka arm, in real time."""

from __future__ import annotations

import unittest

from mock_arm import HOLDING, IDLE, REFLEX, URDF, MockArm  # first: finds the next

# isort: split
import numpy as np
from palpate.messages import ft_wrench_t
from steered_arm import STOP, SteeredArm, holds, wait_for


class Steering(SteeredArm):
    program = "palpate-franka"

    def setUp(self) -> None:
        super().setUp()
        self.arm = MockArm()
        self.addCleanup(self.arm.close)
        self.arm.say("noise 0.01")  # a reading that never changes counts as none
        # The arm subtracts the hand.
        self.start(
            f"robot: {{host: 127.0.0.1, port: {self.arm.port}, urdf: {URDF}, recover: true}}\n"
            f"bus: {{control: '{self.control}'}}\nwrench: {{payload: 0}}\n",
            ["sensing.0.payload={mass: 0, center_of_mass: [0, 0, 0]}", "frames.sensor_in_flange={position: [0, 0, 0]}"],
        )
        self.wrenches: "list[ft_wrench_t]" = []
        self.bus.subscribe("FT_WRENCH", self.wrenches.append)

    def speed(self) -> float:
        return self.arm.state().speed

    def rests(self, seconds: float, why: str) -> None:
        stood = np.array(self.arm.state().q)
        holds(self, lambda: bool(np.abs(np.array(self.arm.state().q) - stood).max() < 1e-4), seconds, why)

    def test_steers_and_stops(self) -> None:
        self.rests(0.5, "nothing moves before start")
        state = self.arm.state()
        self.assertEqual((state.motions, state.commands), (0, 0))

        with self.subTest("steering"):
            self.move(0.02)

            # A machine that stalls the bridge for 20 ms stops the arm; it is then started again.
            def is_near() -> bool:
                if self.arm.state().mode == REFLEX:
                    self.move(0.02)
                return bool(np.linalg.norm(self.latest(self.features).error[:3]) < 2e-3)

            wait_for(is_near, "the point is at its target")
            self.assertGreater(np.abs(np.array(self.arm.state().q) - HOLDING).max(), 0.01)
            wait_for(lambda: self.arm.state().speed < 1e-4, "the arm rests")
            np.testing.assert_allclose(self.latest(self.states).q[:7], self.arm.state().q, atol=1e-3)
            self.arm.say("wrench 0 0 0.5 0 0 0")
            wait_for(lambda: abs(self.latest(self.wrenches).wrench[2] + 0.5) < 0.1, "the external wrench")
            self.arm.say("wrench 0 0 0 0 0 0")

        with self.subTest("user stop"):
            self.move(-0.03)
            self.arm.say("user_stop on")
            self.assertLess(self.arm.seconds_to_rest(), STOP)
            self.bridge.wait_for("user stop of the arm: rests")
            self.arm.say("user_stop off")
            self.rests(0.5, "rests until palpated is stopped")

        with self.subTest("network"):
            self.move(0.04)
            session = self.latest(self.states).session
            self.arm.say("silent on")
            self.assertLess(self.arm.seconds_to_rest(), STOP)
            self.bridge.wait_for("silent: holds")
            self.arm.say("silent off")
            wait_for(lambda: self.latest(self.states).session != session, "a new session")
            self.rests(0.5, "rests until palpated is stopped")
            self.bridge.wait_for("reflex of the arm: communication_constraints_violation")
            wait_for(lambda: self.arm.state().mode == IDLE, "the reflex is left")

        with self.subTest("killed"):
            self.move(-0.03)
            self.bridge.process.kill()
            self.assertLess(self.arm.seconds_to_rest(), STOP)
            self.bridge = self.start_bridge()
            self.rests(0.5, "rests until palpated is stopped")
            wait_for(lambda: self.arm.state().mode == IDLE, "the reflex is left")

        with self.subTest("ended by a signal while it moves"):
            self.move(0.03)
            before = self.arm.state()
            self.bridge.end()
            after = self.arm.state()
            self.assertEqual(after.ended, before.ended + 1, "the motion ends without a reflex")
        self.assertIn("motions", self.bridge.output())
        self.assertEqual(self.arm.state().violation, "")


if __name__ == "__main__":
    unittest.main(verbosity=2)
