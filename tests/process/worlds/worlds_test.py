"""A short run of each world with palpated in lock-step, and its command line."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
import palpate

SOURCE = Path(os.environ["PALPATE_SOURCE_DIR"])
BIN = Path(os.environ["PALPATE_BIN_DIR"])
WORLDS = SOURCE / "tools/lab/worlds"
sys.path.insert(0, str(WORLDS))

from live_run import RunFiles, RunPlan, Target, run_live  # noqa: E402
from scene import read_scene  # noqa: E402
from touch import obstacles_of_configuration  # noqa: E402

SCENES = SOURCE / "sim/scenes"
BAR = SOURCE / "rt/config/examples/bar_long_soft.yaml"
# Down by 80 mm, and a diagonal pose with torsion, in 3 s.
POSES = (
    "motion={start_delay: 0.2, poses: ["
    "{move: 0.7, hold: 0.8, translation: [0, 0, -0.08]}, "
    "{move: 0.7, hold: 0.6, translation: [0, 0.06, 0.04], rotation_deg: [20, 0, 0]}]}"
)
# Down onto the table below the bar, in 1.5 s.
ON_TABLE = (
    "motion={start_delay: 0.1, poses: [{move: 0.8, hold: 0.6, translation: [-0.005, 0, -0.008],"
    " rotation_deg: [0, -20, 0]}]}"
)
# Coarse enough for a test; what is not converged is within the bounds.
COARSE = {
    "mujoco": ["--cells", "10", "1", "1", "--period", "0.005"],
    "drake": ["--cells", "20", "2", "2", "--period", "0.01", "--damping", "0.1"],
}


def require_multicast(test: unittest.TestCase) -> None:
    try:
        palpate.Bus("udpm://239.255.99.99:9999?ttl=0").close()
    except OSError as error:
        test.skipTest(f"multicast does not work here: {error}")


def world(*words: object) -> "subprocess.CompletedProcess[str]":
    command = [sys.executable, WORLDS / "palpate-world", *words]
    return subprocess.run(
        [str(word) for word in command], capture_output=True, text=True, timeout=120
    )


class Worlds(unittest.TestCase):
    def setUp(self) -> None:
        require_multicast(self)
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def run_plan(self, plan: RunPlan) -> "tuple[RunFiles, palpate.Log]":
        run = run_live(plan, self.folder)
        return run, palpate.read_log(run.control, run.housekeeping, clock="sent")

    def senses(self, name: str) -> None:
        words = [*COARSE[name], "--set", POSES]
        rigid = ["object.grasp_stiffness=1e7"]
        plan = RunPlan(name, SCENES / "bar_long_soft_six_poses.yaml", BAR, words, rigid, bin=BIN)
        run, log = self.run_plan(plan)
        error = palpate.shape_error(log)
        self.assertGreater(error.displacement.max(), 0.07)
        self.assertLess(error.between(1.4, 1.69).mean, 1e-3)
        self.assertLess(error.at_end.maximum, 3e-3)
        # The hand's wrench: as palpated's model predicts it, and as its sensor measures it.
        truth = log["TRUTH_CONTACT"].grasp_wrench[-1, 0]
        predicted = log["ESTIMATE"].reaction[-1, 0]
        measured = log["CONTACTS"].wrench[-50:, 0].mean(axis=0)
        self.assertGreater(np.linalg.norm(truth[:3]), 0.3)
        np.testing.assert_allclose(predicted[:3], truth[:3], atol=0.15)
        np.testing.assert_allclose(predicted[3:], truth[3:], atol=0.03)
        np.testing.assert_allclose(measured[:3], truth[:3], atol=0.06)
        summary = json.loads((run.folder / "world.json").read_text())
        self.assertEqual(summary["world"], name)
        self.assertGreater(summary["commands_accepted"], 1000)

    def test_mujoco_bends_a_bar_that_palpated_senses(self) -> None:
        self.senses("mujoco")

    def test_drake_bends_a_bar_that_palpated_senses(self) -> None:
        self.senses("drake")

    def test_mujoco_lays_a_bar_on_a_table_that_palpated_knows(self) -> None:
        name = "mujoco"
        file = SCENES / "bar_long_soft_table.yaml"
        overrides = [
            "object.grasp_stiffness=1e7",
            obstacles_of_configuration(read_scene(file, [])),
        ]
        plan = RunPlan(name, file, BAR, [*COARSE[name], "--set", ON_TABLE], overrides, bin=BIN)
        run, log = self.run_plan(plan)
        error = palpate.shape_error(log)
        self.assertLess(error.at_end.mean, 1.2e-3)  # 5 mm without the table
        self.assertLess(error.at_end.maximum, 4e-3)
        # Without the table the bar's lower side would be 12 mm deeper.
        lowest = log["TRUTH_SHAPE"].positions[-1, :, 2].min()
        self.assertAlmostEqual(lowest, -0.025, delta=0.5e-3)
        (depth,) = json.loads((run.folder / "world.json").read_text())["penetration_mm"].values()
        self.assertLess(depth, 1.0)

    def test_palpated_steers_a_bar_in_mujoco(self) -> None:
        plan = RunPlan(
            "mujoco",
            SCENES / "bar_long_soft_control.yaml",
            BAR,
            COARSE["mujoco"],
            ["object.grasp_stiffness=1e7", "control.gain=3"],
            target=Target((0.25, 0.03, 0.06), (0.25, 0.03, 0.08)),
            seconds=2.5,
            bin=BIN,
        )
        _, log = self.run_plan(plan)
        error = palpate.feature_error(log)
        self.assertGreater(error.distance[0], 0.015)
        self.assertLess(error.at_rest, 2.5e-3)

    def test_real_time_publishes_at_the_rates_of_hardware(self) -> None:
        group = f"239.255.{np.random.randint(160, 250)}.{np.random.randint(1, 250)}"
        urls = [f"udpm://{group}:{port}?ttl=0" for port in (21210, 21211)]
        with palpate.Recorder(self.folder / "run.log", urls):
            done = world(
                SCENES / "bar_long_soft_control.yaml", "--world", "mujoco", "--real-time",
                "--cells", 10, 1, 1, "--period", 0.01, "--duration", 2,
                "--set", f"bus.control={urls[0]}", "--set", f"bus.housekeeping={urls[1]}",
            )  # fmt: skip
        self.assertEqual(done.returncode, 0, done.stderr)
        log = palpate.read_log(self.folder / "run.log")
        counts = {
            name: len(log[name]) for name in ("FT_WRENCH", "IMU", "ROBOT_STATE", "HAND_STATE")
        }
        for name, rate in {
            "FT_WRENCH": 1000,
            "IMU": 300,
            "ROBOT_STATE": 500,
            "HAND_STATE": 100,
        }.items():
            self.assertAlmostEqual(counts[name], 2 * rate, delta=0.05 * 2 * rate, msg=name)
        # At rest the sensor carries the hand, the bar's share and nothing else.
        weight = np.linalg.norm(log["FT_WRENCH"].wrench[-500:, :3].mean(axis=0))
        share = log["TRUTH_CONTACT"].grasp_wrench[-1, 0, 2]
        self.assertAlmostEqual(weight, 4.8 * 9.81 + share, delta=0.02)
        self.assertGreater(share, 0.1)


class CommandLine(unittest.TestCase):
    def test_a_wrong_command_line_ends_with_64(self) -> None:
        for words in (
            ["--no-such-option"],
            [SCENES / "x.yaml"],
            [SCENES / "x.yaml", "--world", "dart"],
        ):
            done = world(*words)
            self.assertEqual(done.returncode, 64, done.stderr)
            self.assertIn("--help", done.stderr)

    def test_a_wrong_scene_ends_with_78_and_names_the_key(self) -> None:
        scene = SCENES / "bar_long_soft_control.yaml"
        cases = {
            "object.material.poisson_ratio=0.6": "allowed: 0 to 0.49",
            "object.material.young_modulus=soft": "is not a number",
            "object.colour=red": "object.colour",
            "pokes=[]": "pokes",
            "obstacles=[{shape: mesh, file: table.stl}]": "'mesh' is not supported",
        }
        for override, expected in cases.items():
            done = world(scene, "--world", "mujoco", "--set", override)
            self.assertEqual(done.returncode, 78, done.stderr)
            self.assertIn(expected, done.stderr)

    def test_help_needs_no_package(self) -> None:
        for program in (
            "palpate-world", "measure_worlds", "make_object", "drake_arm", "steer_drake_arm",
            "ur_arm", "measure_exports",
        ):  # fmt: skip
            done = subprocess.run(
                ["/usr/bin/python3", "-B", str(WORLDS / program), "--help"],
                capture_output=True, text=True,
            )  # fmt: skip
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("Exit codes: 0", done.stdout)


if __name__ == "__main__":
    unittest.main()
