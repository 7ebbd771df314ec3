"""The report on published methods: the ranking, the handling of the cap, the contents of the
files.
"""
import csv
import importlib.machinery
import importlib.util
import io
import json
import os
import pathlib
import re
import sys
import tempfile
import unittest
from contextlib import redirect_stderr, redirect_stdout

sys.dont_write_bytecode = True
HERE = pathlib.Path(os.environ["PALPATE_SOURCE_DIR"]) / "tools/lab/report"
sys.path.insert(0, str(HERE))
from baselines import runs as baseline_runs  # noqa: E402
from baselines.statistics import differences, interval, mean_difference, verdict  # noqa: E402
from baselines.tuning import read_trials, words  # noqa: E402

loader = importlib.machinery.SourceFileLoader("report_baselines", str(HERE / "report_baselines"))
spec = importlib.util.spec_from_loader("report_baselines", loader)
report_baselines = importlib.util.module_from_spec(spec)
loader.exec_module(report_baselines)

OURS, SECOND = "palpate, model and markers", "palpate, pose and wrench"
FAST, SLOW, LIKE = "kinematic only", "Broyden with probing [44]", "adaptive 3-D [46]"


def control_result(method, level, seed, time, error, application="pull"):
    return {"inputs_hash": "h", "version": "9.9", "job": {
        "application": application, "method": method, "seed": seed, "model_error": level},
        "score": {"feature": {"duration_s": 15, "error_mm": error, "start_error_mm": 40,
                              "overshoot_percent": 1, "path_mm": 44, "time_to_5mm_s": 1,
                              "time_to_2mm_s": time, "time_to_1mm_s": None}},
        "control": {"plant": {"time_s": [0, 1, 15], "mm": [40, 3, error]}}}


def sensing_result(method, seed, mean):
    return {"inputs_hash": "h", "version": "9.9", "job": {
        "application": "bar", "method": method, "seed": seed, "model_error": "noisy vision"},
        "states": [{"mean_mm": mean, "hausdorff_mm": 2 * mean, "max_mm": 3 * mean},
                   {"mean_mm": 1000, "hausdorff_mm": 1000, "max_mm": 1000}],
        "shape_error": {"time_s": [0, 1], "mean_mm": [mean, mean], "max_mm": [mean, mean]}}


class Report(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name)
        self.count = 0

    def tearDown(self):
        self.folder.cleanup()

    def put(self, study, result):
        self.count += 1
        place = self.path / study / f"job{self.count}"
        place.mkdir(parents=True)
        (place / "result.json").write_text(json.dumps(result), encoding="utf-8")

    def report(self):
        said = io.StringIO()
        argv, sys.argv = sys.argv, ["report_baselines", str(self.path)]
        try:
            with redirect_stdout(said):
                self.assertEqual(report_baselines.main(), 0)
        finally:
            sys.argv = argv
        return said.getvalue().splitlines(), (self.path / "baselines.html").read_text(encoding="utf-8")

    def test_first_lines_name_only_methods_that_win_or_tie(self):
        for seed in (1, 2, 3):
            self.put("control", control_result(OURS, "blind", seed, 2 + 0.01 * seed, 1.5))
            self.put("control", control_result(FAST, "noisy vision", seed, 1, 3))
            self.put("control", control_result(SLOW, "noisy vision", seed, None, 5))
            self.put("control", control_result(LIKE, "noisy vision", seed, 4, 1.55))
        lines, html = self.report()
        self.assertIn("2 of 3 other methods win or tie", lines[0])
        self.assertIn(f"Win somewhere: {FAST}. Only tie: {LIKE}.", lines[0])
        self.assertIn("by time to stay within 2 mm win: " + FAST, lines[1])
        self.assertIn("by error at the end tie: " + LIKE, lines[1])
        self.assertNotIn(SLOW, lines[1])
        # They precede any table, and each method has its page.
        self.assertLess(html.index("2 of 3 other methods"), html.index("<table>"))
        for method in (OURS, FAST, SLOW, LIKE):
            self.assertIn(f"<h2>{method}</h2>", html)
        self.assertIn("<td>ahead / behind</td>", html)
        self.assertIn("+12.98", html)  # a run that never settles is behind by the cap
        self.assertIn("data:image/svg+xml", html)

    def test_who_wins_on_one_task_alone_is_named_with_it_and_rows_name_their_seeds(self):
        for seed in (1, 2):
            for task, theirs in (("pull", 14), ("push", 1)):
                self.put("control", control_result(OURS, "blind", seed, 2, 1.5, task))
                if seed == 1 or task == "pull":
                    self.put("control", control_result(SLOW, "blind", seed, theirs, 5, task))
        lines, html = self.report()
        self.assertIn("0 of 1 other methods win or tie", lines[0])
        self.assertIn(f" win on a single task: {SLOW} (push).", lines[0])
        self.assertIn("<td>1, 2</td>", html)
        text = (self.path / "baselines.md").read_text(encoding="utf-8")
        self.assertIn(lines[0], text)
        self.assertIn(f"| {SLOW} | 5.00, 14.0 s | 1, 2 |", text)
        self.assertIn(f"| {SLOW} | 5.00, 1.0 s | 1 |", text)

    def test_a_failed_job_counts_at_the_cap(self):
        self.put("control", control_result(OURS, "blind", 1, 2, 1))
        self.put("control", control_result(FAST, "blind", 1, 3, 1))
        (self.path / "control/runs.csv").write_text(
            "application,method,model_error,seed,outcome\n"
            f"pull,{SLOW},blind,1,failed\n\"pull\",{FAST},blind,1,failed\n", encoding="utf-8")
        self.report()
        with open(self.path / "control.csv", newline="", encoding="utf-8") as file:
            rows = {row["method"]: row for row in csv.DictReader(file)}
        self.assertEqual(len(rows), 3)
        self.assertEqual(rows[SLOW]["failed"], "True")
        self.assertEqual(float(rows[SLOW]["time_2mm"]), 15)
        self.assertEqual(float(rows[SLOW]["error"]), 40)
        # It has a result now: an older record of its failure does not count.
        self.assertEqual(rows[FAST]["failed"], "False")
        self.assertEqual(rows[FAST]["seed"], "1")
        self.assertEqual(rows[FAST]["version"], "9.9")

    def test_sensing_is_capped_and_has_pages(self):
        self.put("sensing", sensing_result("palpate, pose and wrench, blind", 1, 1.0))
        self.put("sensing", sensing_result("[31] spline fit, Jordt", 1, 0.4))
        lines, html = self.report()
        self.assertIn("1 of 1 other methods win or tie", lines[0])
        self.assertIn("by mean error of the shape win: [31] spline fit, Jordt", lines[1])
        self.assertIn("<h2>[31] spline fit, Jordt</h2>", html)
        self.assertIn("[32]", html)
        with open(self.path / "sensing.csv", newline="", encoding="utf-8") as file:
            means = sorted(float(row["mean"]) for row in csv.DictReader(file))
        self.assertAlmostEqual(means[0], (0.4 + 100) / 2)

    def test_nothing_to_report_is_said(self):
        sys.argv = ["report_baselines", str(self.path)]
        with self.assertRaises(SystemExit) as end:
            report_baselines.main()
        self.assertIn("neither control/ nor sensing/", str(end.exception))

    def test_a_method_keeps_its_results_when_it_is_renamed(self):
        (before, now), = baseline_runs.RENAMED.items()
        self.put("sensing", sensing_result(before, 1, 1.0))
        with redirect_stderr(io.StringIO()) as warned:
            runs = baseline_runs.sensing_runs(self.path / "sensing")
        self.assertEqual([run["method"] for run in runs], [now])
        self.assertIn(f'method "{before}" is called "{now}" now', warned.getvalue())

    def test_a_method_without_a_page_is_refused(self):
        self.put("control", control_result("unheard of", "blind", 1, 2, 1))
        sys.argv = ["report_baselines", str(self.path)]
        with self.assertRaises(SystemExit) as end:
            report_baselines.main()
        self.assertIn("unheard of", str(end.exception))


class Tuning(unittest.TestCase):
    def test_trials_are_counted_and_the_best_is_named(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "trials.csv"
            self.assertEqual(read_trials(file), {})
            file.write_text("method,trial,parameters,score,seed,version\na,0,,3.5,1,9\n"
                            "a,1,x=2,1.25,1,9\nb,0,,2,1,9\n", encoding="utf-8")
            trials = read_trials(file)
        self.assertEqual(words("a", trials), "2 trials at random, the best #1 with 1.25")
        self.assertIn("nothing to tune", words("b", trials))
        self.assertIn("trained", words("c", trials))


class Statistics(unittest.TestCase):
    def test_interval_holds_the_median(self):
        self.assertEqual(interval([3.0]), (3.0, 3.0, 3.0))
        middle, low, high = interval([1.0, 2.0, 3.0, 4.0, 10.0])
        self.assertEqual(middle, 3.0)
        self.assertLess(low, middle)
        self.assertGreater(high, middle)

    def test_differences_pair_tasks_and_seeds(self):
        def run(task, seed, value):
            return {"application": task, "seed": seed, "t": value}
        by_task = differences([run("a", 1, 1), run("a", 2, 2), run("b", 1, 5)],
                              [run("a", 1, 2), run("a", 2, 4), run("a", 3, 9), run("c", 1, 0)], "t")
        self.assertEqual(by_task, {"a": [1, 2]})
        mean, low, high = mean_difference({"a": [1, 2], "b": [10]})
        self.assertEqual(mean, 5.75)
        self.assertEqual((low, high), (5.5, 6.0))

    def test_verdicts(self):
        self.assertEqual(verdict(-1, -2, -0.5, 0.1), "ahead")
        self.assertEqual(verdict(1, 0.5, 2, 0.1), "behind")
        self.assertEqual(verdict(1, -0.5, 2, 0.1), "tie")
        self.assertEqual(verdict(0.05, 0.04, 0.06, 0.1), "tie")


def code_lines(header):
    """Header and source of a component, without blank lines and comments."""
    count = 0
    for file in (header, header.with_suffix(".cpp")):
        if file.exists():
            text = re.sub(r"//.*", "", file.read_text(encoding="utf-8"))
            count += sum(1 for line in text.splitlines() if line.strip())
    return count


class Components(unittest.TestCase):
    """Every published method's own code: short, and documented at its head."""

    ROOT = HERE.parents[2]

    def sources(self):
        """Headers below tools/lab/baselines by method."""
        for name in ("published_control_methods.yaml", "published_sensing_pages.yaml"):
            for method, page in report_baselines.load(name)["methods"].items():
                headers = [self.ROOT / source for source in page["source"].split(", ")
                           if source.startswith(("tools/lab/baselines/control/", "tools/lab/baselines/sensing/"))]
                if headers and page["row"] != "ours":
                    yield method, headers

    def test_each_is_under_200_lines(self):
        headers = [h for folder in ("control", "sensing")
                   for h in sorted((self.ROOT / f"tools/lab/baselines/{folder}").glob("*.hpp"))]
        self.assertGreater(len(headers), 35)
        for header in headers:
            self.assertLess(code_lines(header), 200, header.name)

    def test_each_declares_what_it_consumes_keeps_and_leaves_out_and_cites(self):
        methods = dict(self.sources())
        self.assertGreater(len(methods), 25)
        for method, headers in methods.items():
            text = " ".join(re.sub(r"(?m)^ *///? ?", "", "".join(
                header.read_text(encoding="utf-8") for header in headers)).split())
            for words in (r"\bConsumes: ", r"\b[Kk]ept(: | are )", r"\bLeft out: ",
                          r"\b(19|20)\d\d\b|\[\d\d\]"):
                self.assertTrue(re.search(words, text), f"{method}: {words} in {headers}")


class Pages(unittest.TestCase):
    def test_every_method_of_the_plans_has_a_page_and_every_row_a_method_or_a_reason(self):
        plan = report_baselines.load("published_sensing.yaml")
        about = report_baselines.load("published_sensing_pages.yaml")
        methods = {m for a in plan["applications"] for m in a["methods"]}
        self.assertEqual(methods, set(about["methods"]))
        for method, page in about["methods"].items():
            for source in page["source"].split(","):
                self.assertTrue((HERE.parents[2] / source.strip()).exists(), source)
            for key in ("consumes", "keeps", "leaves out"):
                self.assertIn(key, page, method)
        of_method = {m: str(page["row"]).split(", ") for m, page in about["methods"].items()}
        rows = {row for own in of_method.values() for row in own}
        rows |= {str(entry["row"]) for entry in about["no score"]}
        self.assertLessEqual({str(row) for row in range(26, 43)}, rows)
        # A row with a score has it on at least two tasks.
        for row in rows - {"ours", "baseline"}:
            names = [m for m, own in of_method.items() if row in own]
            tasks = sum(any(m in a["methods"] for m in names) for a in plan["applications"])
            self.assertTrue(not names or tasks >= 2, row)


if __name__ == "__main__":
    unittest.main()
