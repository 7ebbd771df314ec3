"""palpate-ur and palpated with a simulated controller of Universal Robots, in real time."""

from __future__ import annotations

import os
import tempfile
import time
import unittest
from pathlib import Path

from simulated_ur import SOURCE, SimulatedUr, holds, wait_for  # first: finds the next

# isort: split
import numpy as np
import palpate
from live_run import Program, private_urls
from palpate.messages import feature_t, robot_state_t
from ur_controller import PLAYING, flange_pose

BIN = Path(os.environ["PALPATE_BIN_DIR"])
REST_POINT = (0.25, 0.03, 0.06)
STOP = 0.1  # s
# Of a machine that other programs load: lateness neither degrades nor stops.
PATIENT = ["loop.degraded_after_ms=9000", "loop.overrun_window_ms=10000", "loop.safe_stop_after_ms=9000"]


class Steering(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.ur = SimulatedUr(hand=4.8)
        self.addCleanup(self.ur.close)
        self.controller = self.ur.controller
        self.control, self.housekeeping = private_urls(2)
        (self.folder / "ur.yaml").write_text(
            f"robot: {{host: {self.ur.address}, urdf: {SOURCE}/tools/bridge/ur/examples/ur5e.urdf,"
            f" watchdog_ms: 60}}\nbus: {{control: '{self.control}'}}\nwrench: {{source: ft300}}\n"
        )
        self.bridge = self.start_bridge()
        sets = [f"bus.control={self.control}", f"bus.housekeeping={self.housekeeping}", *PATIENT]
        sets += ["sensing.0.payload={mass: 4.8, center_of_mass: [0, 0, 0.1]}"]
        configuration = SOURCE / "rt/config/examples/bar_long_soft.yaml"
        words = [word for text in sets for word in ("--set", text)]
        self.palpated = Program(
            "palpated", [BIN / "palpated", "--config", configuration, *words], self.folder
        )
        self.addCleanup(self.palpated.end)
        self.palpated.wait_for("waits for start")
        self.states: "list[robot_state_t]" = []
        self.features: "list[feature_t]" = []
        self.bus = palpate.Bus(self.control)
        self.addCleanup(self.bus.close)
        self.bus.subscribe("ROBOT_STATE", self.states.append)
        self.bus.subscribe("FEATURE", self.features.append)
        self.daemon = palpate.Daemon(self.control, self.housekeeping, timeout=30)
        self.addCleanup(self.daemon.close)

    def start_bridge(self) -> Program:
        bridge = Program("palpate-ur", [BIN / "palpate-ur", "--config", self.folder / "ur.yaml"], self.folder)
        self.addCleanup(bridge.end)
        bridge.wait_for("connected")
        return bridge

    def move(self, height: float) -> None:
        """Until the arm moves: stops and starts palpated, as after any stop, and again where a
        loaded machine has stopped it meanwhile.
        """

        def moves() -> bool:
            self.daemon.stop()
            wait_for(lambda: self.controller.speed < 1e-3, "the arm rests")
            self.daemon.start()
            self.daemon.target("point", (0.25, 0.03, 0.06 + height), points=[REST_POINT])
            end = time.monotonic() + 3
            while self.controller.speed < 0.01 and time.monotonic() < end:
                time.sleep(0.001)
            return self.controller.speed >= 0.01

        wait_for(moves, f"the arm moves; {self.bridge.output()}")

    def latest(self, messages: "list") -> object:
        self.bus.drain()
        return messages[-1]

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
