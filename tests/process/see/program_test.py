"""palpate-see from files, logs and the network to observations: outputs, counters, errors, exit codes.

usage: program_test.py BINARIES SOURCE
"""
import json
import os
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

BINARIES, SOURCE = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ["PALPATE_SOURCE_DIR"] = str(SOURCE)
sys.path[:0] = [str(BINARIES.parent / "python"), str(SOURCE / "tests/unit/tools/see")]

import numpy as np  # noqa: E402

import palpate  # noqa: E402
from palpate.udpm import Transport  # noqa: E402
from support import URDF, encoded_cloud  # noqa: E402

PROGRAM = BINARIES / "palpate-see"
CHANNEL = "SHAPE_OBSERVATION"
# The camera looks down from 1.3 m; the bar's upper side is at 0.34 m, the table's at 0.28 m.
CONFIGURATION = """
camera_in_base: {{position: [1.0, 0, 1.3], rpy_deg: [180, 0, 0]}}
configuration: palpated.yaml
bus: {{control: "{url}"}}
crop: {{lower: [0.5, -0.5, 0], upper: [1.5, 0.5, 1]}}
intrinsics: {{width: 160, height: 120, fx: 146, fy: 146}}
"""
PALPATED = "obstacles:\n  - {name: table, shape: half_space, pose: {position: [0, 0, 0.28]}}\n"
RANDOM = np.random.default_rng(4)


def private_url():
    generator = random.SystemRandom()
    address = f"239.255.{generator.randint(160, 250)}.{generator.randint(1, 250)}"
    return f"udpm://{address}:{generator.randint(10000, 32000)}?ttl=0"


def scene():
    """(n, 3), m, in the camera's frame: what is seen of the table, and of the bar."""
    table = np.column_stack([RANDOM.uniform(-0.4, 0.4, 6000), RANDOM.uniform(-0.3, 0.3, 6000), np.full(6000, 1.02)])
    is_hidden = (np.abs(table[:, 0] / 1.02 - 0.104) < 0.215) & (np.abs(table[:, 1] / 1.02) < 0.036)  # by the bar
    bar = np.column_stack([RANDOM.uniform(-0.1, 0.3, 2000), RANDOM.uniform(-0.03, 0.03, 2000), np.full(2000, 0.96)])
    return table[~is_hidden].astype(np.float32), bar.astype(np.float32)


TABLE, BAR = scene()
SEEN = np.vstack([TABLE, BAR])


def depth_image():
    """(120, 160), mm: a bar over a table."""
    image = np.full((120, 160), 1020, np.uint16)
    image[50:70, 30:130] = 960
    return image


def state(utime, angle=0.0):
    """ROBOT_STATE of seven joints at the same angle, rad, encoded."""
    message = palpate.messages.robot_state_t()
    message.utime, message.joint_count = utime, 7
    message.q[:7] = [angle] * 7
    return message.encode()


def run(*words, timeout=120):
    return subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, timeout=timeout)


class Case(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.url = private_url()
        self.write("")

    def write(self, more):
        (self.folder / "palpated.yaml").write_text(PALPATED)
        self.config = self.folder / "see.yaml"
        self.config.write_text(CONFIGURATION.format(url=self.url) + more)

    def log(self, utimes, joints=(), name="run.log"):
        """An LCM log of clouds, and of states of seven joints."""
        path = self.folder / name
        with palpate.EventLogWriter(path) as writer:
            for utime in joints:
                writer.write(utime, "ROBOT_STATE", state(utime))
            for utime in utimes:
                writer.write(utime + 2000, "POINT_CLOUD", encoded_cloud(SEEN.tolist(), utime))
        return path

    def is_the_bar(self, points):
        self.assertGreater(len(points), 100)
        self.assertLessEqual(len(points), 256)
        np.testing.assert_allclose(points[:, 2], 0.34, atol=1e-3)


class Offline(Case):
    def test_a_log_to_a_log(self):
        out = self.folder / "seen.log"
        done = run("--config", self.config, "--log", self.log([1000, 34000, 20000, 67000]), "--output", out, "--json", "-")
        self.assertEqual(done.returncode, 0, done.stderr)
        counters = json.loads(done.stdout)
        clouds = counters["clouds"]
        self.assertEqual((clouds["received"], clouds["out_of_order"], clouds["published"]), (4, 1, 3))
        self.assertEqual(counters["points"]["obstacles"], 3 * len(TABLE))
        self.assertIn("clouds: 4 received, 1 out of order, 3 published", done.stderr)
        seen = palpate.read_log(out)[CHANNEL]
        self.assertEqual(seen.sent_utime.tolist(), [1000, 34000, 67000])
        self.assertEqual([message.seq for message in seen], [0, 1, 2])
        for message in seen:
            self.is_the_bar(np.array(message.points)[: message.count])
            # At 0.96 m, with the camera's error: 0.72 mm and 0.072 degree.
            self.assertAlmostEqual(message.deviation, 2.29e-3, delta=2e-5)

    def test_the_same_log_gives_the_same_bytes(self):
        log = self.log([1000, 34000])
        for name in ("a.log", "b.log"):
            self.assertEqual(run("--config", self.config, "--log", log, "--output", self.folder / name).returncode, 0)
        self.assertEqual((self.folder / "a.log").read_bytes(), (self.folder / "b.log").read_bytes())

    def test_clouds_and_images_of_files_to_a_table(self):
        from PIL import Image

        clouds, images = self.folder / "clouds", self.folder / "images"
        clouds.mkdir(), images.mkdir()
        for utime in (1000, 2000):
            np.save(clouds / f"cloud_{utime}.npy", SEEN)
            Image.fromarray(depth_image()).save(images / f"depth_{utime}.png")
        for option, folder in (("--clouds", clouds), ("--images", images)):
            out = self.folder / "seen.csv"
            done = run("--config", self.config, option, folder, "--output", out)
            self.assertEqual(done.returncode, 0, done.stderr)
            rows = np.genfromtxt(out, delimiter=",", names=True)
            self.assertEqual(sorted(set(rows["utime"])), [1000, 2000])
            first = rows[rows["utime"] == 1000]
            self.is_the_bar(np.column_stack([first["x"], first["y"], first["z"]]))
            self.assertIn("points:", done.stdout)

    def test_joint_states_of_a_log(self):
        self.write(f"robot: {{urdf: {URDF}, hand_joints: [], most_gap_ms: 10}}\n")
        log = self.log([1000, 34000], joints=[1000, 2000])
        done = run("--config", self.config, "--log", log, "--output", self.folder / "a.csv", "--json", "-")
        counters = json.loads(done.stdout)["clouds"]
        self.assertEqual((counters["published"], counters["without_joints"]), (1, 1))
        np.save(self.folder / "c_1500.npy", SEEN)
        listed = self.folder / "list.csv"
        listed.write_text("utime,file\n1500,c_1500.npy\n")
        for words, published in (([], 0), (["--joints", log], 1)):
            done = run("--config", self.config, "--clouds", listed, "--output", self.folder / "a.csv", "--json", "-", *words)
            self.assertEqual(json.loads(done.stdout)["clouds"]["published"], published, done.stderr)

    def test_the_result_is_what_palpated_and_its_tools_read(self):
        out = self.folder / "seen.log"
        run("--config", self.config, "--log", self.log([1000, 34000]), "--output", out)
        exporter = BINARIES / "palpate-export"
        if not exporter.exists():
            self.skipTest("palpate-export is not built")
        words = [exporter, "csv", out, "--quiet", "--output", self.folder / "csv"]
        done = subprocess.run(words, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)


class Live(Case):
    def test_observations_of_what_is_published_and_an_end_by_a_signal(self):
        try:
            sender = Transport(self.url)
        except OSError as error:
            self.skipTest(f"multicast does not work here: {error}")
        self.addCleanup(sender.close)
        over = threading.Event()
        self.write(f"robot: {{urdf: {URDF}, hand_joints: [], most_gap_ms: 500}}\n")

        def send():
            while not over.wait(0.1):
                utime = time.time_ns() // 1000
                for ahead, angle in ((0, 0.0), (0, float("nan")), (10**12, 0.0)):
                    sender.publish("ROBOT_STATE", state(utime + ahead, angle))
                sender.publish("ROBOT_STATE", b"malformed")
                sender.publish("POINT_CLOUD", encoded_cloud(SEEN.tolist(), utime))
                sender.publish("POINT_CLOUD", b"malformed")

        with palpate.Bus(self.url) as bus:
            subscription = bus.subscribe(CHANNEL)
            words = [PROGRAM, "--config", self.config, "--json", self.folder / "all.json"]
            words += ["--output", self.folder / "seen.log"]
            program = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
            thread = threading.Thread(target=send)
            thread.start()
            try:
                messages = [subscription.get(60) for _ in range(3)]
                time.sleep(1.2)
            finally:
                over.set()
                thread.join()
                program.send_signal(signal.SIGTERM)
                output, _ = program.communicate(timeout=30)
        self.assertEqual(program.returncode, 0)
        self.assertEqual([message.seq for message in messages], [0, 1, 2])
        for message in messages:
            self.is_the_bar(np.array(message.points)[: message.count])
        self.assertGreaterEqual(output.count("clouds:"), 2)  # once a second, and at the end
        counters = json.loads((self.folder / "all.json").read_text())
        self.assertGreater(counters["clouds"]["malformed"], 0)
        self.assertGreaterEqual(counters["refused_states"], 3)  # not finite, ahead of the clock, malformed
        self.assertEqual(len(palpate.read_log(self.folder / "seen.log")[CHANNEL]), counters["clouds"]["published"])

    def test_ends_after_the_given_time(self):
        done = run("--config", self.config, "--seconds", 0.3)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("clouds: 0 received, 0 published", done.stdout)


class Refusals(Case):
    def test_wrong_command_lines_end_with_64(self):
        for words in (["--no-such-option"], [], ["--config", self.config, "--log", "a", "--clouds", "b", "--output", "c"],
                      ["--config", self.config, "--log", "a"], ["--config", self.config, "--seconds", "0"],
                      ["--config", self.config, "--joints", "a"]):  # fmt: skip
            done = run(*words)
            self.assertEqual(done.returncode, 64, words)
            self.assertIn("--help", done.stderr)

    def test_help_states_the_exit_codes_once(self):
        done = run("--help")
        self.assertEqual((done.returncode, done.stdout.count("Exit codes:")), (0, 1))

    def test_wrong_configurations_end_with_78(self):
        self.assertEqual(run("--config", self.config, "--check").returncode, 0)
        self.write("noise: {base: 1}\n")
        done = run("--config", self.config, "--check")
        self.assertEqual(done.returncode, 78)
        self.assertIn("see.yaml:7: noise.base: 1; allowed: a number from 1e-05 to 0.1", done.stderr)
        self.config.write_text("camera_in_base: {}\n")
        done = run("--config", self.config, "--images", self.folder, "--output", self.folder / "a.csv")
        self.assertEqual(done.returncode, 78)
        self.assertIn("see.yaml: intrinsics: is absent; required by --images", done.stderr)

    def test_wrong_files_end_with_1_and_leave_no_output(self):
        out = self.folder / "seen.log"
        (self.folder / "a.log").write_bytes(b"no log at all" * 10)
        (self.folder / "list.csv").write_text("utime,file\n1,none.ply\n")
        states = self.log([], joints=[1], name="states.log")
        for words, text in ((["--log", self.folder / "a.log"], "is no LCM event log"),
                            (["--log", self.folder / "b.log"], "b.log: No such file"),
                            (["--log", states], "has no POINT_CLOUD; allowed as channel of the configuration: ROBOT_STATE"),
                            (["--clouds", self.folder / "list.csv"], "none.ply: No such file"),
                            (["--images", self.folder], "holds no file of .png")):  # fmt: skip
            done = run("--config", self.config, *words, "--output", out)
            self.assertEqual(done.returncode, 1, words)
            self.assertIn(text, done.stderr)
            self.assertFalse(out.exists())

    def test_a_wrong_url_ends_with_1(self):
        self.url = "tcp://1.2.3.4"
        self.write("")
        done = run("--config", self.config, "--seconds", 1)
        self.assertEqual(done.returncode, 1)
        self.assertIn("tcp://1.2.3.4", done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
