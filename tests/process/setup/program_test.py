"""palpate-setup with palpate-sim in place of the arm: from an empty folder to the first 5 mm of motion, without a person.

usage: program_test.py BINARIES SOURCE [UNITTEST-OPTIONS]
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
BINARIES, SOURCE = (pathlib.Path(sys.argv.pop(1)).resolve() for _ in range(2))

import yaml  # noqa: E402

from simulated_cell import MASS, MODULUS, PLACE, Cell  # noqa: E402

NEEDED = ("palpate-sim", "palpated", "palpate-fit", "palpate-record", "palpate-doctor")


class Case(unittest.TestCase):
    def setUp(self):
        missing = [name for name in NEEDED if not (BINARIES / name).exists()]
        if missing:
            self.skipTest(f"not built: {', '.join(missing)}")
        folder = tempfile.TemporaryDirectory(prefix="palpate_setup_")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.cell = Cell(self.folder, BINARIES, SOURCE)

    def run_setup(self, *words, code=0):
        done = subprocess.run(["setpriv", "--pdeathsig", "TERM", BINARIES / "palpate-setup", self.folder, *map(str, words)],
                              capture_output=True, text=True, timeout=1500, stdin=subprocess.DEVNULL)
        print(done.stdout, done.stderr, flush=True)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def statuses(self):
        lines = self.run_setup("--status").splitlines()
        return {line.split()[0]: line.split()[1] for line in lines if line.strip()}

    def state(self):
        return json.loads((self.folder / "setup.json").read_text())["steps"]


class WholeChain(Case):
    def test_from_an_empty_folder_to_five_millimetres(self):
        answers = self.cell.write()
        text = self.run_setup("--answers", answers)
        self.assertIn("done: palpated --config", text)
        self.assertEqual(set(self.statuses().values()), {"done"})
        state = self.state()
        self.assertAlmostEqual(state["wrist"]["data"]["mass"], MASS, delta=0.006 * MASS)
        self.assertAlmostEqual(state["material"]["data"]["young_modulus"], MODULUS, delta=0.1 * MODULUS)
        for found, true in zip(state["registration"]["data"]["pose"]["position"], PLACE[0]):
            self.assertAlmostEqual(found, true, delta=3e-3)
        motion = state["motion"]["data"]
        for i, (commanded, measured) in enumerate(zip(motion["commanded"], motion["measured"])):
            allowed = 1e-3 if i < 3 else 1e-2  # m, rad; as the program allows
            self.assertAlmostEqual(commanded, measured, delta=allowed + 0.1 * abs(commanded))
        self.assertGreater(max(map(abs, motion["measured"])), 1e-3)
        self.assertLess(motion["left"], 1.5e-3)
        self.check_configuration()
        self.check_repetition(answers)

    def check_configuration(self):
        path = self.folder / "palpate.yaml"
        checked = subprocess.run([BINARIES / "palpated", "--config", path, "--check"], capture_output=True, text=True)
        self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)
        text = path.read_text()
        for origin in ("palpate-calibrate wrist: mass", "palpate-register: 14 touches; 95 %", "palpate-fit held_object: 95 %"):
            self.assertIn(origin, text)
        report = (self.folder / "report.html").read_text()
        for picture in ("steps/wrist/wrist.png", "steps/registration/registration.png", "steps/material/fitted/fit.png", "steps/motion/motion.png"):
            self.assertIn(picture, report)
            self.assertTrue((self.folder / picture).read_bytes().startswith(b"\x89PNG"), picture)

    def check_repetition(self, answers):
        """A heavier object makes what depends on it outdated; the wrist stays done."""
        self.cell.write(object={"mass": 0.06})
        self.run_setup("--answers", answers, "--step", "object")
        statuses = self.statuses()
        self.assertEqual(statuses["wrist"], "done")
        self.assertEqual([statuses[name] for name in ("object", "registration", "material", "motion")], ["done", *["outdated"] * 3])


class Stops(Case):
    """Each with a reason, recorded, and with the documented exit code."""

    def test_without_an_arm(self):
        del self.cell.answers["commands"]
        answers = self.cell.write(channels={"seconds": 0.5})
        text = self.run_setup("--answers", answers, "--skip", "machine", code=1)
        self.assertIn("ROBOT_STATE: no message; required", text)
        self.assertIn("ROBOT_STATE", self.state()["channels"]["reason"])
        self.assertEqual(self.statuses()["channels"], "failed")

    def test_with_a_mesh_that_does_not_fit(self):
        skipped = ("machine", "channels", "wrist")
        answers = self.cell.write(channels={"has_imu": True}, wrist={"mass": 4.8, "center_of_mass": [0, 0, 0.1]},
                                  object={"size": [0.55, 0.066, 0.066], "grasp": [0.5, 0.033, 0.033]})
        text = self.run_setup("--answers", answers, *(word for name in skipped for word in ("--skip", name)), code=1)
        self.assertIn("the mesh does not fit", text)

    def test_wrong_answers_and_a_wrong_command_line(self):
        answers = self.cell.write(channels={"force": -1})
        text = self.run_setup("--answers", answers, "--skip", "machine", code=78)
        self.assertIn("channels.force", text)
        self.assertIn("0.01 to 10000", text)
        self.run_setup("--step", "nonsense", code=64)
        self.run_setup("--step", "wrist", "--skip", "wrist", code=64)
        text = self.run_setup("--answers", answers, "--step", "motion", code=1)
        self.assertIn("motion needs wrist", text)


if __name__ == "__main__":
    unittest.main()
