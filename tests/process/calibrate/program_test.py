"""palpate-calibrate as a program: public recordings, the YAML that palpated accepts, plans and wrong use.

usage: calibrate_test.py BINARIES SOURCE [UNITTEST-OPTIONS]

The recordings are looked for in PALPATE_DATA (default: ../shared/data relative to the source).
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import yaml

BINARIES, SOURCE = (pathlib.Path(sys.argv.pop(1)).resolve() for _ in range(2))
DATA = pathlib.Path(os.environ.get("PALPATE_DATA", SOURCE / "../shared/data"))
CONFIGURATION = SOURCE / "rt/config/examples/payload_arm.yaml"
# Hand and bias of sim/scenes/payload.yaml without cables.
MASS, CENTER = 4.8, (1.5, -0.65, 113.7)  # kg, mm


def calibrate(*words):
    return subprocess.run([BINARIES / "palpate-calibrate", *map(str, words)], capture_output=True, text=True, timeout=1200)


def fitted(test, *words):
    done = calibrate("wrist", *words, "--json", "-")
    test.assertEqual(done.returncode, 0, done.stderr)
    return json.loads(done.stdout)


class PublicRecordings(unittest.TestCase):
    """Residuals no larger than those of a plain least-squares fit of payload and bias to the same files."""

    def fit(self, name, *words):
        if not (DATA / name).is_dir():
            self.skipTest(f"{DATA / name} is absent; set PALPATE_DATA")
        return fitted(self, name, "--data", DATA, *words)

    def test_axia80_with_constant_bias_and_with_drift(self):
        constant = self.fit("ft_static_ati", "--drift", "none")
        self.assertLessEqual(constant["residuals"]["force"]["rms_norm"], 0.590)
        drifting = self.fit("ft_static_ati")
        self.assertLessEqual(drifting["residuals"]["force"]["rms_norm"], 0.090)
        self.assertEqual(drifting["polarity"], -1)

    def test_meca500_on_a_base_that_is_not_level(self):
        summary = self.fit("ft_static_meca500")
        self.assertLessEqual(summary["residuals"]["force"]["rms_norm"], 0.080)
        self.assertTrue(summary["quantities"]["gravity_tilt_x"]["determined"])

    def test_kuka_at_rest(self):
        summary = self.fit("ft_imu_kuka_ntnu")
        for rms, bar in zip(summary["residuals"]["force"]["rms"], (0.131, 0.047, 0.057)):
            self.assertLessEqual(rms, bar)
        self.assertTrue(summary["quantities"]["imu_rotation_yaw"]["determined"])
        self.assertIn("inertia_xx", [p for entry in summary["not_determined"] for p in entry["parameters"]])

    def test_panda_in_motion(self):
        summary = self.fit("ft_imu_panda")
        print("ft_imu_panda:", json.dumps(summary["residuals"]["force"]))
        self.assertFalse(summary["at_rest"])
        self.assertTrue(1.0 < summary["quantities"]["mass"]["value"] < 1.3)


class Simulated(unittest.TestCase):
    """A recording of palpate-sim, whose hand is known, and the configuration that results."""

    def setUp(self):
        if not (BINARIES / "palpate-sim").exists():
            self.skipTest("palpate-sim is not built")
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def test_the_hand_is_found_and_palpated_accepts_the_result(self):
        folder = pathlib.Path(self.folder.name)
        wander = "{duration: 24, rise: 2, seed: 5, periods: [2.5, 9], translation: [0.1, 0.1, 0.1], rotation_deg: [60, 40, 40]}"
        force_torque = ("{cable: {stiffness: 0, torsion: 0}, force: {hysteresis: 0}, torque: {hysteresis: 0}, "
                        "bias: [1.2, -0.8, 2.1, 0.05, -0.03, 0.02], warm_up: {time: 600, wrench: [0, 0, 0, 0, 0, 0]}}")
        done = subprocess.run([BINARIES / "palpate-sim", SOURCE / "sim/scenes/payload.yaml", "--record", folder, "--set",
                               f"motion={{start_delay: 1, wander: {wander}}}", "--set", f"sensors.force_torque={force_torque}"],
                              capture_output=True, text=True, timeout=1200)
        self.assertEqual(done.returncode, 0, done.stderr)
        output, plot = folder / "wrist.yaml", folder / "wrist.png"
        summary = fitted(self, folder / "sensors.log", "--config", CONFIGURATION, "--output", output, "--picture", plot)
        found = {name: entry["value"] for name, entry in summary["quantities"].items()}
        print({name: round(value, 4) for name, value in found.items()})
        self.assertLess(abs(found["mass"] / MASS - 1), 0.006)
        for axis, expected in zip("xyz", CENTER):
            self.assertLess(abs(found[f"center_of_mass_{axis}"] - expected), 0.6)
        for angle in ("roll", "pitch", "yaw"):
            self.assertLess(abs(found[f"sensor_rotation_{angle}"]), 0.3)
        self.assertLess(abs(found["wrench_delay"]), 2)
        self.assertLess(abs(found["imu_delay"] - 2.4), 2)  # 3 ms and jitter, the pose's being 1 ms
        self.assertTrue(plot.read_bytes().startswith(b"\x89PNG"))
        written = yaml.safe_load(output.read_text())
        self.assertAlmostEqual(written["sensing"][0]["payload"]["mass"], found["mass"], places=3)
        self.assertEqual(written["sensing"][0]["tare_at_start"], True)  # as in the configuration
        checked = subprocess.run([BINARIES / "palpated", "--config", output, "--check"], capture_output=True, text=True)
        self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)


class CommandLine(unittest.TestCase):
    def test_a_plan_is_written_and_drawn(self):
        with tempfile.TemporaryDirectory() as name:
            files = [pathlib.Path(name, file) for file in ("plan.yaml", "plan.png")]
            done = calibrate("wrist", "--plan", "--start", 0.6, 0, 0.5, 0, 90, 0, "--poses", 6, "--output", files[0], "--picture", files[1])
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("7 poses of the flange", done.stdout)
            self.assertEqual(len(yaml.safe_load(files[0].read_text())["poses"]), 7)
            self.assertTrue(files[1].read_bytes().startswith(b"\x89PNG"))

    def test_wrong_use(self):
        with tempfile.TemporaryDirectory() as name:
            description = pathlib.Path(name, "a.yaml")
            description.write_text("pose: 3\nwrench: {}\n")
            for words, code, expected in (
                ((), 64, "a subcommand is required"),
                (("wrist",), 64, "a recording, or --plan without one"),
                (("wrist", "--plan"), 64, "--start is required"),
                (("wrist", "--plan", "--start", 0, 0, 0, 0, 0, 0, "--poses", 3), 64, "--poses: 3; allowed: a whole number from 4 to 60"),
                (("wrist", "--no-such-option"), 64, "--help"),
                (("wrist", "no_such.log"), 1, "no_such.log"),
                (("wrist", "ft_static_ati"), 1, "--data names the folder"),
                (("wrist", description), 78, "a.yaml:1: pose: 3; allowed: a mapping of keys"),
                (("wrist", "a.log", "--config", SOURCE / "sim/scenes/payload.yaml"), 78, "sensing: no instance"),
            ):
                done = calibrate(*words)
                self.assertEqual(done.returncode, code, (words, done.stdout, done.stderr))
                self.assertIn(expected, done.stderr)

    def test_help_states_examples_and_exit_codes(self):
        for words in (("--help",), ("wrist", "--help")):
            done = calibrate(*words)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertRegex(done.stdout, r"(?m)^Examples?:$")
            self.assertEqual(done.stdout.count("Exit codes:"), 1)


if __name__ == "__main__":
    unittest.main(verbosity=2)
