"""Tuning by random search: the same number of trials for each method, all stored as CSV, the best
one selected, and existing trials not repeated.

tuning_test.py BIN_FOLDER SOURCE_FOLDER
"""
import csv
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile
import unittest

import yaml

BIN, ROOT = pathlib.Path(sys.argv.pop(1)), pathlib.Path(sys.argv.pop(1))

CONTROL = """
study: control
trials: 3
seed: 5
method_file: {folder}/methods.yaml
tuned_file: {folder}/tuned.yaml
trials_file: {folder}/trials.csv
tasks:
  - application:
      name: pull
      kind: control
      scene: sim/scenes/bar_long_soft_control_markers.yaml
      configuration: rt/config/examples/bar_long_soft.yaml
      mismatch_file: tools/lab/studies/vision.yaml
      mismatch: [noisy vision]
      seeds: [11]
      duration: 0.6
      target: {{feature: point, rest_points: [[0.25, 0.03, 0.06]], displacement: [0, 0, 0.01]}}
    all: {{control.gain: [0.3, 6]}}
    methods:
      kinematic: {{}}
      rigidity: {{control.rigidity: [0.5, 16]}}
"""
METHODS = """
kinematic: [control.provider=kinematic]
rigidity: [control.provider=diminishing_rigidity, "plugins=[{library: palpate-baselines.so}]"]
never tuned: [control.provider=constant]
"""
SENSING = """
study: published-sensing
trials: 2
seed: 5
method_file: {folder}/methods.yaml
tuned_file: {folder}/tuned.yaml
trials_file: {folder}/trials.csv
tasks:
  - application:
      name: bar
      kind: force
      scene: {folder}/scene.yaml
      configuration: rt/config/examples/bar_long_soft.yaml
      mismatch_file: tools/lab/studies/published_sensing_tuning_vision.yaml
      mismatch: [correct model, wrong model]
      seeds: [101]
    methods:
      spline: {{estimation.controls: [4, 9, whole], estimation.memory: [0.01, 1000]}}
      pose: {{}}
"""
SENSING_METHODS = """
spline: ["estimation={component: spline_fit, controls: 5}", "deformation={component: as_rigid_as_possible}", "plugins=[{library: palpate-baselines.so}]"]
pose: []
"""
SCENE = """base: {root}/sim/scenes/bar_long_soft_six_poses.yaml
motion:
  start_delay: 0.2
  poses: [{{name: up, move: 0.5, hold: 0.6, translation: [0, 0, 0.03], rotation_deg: [0, 0, 0]}}]
"""


class Tuning(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name)

    def write(self, name, text):
        (self.path / name).write_text(text, encoding="utf-8")

    def tune(self, *options):
        done = subprocess.run(
            [str(ROOT / "tools/lab/report/tune_baselines"), str(self.path / "tuning.yaml"), "--output",
             str(self.path / "out"), "--program", str(BIN / "palpate-evaluate"), *options],
            check=False, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        return done.returncode, done.stdout

    def rows(self):
        with open(self.path / "trials.csv", newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def tuned(self):
        return yaml.safe_load((self.path / "tuned.yaml").read_text(encoding="utf-8"))

    def check_best(self, method, first):
        rows = [row for row in self.rows() if row["method"] == method]
        self.assertEqual([row["trial"] for row in rows], [str(i) for i in range(len(rows))])
        self.assertEqual(rows[0]["parameters"], "", "the first trial is the entry itself")
        best = min(rows, key=lambda row: float(row["score"]))
        self.assertEqual(self.tuned()[method], first + [s for s in best["parameters"].split("; ") if s])
        for row in rows:
            self.assertEqual(row["failed"], "False")
            self.assertTrue(row["version"] and row["hash"], row)

    def test_a_search_goes_on_where_it_was_and_every_method_has_as_many_trials(self):
        self.write("tuning.yaml", CONTROL.format(folder=self.path))
        self.write("methods.yaml", METHODS)
        code, said = self.tune("--trials", "2")
        self.assertEqual(code, 0, said)
        self.assertIn("4 jobs run, 0 kept, 0 failed", said)
        two = self.rows()
        code, said = self.tune()
        self.assertEqual(code, 0, said)
        self.assertIn("2 jobs run, 4 kept, 0 failed", said)
        three = self.rows()
        self.assertEqual([row for row in three if row["trial"] != "2"], two)
        self.assertEqual({row["method"] for row in three}, {"kinematic", "rigidity"})
        self.check_best("kinematic", ["control.provider=kinematic"])
        self.check_best("rigidity", ["control.provider=diminishing_rigidity", "plugins=[{library: palpate-baselines.so}]"])
        self.assertEqual(self.tuned()["never tuned"], ["control.provider=constant"])
        for row in three:
            self.assertEqual((row["seed"], row["draw_seed"]), ("11", "5"))
            gains = [float(s.split("=")[1]) for s in row["parameters"].split("; ") if "gain" in s]
            self.assertEqual(len(gains), row["trial"] != "0")
            self.assertTrue(all(0.3 <= gain <= 6 for gain in gains), row)
        self.check_scores_are_of_the_feature(three)

    def check_scores_are_of_the_feature(self, rows):
        """The shape at the end, which a result contains too, is not a controller's score."""
        expected = {}
        for file in (self.path / "out/task1").glob("*/result.json"):
            result = json.loads(file.read_text(encoding="utf-8"))
            feature = result["score"]["feature"]
            time = feature["time_to_2mm_s"]
            expected[result["job"]["method"]] = (0.6 if time is None else time) + feature["error_mm"]
        for row in rows:
            self.assertAlmostEqual(float(row["score"]), expected[f"{row['method']} #{row['trial']}"], 3)

    def test_sensing_is_tuned_alike_and_a_failure_counts_at_the_cap(self):
        self.write("tuning.yaml", SENSING.format(folder=self.path))
        self.write("scene.yaml", SCENE.format(root=ROOT))
        self.write("methods.yaml", SENSING_METHODS)
        code, said = self.tune()
        self.assertEqual(code, 0, said)
        # A method without parameters to tune has one trial.
        self.assertEqual([(row["method"], row["trial"]) for row in self.rows()],
                         [("spline", "0"), ("spline", "1"), ("pose", "0")])
        self.check_best("spline", yaml.safe_load(SENSING_METHODS)["spline"])
        self.check_scores_are_the_mean_over_levels()
        self.assertRegex(self.rows()[1]["parameters"], r"^estimation\.controls=[4-9]; estimation\.memory=")
        self.write("methods.yaml", SENSING_METHODS.replace("controls: 5", "controls: none"))
        code, said = self.tune("--trials", "1")
        self.assertEqual(code, 0, said)
        self.assertEqual((self.rows()[0]["failed"], float(self.rows()[0]["score"])), ("True", 100))

    def check_scores_are_the_mean_over_levels(self):
        errors = {}
        for file in (self.path / "out/task1").glob("*/result.json"):
            result = json.loads(file.read_text(encoding="utf-8"))
            level = statistics.fmean(state["mean_mm"] for state in result["states"])
            errors.setdefault(result["job"]["method"], []).append(level)
        for row in self.rows():
            levels = errors[f"{row['method']} #{row['trial']}"]
            self.assertEqual(len(levels), 2)
            self.assertAlmostEqual(float(row["score"]), statistics.fmean(levels), 3)
            self.assertEqual(len(row["hash"].split()), 2)

    def test_what_is_wrong_is_said(self):
        self.write("tuning.yaml", CONTROL.format(folder=self.path).replace("rigidity:", "rigour:", 1))
        self.write("methods.yaml", METHODS)
        code, said = self.tune()
        self.assertEqual(code, 2)
        self.assertIn('"rigour" is not in', said)
        self.write("tuning.yaml", CONTROL.format(folder=self.path))
        code, said = self.tune("--only", "rigidity")
        self.assertEqual(code, 2)
        self.assertIn("--to", said)


if __name__ == "__main__":
    unittest.main()
