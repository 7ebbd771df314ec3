"""The examples against real processes: their results, not only their exit codes."""

import concurrent.futures
import json
import re
import subprocess
import unittest
from pathlib import Path

import numpy as np
import palpate

from processes import BAR, BIN, EXAMPLES, PATIENCE, ProcessTest, Program


class Examples(ProcessTest):
    def test_a_point_is_steered_recorded_and_scored(self) -> None:
        daemon = self.start_daemon(BAR, "--stepped")
        path = self.folder / "run.log"
        with palpate.Recorder(path, (self.control, self.housekeeping)):
            simulator = self.start_simulator("--fast")
            steered = self.run_example(
                "steer_a_point.py", "--to", 0.25, 0.03, 0.08, "--within", 1.5, "--for", 90
            )
            said = steered.stderr + daemon.output() + simulator.output()
            self.assertEqual(steered.returncode, 0, said)
            simulator.end()
        self.assertRegex(steered.stdout, r"1\.[0-4]\d mm to go\n$|0\.\d\d mm to go\n$|1\.50 mm")

        # On the plant's ground truth the point reached its target, from 20 mm away.
        log = palpate.read_log(path, clock="sent")
        feature = palpate.feature_error(log)
        self.assertGreater(feature.distance[0], 0.018)
        self.assertLess(feature.distance[-1], 0.004)

        scores, picture = self.folder / "scores.json", self.folder / "error.png"
        plotted = self.run_example(
            "plot_shape_error.py", path, "--sent", "--picture", picture, "--json", scores
        )
        self.assertEqual(plotted.returncode, 0, plotted.stderr)
        score = json.loads(scores.read_text())
        self.assertGreater(score["shapes"], 100)
        self.assertLess(score["mean_mm"], 1.0)
        self.assertGreater(score["mean_mm"], 0.001)
        self.assertGreater(score["feature"]["within_5mm_s"], 0.5)
        self.assertEqual(picture.read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        self.assertGreater(picture.stat().st_size, 20_000)
        self.compare_with_palpate_evaluate(path)

    def compare_with_palpate_evaluate(self, path: Path) -> None:
        """By the clock of the recording, as that program reads it."""
        output = self.folder / "evaluate.json"
        made = subprocess.run(
            [BIN / "palpate-evaluate", "score", "--control", path, "--housekeeping", path,
             "--json", output],
            capture_output=True, text=True,
        )  # fmt: skip
        self.assertIn(made.returncode, (0, 1), made.stderr)
        theirs = json.loads(output.read_text())
        log = palpate.read_log(path)
        error, feature = palpate.shape_error(log), palpate.feature_error(log)
        numbers = json.dumps(theirs)
        for ours in (error.whole.mean, error.whole.rms, error.whole.maximum, feature.at_rest):
            values = [float(text) for text in re.findall(r"-?\d+\.\d+(?:e-?\d+)?", numbers)]
            nearest = min(values, key=lambda value: abs(value - 1e3 * ours))
            self.assertAlmostEqual(nearest, 1e3 * ours, delta=2e-3 * 1e3 * ours, msg=numbers[:2000])

    def test_a_pushed_bar_bends_as_beam_theory_says(self) -> None:
        self.start_daemon(EXAMPLES / "bar_pushed.yaml")
        force, length, side, modulus, nu = 0.05, 0.5, 0.06, 300e3, 0.3
        # Middle of the free end.
        pushed = self.run_example(
            "push_a_node.py", "--point", length, side / 2, side / 2, "--force", 0, 0, -force
        )
        self.assertEqual(pushed.returncode, 0, pushed.stderr)
        found = re.search(r"N: (\S+) (\S+) (\S+) mm", pushed.stdout)
        assert found is not None, pushed.stdout
        moved = np.array([float(text) for text in found.groups()]) * 1e-3
        inertia, shear = side**4 / 12, modulus / (2 * (1 + nu)) * side**2 * 5 / 6
        expected = force * length**3 / (3 * modulus * inertia) + force * length / shear
        self.assertAlmostEqual(-moved[2], expected, delta=0.05 * expected)
        self.assertLess(abs(moved[1]), 0.02 * expected)

    def test_examples_say_what_is_wrong(self) -> None:
        self.start_daemon(EXAMPLES / "bar_pushed.yaml")
        wrong = self.run_example("push_a_node.py", "--node", 100000)
        self.assertEqual(wrong.returncode, 1)
        self.assertIn("the mesh has nodes 0 to 524", wrong.stderr)
        absent = self.run_example("plot_shape_error.py", self.folder / "absent.log")
        self.assertEqual(absent.returncode, 1)
        self.assertIn("absent.log", absent.stderr)

    def test_help_has_an_example(self) -> None:
        for name in ("plot_shape_error.py", "steer_a_point.py", "push_a_node.py"):
            printed = self.run_example(name, "--help")
            self.assertEqual(printed.returncode, 0)
            self.assertIn("e.g.", printed.stdout)


class Access(ProcessTest):
    def test_only_who_has_the_key_commands(self) -> None:
        key = self.folder / "robot.key"
        Program(self, [BIN / "palpate-command", "--make-key", key]).process.wait(30)
        self.start_daemon(access__key_file=str(key))
        stranger = self.connect()
        stranger.timeout = 3
        with self.assertRaisesRegex(palpate.NoAnswer, "no_access: .*authentication code"):
            stranger.start()
        self.assertEqual(stranger.health(20).state, palpate.STATES.index("inactive"))
        owner = self.connect(key_file=key)
        self.assertEqual(owner.start().event, "start")
        self.assertEqual(owner.target("point", [0.25, 0.03, 0.07]).event, "target")
        self.assertEqual(owner.stop().event, "stop")

    def test_a_command_that_was_there_before_the_daemon_is_obeyed(self) -> None:
        key = self.folder / "robot.key"
        Program(self, [BIN / "palpate-command", "--make-key", key]).process.wait(30)
        owner = self.connect(key_file=key)
        heard = palpate.Bus(self.control)
        self.addCleanup(heard.close)
        commands = heard.subscribe("COMPONENT_COMMAND")
        with concurrent.futures.ThreadPoolExecutor() as pool:
            answer = pool.submit(owner.start)
            commands.get(PATIENCE)
            self.start_daemon(access__key_file=str(key))
            self.assertEqual(answer.result(PATIENCE).event, "start")
        self.assertGreater(owner.health(PATIENCE).commands_rejected, 0)


if __name__ == "__main__":
    unittest.main()
