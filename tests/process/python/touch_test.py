"""Guarded motions of palpated in lock-step with the simulator, by the package and by
palpate-command."""

import re
import subprocess
import time
import unittest

from palpate import Touch

from processes import BIN, PATIENCE, SOURCE, ProcessTest, Program

CONFIGURATION = SOURCE / "rt/config/examples/touch_block.yaml"
SCENE = SOURCE / "sim/scenes/touch_block.yaml"
SIDE, BALL = 1.0, 0.01  # m: place in W of the block's free side along x; radius of the tip


class Touches(ProcessTest):
    def setUp(self) -> None:
        super().setUp()
        self.palpated = self.start_daemon(CONFIGURATION, "--stepped")
        self.simulator = Program(self, [BIN / "palpate-sim", SCENE, *self.urls, "--fast"])
        self.daemon = self.connect()
        self.daemon.start()
        end = time.monotonic() + PATIENCE  # until the force is tared
        while self.daemon.state() != "active":
            self.assertLess(time.monotonic(), end, self.palpated.output())

    def command(self, *words: object) -> "subprocess.CompletedProcess[str]":
        place = ["--url", self.control, "--url", f"housekeeping={self.housekeeping}"]
        line = [BIN / "palpate-command", *place, "--timeout", PATIENCE, "touch", *words]
        return subprocess.run(
            [str(word) for word in line], capture_output=True, text=True, timeout=3 * PATIENCE
        )

    def test_the_package_returns_the_touched_point(self) -> None:
        states: list[str] = []

        def note(touch: Touch) -> None:
            states.append(touch.state)

        touch = self.daemon.touch([1, 0, 0], 0.3, progress=note)
        self.assertEqual(touch.state, "touched", touch.reason)
        assert touch.point is not None and touch.centre is not None
        assert touch.point_deviation is not None and touch.stiffness is not None
        self.assertAlmostEqual(touch.point[0], SIDE, delta=1e-3)
        self.assertAlmostEqual(touch.point[0] - touch.centre[0], BALL, delta=1e-9)
        self.assertLess(touch.point_deviation, 1e-3)
        self.assertGreater(touch.stiffness, 50)
        self.assertLess(touch.stiffness, 1000)
        self.assertEqual(sorted(set(states)), ["approaching", "retreating", "waiting"])

    def test_the_command_prints_it(self) -> None:
        done = self.command("--direction", 2, 0, 0, "--force", 0.3)
        said = done.stdout + done.stderr
        self.assertEqual(done.returncode, 0, said)
        found = re.search(r"touched at ([\d.]+) ([\d.-]+) ([\d.]+) m in W \+- ([\d.]+) mm", said)
        assert found is not None, said
        self.assertAlmostEqual(float(found[1]), SIDE, delta=1e-3)
        self.assertRegex(done.stdout, r"stiffness \d+\.\d \+- \d+\.\d N/m")

        away = self.command("--direction", -1, 0, 0, "--force", 0.3, "--distance", 0.005)
        self.assertEqual(away.returncode, 1, away.stdout)
        self.assertIn("no contact", away.stdout)

        refused = self.command("--direction", 1, 0, 0, "--force", 1000)
        self.assertEqual(refused.returncode, 1)
        self.assertIn("refused", refused.stdout)
        self.assertIn("force_limit", refused.stdout)


if __name__ == "__main__":
    unittest.main()
