"""A small study of control, for tests that run it in one piece and in shards.

Command line of these tests: BIN_FOLDER SOURCE_FOLDER
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

BIN, ROOT = pathlib.Path(sys.argv.pop(1)), pathlib.Path(sys.argv.pop(1))
EVALUATE = BIN / "palpate-evaluate"

PLAN = """octree_resolution: 0.02
applications:
  - name: pull
    kind: control
    scene: sim/scenes/bar_long_soft_control_markers.yaml
    configuration: rt/config/examples/bar_long_soft.yaml
    method_file: tools/lab/studies/baselines_tuned.yaml
    mismatch_file: tools/lab/studies/vision.yaml
    methods: ["palpate, model and markers", kinematic only]
    mismatch: [perfect vision, blind]
    seeds: [1]
    duration: 0.6
    target: {feature: point, rest_points: [[0.25, 0.03, 0.06]], displacement: [0, 0, 0.01]}
"""


def run(command, **variables):
    return subprocess.run([str(word) for word in command], check=False, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          env={**os.environ, "PALPATE_EVALUATE": str(EVALUATE), **variables})


class StudyTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name)
        (self.path / "plan.yaml").write_text(PLAN, encoding="utf-8")
        self.study = ["control", "--plan", self.path / "plan.yaml", "--output",
                      self.path / "out/control"]

    def tearDown(self):
        self.folder.cleanup()

    def results(self):
        files = sorted((self.path / "out/control").glob("*/result.json"))
        return [json.loads(file.read_text(encoding="utf-8")) for file in files]

    def check_report(self):
        report = run([ROOT / "tools/lab/report/report_baselines", self.path / "out"])
        self.assertEqual(report.returncode, 0, report.stdout)
        self.assertIn("Shape control, Table 2.2", report.stdout)
        rows = (self.path / "out/control.csv").read_text(encoding="utf-8").splitlines()
        self.assertEqual(len(rows), 5)
