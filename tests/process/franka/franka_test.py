"""palpate-franka and palpated with a mock of a Franka arm, in real time."""

from __future__ import annotations

import sys
import tempfile
import time
import unittest
from pathlib import Path

from mock_arm import BIN, HOLDING, IDLE, REFLEX, SOURCE, URDF, MockArm, wait_for

sys.path.insert(0, str(SOURCE / "tools/lab/worlds"))

import numpy as np  # noqa: E402
import palpate  # noqa: E402
from live_run import Program, private_urls  # noqa: E402
from palpate.messages import feature_t, ft_wrench_t, robot_state_t  # noqa: E402

REST_POINT = (0.25, 0.03, 0.06)
STOP = 0.1  # s
# Of a machine that other programs load: lateness neither degrades nor stops.
PATIENT = ["loop.degraded_after_ms=9000", "loop.overrun_window_ms=10000", "loop.safe_stop_after_ms=9000"]


class Steering(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.arm = MockArm()
        self.addCleanup(self.arm.close)
        self.arm.say("noise 0.01")  # a reading that never changes counts as none
        self.control, self.housekeeping = private_urls(2)
        (self.folder / "franka.yaml").write_text(
            f"robot: {{host: 127.0.0.1, port: {self.arm.port}, urdf: {URDF}, recover: true}}\n"
            f"bus: {{control: '{self.control}'}}\nwrench: {{payload: 0}}\n"
        )
        self.bridge = self.start_bridge()
        sets = [f"bus.control={self.control}", f"bus.housekeeping={self.housekeeping}", *PATIENT]
        # The arm subtracts the hand.
        sets += ["sensing.0.payload={mass: 0, center_of_mass: [0, 0, 0]}", "frames.sensor_in_flange={position: [0, 0, 0]}"]
        configuration = SOURCE / "rt/config/examples/bar_long_soft.yaml"
        words = [word for text in sets for word in ("--set", text)]
        self.palpated = Program("palpated", [BIN / "palpated", "--config", configuration, *words], self.folder)
        self.addCleanup(self.palpated.end)
        self.palpated.wait_for("waits for start")
        self.states: "list[robot_state_t]" = []
        self.features: "list[feature_t]" = []
        self.wrenches: "list[ft_wrench_t]" = []
        self.bus = palpate.Bus(self.control)
        self.addCleanup(self.bus.close)
        self.bus.subscribe("ROBOT_STATE", self.states.append)
        self.bus.subscribe("FEATURE", self.features.append)
        self.bus.subscribe("FT_WRENCH", self.wrenches.append)
        self.daemon = palpate.Daemon(self.control, self.housekeeping, timeout=30)
        self.addCleanup(self.daemon.close)

    def start_bridge(self) -> Program:
        bridge = Program("palpate-franka", [BIN / "palpate-franka", "--config", self.folder / "franka.yaml"], self.folder)
        self.addCleanup(bridge.end)
        bridge.wait_for("connected")
        return bridge

    def move(self, height: float) -> None:
        """Until the arm moves: stops and starts palpated, as after any stop, and again where a
        loaded machine has stopped it meanwhile.
        """

        def moves() -> bool:
            self.daemon.stop()
            wait_for(lambda: self.arm.state().speed < 1e-3, "the arm rests")
            self.daemon.start()
            self.daemon.target("point", (0.25, 0.03, 0.06 + height), points=[REST_POINT])
            end = time.monotonic() + 3
            while self.arm.state().speed < 0.01 and time.monotonic() < end:
                time.sleep(0.001)
            return self.arm.state().speed >= 0.01

        wait_for(moves, f"the arm moves; {self.bridge.output()}")

    def latest(self, messages: "list") -> object:
        self.bus.drain()
        return messages[-1]

    def rests(self, seconds: float, why: str) -> None:
        stood = np.array(self.arm.state().q)
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.assertLess(np.abs(np.array(self.arm.state().q) - stood).max(), 1e-4, why)
            time.sleep(0.002)

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
