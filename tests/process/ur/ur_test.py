"""palpate-ur and palpated with a simulated controller of Universal Robots, in real time."""

from __future__ import annotations

import unittest

from simulated_ur import SimulatedUr  # first: finds the next

# isort: split
import numpy as np
from steered_arm import SOURCE, STOP, SteeredArm, holds, wait_for
from ur_controller import PLAYING, flange_pose


class Steering(SteeredArm):
    program = "palpate-ur"

    def setUp(self) -> None:
        super().setUp()
        self.ur = SimulatedUr(hand=4.8)
        self.addCleanup(self.ur.close)
        self.controller = self.ur.controller
        self.start(
            f"robot: {{host: {self.ur.address}, urdf: {SOURCE}/tools/bridge/ur/examples/ur5e.urdf,"
            f" watchdog_ms: 60}}\nbus: {{control: '{self.control}'}}\nwrench: {{source: ft300}}\n",
            ["sensing.0.payload={mass: 4.8, center_of_mass: [0, 0, 0.1]}"],
        )

    def speed(self) -> float:
        return self.controller.speed

    def distance(self) -> float:
        """m, of the estimated point from its target."""
        return float(np.linalg.norm(self.latest(self.features).error[:3]))

    def rests(self, seconds: float, why: str) -> None:
        stood = self.controller.q.copy()
        holds(self, lambda: bool(np.abs(self.controller.q - stood).max() < 1e-4), seconds, why)

    def test_steers_and_stops(self) -> None:
        self.rests(0.5, "nothing moves before start")
        self.assertEqual(self.controller.programs, 0)
        before = flange_pose(self.controller.q)[:3, 3]

        with self.subTest("steering"):
            self.move(0.02)
            # A machine that stalls the bridge for 60 ms stops the arm; it is then started again.
            def is_near() -> bool:
                if self.controller.runtime_state != PLAYING:
                    self.move(0.02)
                return self.distance() < 2e-3

            wait_for(is_near, "the point is at its target")
            way = np.linalg.norm(flange_pose(self.controller.q)[:3, 3] - before)
            self.assertGreater(way, 0.01)
            state = self.latest(self.states)
            pose = flange_pose(np.array(state.q[:6]))
            np.testing.assert_allclose(state.position, pose[:3, 3], atol=1e-6)
            np.testing.assert_allclose(state.q[:6], self.controller.q, atol=5e-3)

        with self.subTest("emergency stop"):
            self.move(-0.03)
            self.controller.is_emergency_stopped = True
            self.assertLess(self.ur.seconds_to_rest(), STOP)
            self.bridge.wait_for("emergency stop of the robot: rests")
            self.controller.is_emergency_stopped = False
            self.rests(0.5, "rests until palpated is stopped")

        with self.subTest("network"):
            self.move(0.04)
            session = self.latest(self.states).session
            self.ur.servers.is_silent = True
            self.assertLess(self.ur.seconds_to_rest(), STOP)
            self.rests(0.3, "the program has ended")
            self.ur.servers.is_silent = False
            wait_for(lambda: self.latest(self.states).session != session, "a new session")
            self.rests(0.5, "rests until palpated is stopped")

        with self.subTest("killed"):
            self.move(-0.03)
            self.bridge.process.kill()
            self.assertLess(self.ur.seconds_to_rest(), STOP)
            self.bridge = self.start_bridge()
            self.rests(0.5, "rests until palpated is stopped")
            self.move(0.03)

        self.bridge.end()
        self.assertIn("readings of the FT 300, 0 malformed", self.bridge.output())
        self.assertEqual(self.ur.servers.violations, [])
        self.assertEqual(self.controller.errors, [])


if __name__ == "__main__":
    unittest.main(verbosity=2)
