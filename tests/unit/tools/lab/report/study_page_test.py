"""The page of a study: complete, without markup from names, and independent of other files."""
import base64
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
HERE = pathlib.Path(os.environ["PALPATE_SOURCE_DIR"]) / "tools/lab/report"
sys.path.insert(0, str(HERE))
from study_page import page_of, panels_of  # noqa: E402

NASTY = "a <script>\"b\" & 'c', d"


def run(method, seed, states, **parts):
    return {"job": {"name": f"job_{seed}", "application": NASTY, "method": method, "model_error": "none",
                    "seed": seed}, "states": states, **parts}


def study(runs, kind="control"):
    return {"version": "9.9", "title": "the applications of the thesis", "octree_resolution_mm": 10,
            "host": {"cores": 4, "load": [0.5, 1]}, "failures": ["job_3: exit code 1:\n<b>what happened</b>"],
            "overview": {"title": "All applications together", "header": ["method", "runs"],
                         "rows": [["model error: none"], ["first", "2"]]},
            "applications": [{"name": NASTY, "kind": kind, "note": "a note", "scene": "bar.yaml",
                              "configuration": "bar_soft.yaml", "model_errors": ["none"],
                              "methods": ["first", "second"],
                              "tables": [{"title": "Published", "header": ["published in the thesis", "value"],
                                          "rows": [["error of <Fig. 4.15>", "not available"]]}]}],
            "runs": runs}


STATES = [{"name": "P1", "picture": "state.png", "measured": "camera", "pose_mm": 0.0},
          {"name": "P2", "picture": "", "pose_mm": 2.5}]
CONTROL = {"plant": {"time_s": [0, 1], "mm": [40, 0.001], "deg": [3, 2]},
           "estimate": {"time_s": [0, 1], "mm": [41, 2], "deg": [3, 1]},
           "command": {"time_s": [0, 1], "mm_per_s": [0, 5]}}


class Page(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_no_text_is_markup(self):
        page = page_of(study([]), self.folder)
        for tag in ("<script>", "<b>", "<Fig"):
            self.assertNotIn(tag, page)
        self.assertIn("a &lt;script&gt;&#34;b&#34; &amp; &#39;c&#39;, d", page)
        self.assertIn("&lt;b&gt;what happened", page)
        self.assertIn("<td>error of &lt;Fig. 4.15&gt;</td><td>not available</td>", page)

    def test_it_has_host_tables_with_titles_and_settings(self):
        page = page_of(study([]), self.folder)
        for text in ("<td>version</td><td>9.9</td>", "<td>load</td><td>[0.5,1]</td>", "a note",
                     '<td class="title" colspan="2">model error: none</td>', "octree resolution 10.0 mm",
                     "<h2>Jobs that failed</h2>", "<h3>Published</h3>"):
            self.assertIn(text, page)

    def test_pictures_and_plots_of_the_first_seed_are_in_the_page(self):
        page = page_of(study([run("first", 1, STATES, control=CONTROL)]), self.folder)
        self.assertIn("P1, first, model error: none, seed 1: measured (camera), estimate, both: no picture", page)
        (self.folder / "job_1").mkdir()
        (self.folder / "job_1/state.png").write_bytes(b"\x89PNG")
        page = page_of(study([run("first", seed, STATES, control=CONTROL) for seed in (1, 2)]), self.folder)
        self.assertEqual(re.findall('src="data:image/png;base64,([^"]*)"', page),
                         [base64.b64encode(b"\x89PNG").decode()])
        plots = re.findall('src="data:image/svg[^,]*,([^"]*)"', page)
        self.assertEqual(len(plots), 1)
        drawn = base64.b64decode(plots[0]).decode()
        self.assertIn("first, estimate", drawn)
        self.assertIn("Commanded speed, model error: none", drawn)
        self.assertEqual(len(list(self.folder.glob("*.svg"))), 1)

    def test_plots_are_those_of_the_kind_and_only_with_curves(self):
        parts = {"control": CONTROL, "shape_error": {"time_s": [0], "mean_mm": [0], "max_mm": [1]},
                 "belief": {"curve": {"time_s": [0], "young_modulus_kpa": [30]}}}
        runs = [run("first", 1, STATES, **parts), run("second", 1, STATES)]
        titles = [panel["title"].split(",")[0] for panel in panels_of("control", runs, "none")]
        self.assertEqual(titles, ["Mean shape error", "Distance of the feature from its target",
                                  "Angle from the target", "Commanded speed", "Young's modulus"])
        shape, pose, modulus = panels_of("force", runs, "none")
        self.assertEqual(shape["curves"][0]["y"], [1e-3])  # an axis of logarithms has no zero
        self.assertEqual([line["y"] for line in pose["curves"]], [(1e-3, 2.5)] * 2)
        self.assertEqual([line["colour"] for line in pose["curves"]], [0, 1])
        self.assertFalse(modulus["logarithmic"])


class Program(unittest.TestCase):
    def report(self, text, *options):
        with tempfile.TemporaryDirectory() as name:
            file = pathlib.Path(name) / "thesis.json"
            file.write_text(text, encoding="utf-8")
            done = subprocess.run([sys.executable, *options, HERE / "report_study", file], check=False, text=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
            return done, (file.parent / "report.html").exists()

    def test_the_page_is_next_to_the_data(self):
        done, made = self.report(json.dumps(study([])))
        self.assertEqual((done.returncode, done.stdout, made), (0, "", True))

    def test_a_missing_package_is_named(self):
        done, made = self.report(json.dumps(study([])), "-S")  # no site's packages
        self.assertEqual((done.returncode, made), (1, False))
        self.assertIn("missing Python package: python3-jinja2, python3-matplotlib", done.stdout)

    def test_data_of_an_earlier_version_are_refused_with_the_remedy(self):
        done, made = self.report('{"version": "0.1", "runs": []}')
        self.assertEqual((done.returncode, made), (1, False))
        self.assertIn("--report-only", done.stdout)


if __name__ == "__main__":
    unittest.main()
