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

import numpy as np
import yaml

BINARIES, SOURCE = (pathlib.Path(sys.argv.pop(1)).resolve() for _ in range(2))
DATA = pathlib.Path(os.environ.get("PALPATE_DATA", SOURCE / "../shared/data"))
sys.path[:0] = [str(SOURCE / "tools/lab/camera_calibration")]

import drawn_camera  # noqa: E402
import simulated_marker  # noqa: E402
import simulated_tool  # noqa: E402
import simulated_touches  # noqa: E402

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

    def test_friction_is_found_and_palpated_accepts_the_result(self):
        folder = pathlib.Path(self.folder.name)
        wander = "{duration: 20, rise: 2, seed: 1, periods: [3, 8], translation: [0.12, 0.12, 0.12], rotation_deg: [70, 45, 45]}"
        done = subprocess.run([BINARIES / "palpate-sim", SOURCE / "sim/scenes/payload_joint_torque.yaml", "--record", folder, "--set",
                               f"motion={{start_delay: 0.5, wander: {wander}}}"], capture_output=True, text=True, timeout=1200)
        self.assertEqual(done.returncode, 0, done.stderr)
        output, plot = folder / "friction.yaml", folder / "friction.png"
        done = calibrate("friction", folder / "sensors.log", "--config", SOURCE / "rt/config/examples/wrench_joint_torque.yaml",
                         "--output", output, "--picture", plot, "--json", "-")
        self.assertEqual(done.returncode, 0, done.stderr)
        coulomb = np.array([joint["coulomb"]["value"] for joint in json.loads(done.stdout)["joints"]])
        np.testing.assert_allclose(coulomb, [1.5, 1.5, 1, 1, 0.8, 0.5, 0.4], rtol=0.05)
        self.assertTrue(plot.read_bytes().startswith(b"\x89PNG"))
        checked = subprocess.run([BINARIES / "palpated", "--config", output, "--check"], capture_output=True, text=True)
        self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)


class Camera(unittest.TestCase):
    """Set-ups of the study as files: the camera is found, and palpate-sim accepts the result."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.random = np.random.default_rng(3000)
        self.camera, self.guess = drawn_camera.draw_camera(self.random)

    def found(self, *words):
        output, picture = self.folder / "camera.yaml", self.folder / "camera.png"
        done = calibrate("camera", *words, "--json", "-", "--output", output, "--picture", picture)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue(picture.read_bytes().startswith(b"\x89PNG"))
        summary = json.loads(done.stdout)
        error = summary["camera_in_base"]["position"] - self.camera.p
        half_widths = np.array(summary["half_widths"]["position"])
        print(words[0], "error", np.round(1e3 * error, 2), "mm, 95 % within", np.round(1e3 * half_widths, 2))
        self.assertLess(np.linalg.norm(error), 4e-3)
        self.assertTrue((np.abs(error) < 2 * half_widths).all())
        self.assertEqual(np.shape(summary["covariance"]), (6, 6))
        return yaml.safe_load(output.read_text()), summary

    def write_rows(self, name, header, rows):
        path = self.folder / name
        path.write_text(header + "\n" + "".join(",".join(map(str, row)) + "\n" for row in rows))
        return path

    def write_poses(self, names, flanges):
        quaternions = [np.roll(flange.R.as_quat(), 1) for flange in flanges]
        return self.write_rows("poses.csv", "file,x,y,z,qw,qx,qy,qz",
                               [(name, *flange.p, *q) for name, flange, q in zip(names, flanges, quaternions)])

    def test_by_touches_and_the_scene_is_accepted(self):
        recording = simulated_touches.record(self.camera, self.random)
        touches = self.write_rows("touches.csv", "x,y,z,u,v,w", np.hstack([recording.touched, recording.picked]))
        np.save(self.folder / "scene.npy", recording.cloud)
        words = ("--touches", touches, "--cloud", self.folder / "scene.npy")
        written, summary = self.found(*words)
        self.assertEqual(written["camera_in_base"], summary["camera_in_base"])
        scene = SOURCE / "sim/scenes/bar_long_soft_control_camera.yaml"
        written, _ = self.found(*words, "--scene", scene)
        self.assertEqual(written["camera"]["pose"], summary["camera_in_base"])
        if (BINARIES / "palpate-sim").exists():
            port = 10000 + os.getpid() % 20000
            urls = [f"bus.{bus}=udpm://239.255.91.7:{port + i}?ttl=0" for i, bus in enumerate(("control", "housekeeping"))]
            words = ["--duration", "0.05", "--set", urls[0], "--set", urls[1]]
            checked = subprocess.run([BINARIES / "palpate-sim", self.folder / "camera.yaml", *words], capture_output=True, text=True,
                                     timeout=600)  # fmt: skip
            self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)

    def test_by_the_tool(self):
        recording = simulated_tool.record(self.camera, self.random)
        nodes, triangles = simulated_tool.hand_mesh()
        (self.folder / "hand.obj").write_text("".join(f"v {x} {y} {z}\n" for x, y, z in nodes)
                                              + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in triangles))
        names = [f"{i}.xyz" for i in range(7)]
        for name, cloud in zip(names, recording.clouds):
            np.savetxt(self.folder / name, cloud)
        poses = self.write_poses(names, recording.flanges)
        angles = self.guess.R.as_euler("xyz", degrees=True)
        self.found("--tool", self.folder / "hand.obj", "--poses", poses, "--guess", *self.guess.p, *angles)

    def test_by_a_marker(self):
        try:
            import cv2
        except ImportError:
            self.skipTest("python3-opencv is not installed")
        recording = simulated_marker.record(self.camera, self.random)
        names = [f"{i}.png" for i in range(10)]
        for name, image in zip(names, recording.images):
            cv2.imwrite(str(self.folder / name), image)
        cv2.imwrite(str(self.folder / "empty.png"), np.full((480, 640), 128, np.uint8))
        poses = self.write_poses([*names, "empty.png"], recording.flanges[:11])
        lens = self.folder / "lens.yaml"
        lens.write_text("fx: 580\nfy: 580\ncx: 320\ncy: 240\n")
        words = ("--marker", 0, "--marker-size", 0.08, "--intrinsics", lens, "--poses", poses)
        _, summary = self.found(*words)
        self.assertEqual(summary["notes"], ["The marker is not found in: empty.png"])
        lens.write_text("fx: 580\nfy: 0\ncx: 320\ncy: 240\n")
        done = calibrate("camera", *words)
        self.assertEqual(done.returncode, 78, done.stderr)
        self.assertIn("lens.yaml:2: fy: 0; allowed: a number from 10 to 100000", done.stderr)

    def test_wrong_use(self):
        touches = self.write_rows("t.csv", "x,y,z,u,v,w", [(0.1 * i, 0, 0, 0.1 * i, 0, 1) for i in range(6)])
        behind = self.write_rows("b.csv", "x,y,z,u,v,w", [(0, 0, 0, 0, 0, -1)])
        poses = self.write_rows("p.csv", "file,x,y,z,qw,qx,qy,qz", [("a.ply", 0, 0, 0, 1, 1, 0, 0)])
        for words, code, expected in (
            ((), 64, "exactly one of --touches, --tool and --marker is required"),
            (("--touches", touches, "--marker", 0), 64, "exactly one of"),
            (("--tool", "a.stl", "--poses", poses), 64, "--tool: --guess is required"),
            (("--touches", touches, "--intrinsics", "a.yaml"), 64, "--intrinsics: allowed with --marker only"),
            (("--touches", touches, "--arm-deviation", 1, 0.1), 64, "1 0.1; allowed: 1e-06 to 0.1 m"),
            (("--touches", touches), 1, "t.csv: the points lie on a line"),
            (("--touches", behind), 1, "b.csv:2: w: -1; allowed: 0.01 or more"),
            (("--touches", "no.csv"), 1, "no.csv: No such file"),
            (("--tool", "a.stl", "--poses", poses, "--guess", 0, 0, 0, 0, 0, 0), 1,
             "p.csv:2: qw,qx,qy,qz: length 1.4142; allowed: 1"),
            (("--touches", touches, "--output", "a.yaml", "--scene", CONFIGURATION), 78, "camera: is absent; required"),
        ):
            done = calibrate("camera", *words)
            self.assertEqual(done.returncode, code, (words, done.stdout, done.stderr))
            self.assertIn(expected, done.stderr)


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
                (("friction",), 64, "recording"),
                (("friction", "a.log", "--config", CONFIGURATION), 78, "no instance of joint_torque"),
            ):
                done = calibrate(*words)
                self.assertEqual(done.returncode, code, (words, done.stdout, done.stderr))
                self.assertIn(expected, done.stderr)

    def test_help_states_examples_and_exit_codes(self):
        for words in (("--help",), ("wrist", "--help"), ("friction", "--help"), ("camera", "--help")):
            done = calibrate(*words)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertRegex(done.stdout, r"(?m)^Examples?:$")
            self.assertEqual(done.stdout.count("Exit codes:"), 1)


if __name__ == "__main__":
    unittest.main(verbosity=2)
