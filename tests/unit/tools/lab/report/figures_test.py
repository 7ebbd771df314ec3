"""Figures of the documentation, and tables of drawn model errors."""
import argparse
import contextlib
import copy
import io
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
from importlib.machinery import SourceFileLoader

import yaml

sys.dont_write_bytecode = True
FOLDER = pathlib.Path(os.environ["PALPATE_SOURCE_DIR"]) / "tools/lab/report"
sys.path.insert(0, str(FOLDER))
import figure_tables  # noqa: E402
import figures  # noqa: E402

DECLARED = {"sag": {"command": "bench --sag | tee", "read": {"mm": "/mm"}, "inputs": ["tools/x"],
                    "rows": [{"what": "sag", "figure": "{mm:.1f} mm"}]},
            "hand": {"command": "by hand", "rows": [{"what": "one"}, {"what": "two"}]}}
STORED = {"sag": {"command": "bench --sag | tee", "commit": "0123456789", "date": "2026-01-02T00:00", "values": {"mm": 1.26}, "inputs": {}},
          "hand": {"commit": "", "texts": ["2 s", "3 s"]}}
PAGE = "# Page\n\n<!-- figures sag hand -->\n<!-- end of figures -->\n\nIt sags by 1.3 mm<!-- = sag.mm:.1f mm -->.\n"


class Pages(unittest.TestCase):
    def setUp(self):
        self.page = figures.written(PAGE, DECLARED, STORED)

    def wrong(self, page, stored=None):
        return figures.differences("page.md", page, DECLARED, stored or STORED)

    def test_a_written_page_is_as_stored(self):
        self.assertIn("| sag | 1.3 mm | `bench --sag \\| tee` | 01234567, 2026-01-02 |", self.page)
        self.assertIn("| two | 3 s | the same | earlier |", self.page)
        self.assertEqual(self.wrong(self.page), [])
        self.assertEqual(figures.written(self.page, DECLARED, STORED), self.page)

    def test_any_other_figure_is_found(self):
        for old, new in (("| 1.3 mm |", "| 1.2 mm |"), ("by 1.3 mm", "by 1.2 mm"), ("| 3 s |", "| 2 s |"), ("| one | 2 s", "| one, | 2 s"),
                         ("sag.mm", "sag.cm"), ("figures sag hand", "figures sag foot")):
            self.assertNotEqual(self.wrong(self.page.replace(old, new)), [], new)

    def test_each_figure_of_a_line_is_compared(self):
        line = "From 1<!-- = sag.mm:.0f --> to {}<!-- = sag.mm:.2f mm -->.\n"
        self.assertEqual(self.wrong(line.format("1.26 mm")), [])
        self.assertEqual(len(self.wrong(line.format("1.27 mm"))), 1)

    def test_figures_in_sentences_are_written(self):
        stored = copy.deepcopy(STORED)
        stored["sag"]["values"]["mm"] = 24.86
        page = figures.written(self.page, DECLARED, stored)
        self.assertIn("It sags by 24.9 mm<!--", page)
        self.assertEqual(self.wrong(page, stored), [])

    def test_another_result_is_found(self):
        stored = copy.deepcopy(STORED)
        stored["sag"]["values"]["mm"] = 1.36
        self.assertEqual(len(self.wrong(self.page, stored)), 3)  # the row, what it should be, the sentence

    def test_figures_without_a_result_are_found(self):
        self.assertEqual(figures.uncited(self.page), [])
        self.assertEqual(figures.uncited("| `a 1` | [2](x3) | text |\n"), [])
        self.assertEqual(len(figures.uncited("| a | 1 mm |\n")), 1)
        self.assertEqual(figures.uncited("| a | 1 mm<!-- = sag.mm:.0f mm --> |\n"), [])


class Tree(unittest.TestCase):
    """A repository of its own."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        for name in (*figures.ALWAYS, "tools/x"):
            (self.root / name).mkdir(parents=True)
            (self.root / name / "file").write_text("a")
        self.git("init", "-q")
        self.git("add", ".")
        self.git("-c", "user.name=n", "-c", "user.email=e", "commit", "-qm", "first")

    def git(self, *words):
        subprocess.run(["git", *words], cwd=self.root, check=True)


class Staleness(Tree):
    def setUp(self):
        super().setUp()
        self.entry = DECLARED["sag"]
        self.result = {**STORED["sag"], "inputs": figures.inputs_of(self.entry, self.root)}

    def reason(self, result):
        return figures.reason_stale(self.entry, result, self.root)

    def test_nothing_has_changed(self):
        self.assertEqual(self.reason(self.result), "")

    def test_a_changed_file_makes_it_stale(self):
        (self.root / "tools/x/file").write_text("b")
        self.assertEqual(self.reason(self.result), "changed since: tools/x")

    def test_a_new_file_makes_it_stale(self):
        (self.root / "core/other").write_text("b")
        self.assertEqual(self.reason(self.result), "")  # not yet the repository's
        self.git("add", ".")
        self.assertEqual(self.reason(self.result), "changed since: core")

    def test_results_without_origin_are_stale(self):
        self.assertEqual(self.reason(None), "never run")
        self.assertIn("earlier build", self.reason(STORED["hand"]))
        self.assertEqual(self.reason({**self.result, "command": "bench"}), "another command")


class Measuring(Tree):
    def setUp(self):
        super().setUp()
        for name in ("docs/data", "docs/robots", "tools/lab/report"):
            (self.root / name).mkdir(parents=True)
        self.declared = {
            "said": {"command": "A=7 sh -c 'echo took $A mm'", "read": {"mm": r"took (\S+) mm"}, "quick": True,
                     "rows": [{"what": "length", "figure": "{mm:.0f} mm"}]},
            "kept": {"command": "cp tools/x/result.json out/figures/kept", "result": "out/figures/kept/result.json", "read": {"n": "/all/1"},
                     "rows": [{"what": "count", "figure": "{n}"}]},
            "broken": {"command": "false", "read": {"n": "n"}, "rows": [{"what": "none", "figure": "{n}"}]},
            "hand": {"command": "echo 3 s", "rows": [{"what": "time"}]}}
        (self.root / "tools/x/result.json").write_text('{"all": [1, 2]}')
        (self.root / figures.DECLARED).write_text(yaml.safe_dump(self.declared, sort_keys=False))
        (self.root / figures.STORED).write_text("{}")
        for page in figures.PAGES:
            (self.root / page).write_text("<!-- figures said -->\n<!-- end of figures -->\n")

    def call(self, **options):
        program = SourceFileLoader("run", str(FOLDER / "run")).load_module()
        given = argparse.Namespace(**{"quick": False, "again": False, "only": [], "more": "", "shards": 1, **options})
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            code = program.run(figures.declared(self.root), figures.stored(self.root), given, figures, self.root)
        return code, out.getvalue(), json.loads((self.root / figures.STORED).read_text())

    def test_results_are_stored_with_their_origin_and_written_to_the_pages(self):
        code, said, results = self.call()
        self.assertEqual(code, 1)  # one is broken
        self.assertIn("4 results: 2 measured, 1 to read by hand, 1 failed", said)
        self.assertEqual([results["said"]["values"], results["kept"]["values"]], [{"mm": 7.0}, {"n": 2}])
        self.assertEqual(set(results["said"]) - {"values"}, {"command", "commit", "machine", "date", "seconds", "inputs"})
        self.assertIn("| length | 7 mm |", (self.root / "README.md").read_text())

    def test_the_same_command_resumes(self):
        self.call()
        _, said, _ = self.call()
        self.assertIn("2 results: 0 measured, 1 to read by hand, 1 failed", said)
        self.assertIn("1 results: 1 measured", self.call(only=["said"], again=True)[1])

    def test_a_smaller_sample_stays_stale(self):
        _, _, results = self.call(only=["kept"], more="-v")
        self.assertEqual(results["kept"]["command"], self.declared["kept"]["command"] + " -v")
        self.assertEqual(figures.reason_stale(self.declared["kept"], results["kept"], self.root), "another command")

    def test_quick_results_are_shown_and_not_stored(self):
        _, said, results = self.call(quick=True)
        self.assertIn("now    7 mm", said)
        self.assertEqual(results, {})


def run(draw, mean, hand, factor, name="six poses, bar", method="filter"):
    return {"job": {"application": name, "method": method}, "score": {"mean": mean, "time": mean if mean < 5 else None},
            "states": [{"mm": mean}, {"mm": 3 * mean}],
            "draw": {"distribution": "calibrated", "name": f"calibrated {draw}", "parameters": [
                {"parameter": "hand x", "value": hand}, {"parameter": "hand y", "value": 0},
                {"parameter": "pads' stiffness factor", "value": factor}, {"parameter": "uneven stiffness, seed", "value": draw}]}}


class Draws(unittest.TestCase):
    COLUMN = {"name": "mean, mm", "at": "/score/mean", "decimals": 1}

    def test_a_row_has_median_90_percent_and_worst_of_all_objects(self):
        runs = [run(i, i, 0, 1, f"six poses, {'bar' if i % 2 else 'block'}") for i in range(1, 11)]
        spec = {"of": "six poses", "methods": ["filter"], "columns": [
            self.COLUMN, {"name": "in 3 s", "at": "/score/time", "within": 3}, {"name": "worst", "states": "mm", "over": "worst"}]}
        result = figure_tables.result_of({"runs": runs + [run(1, 99, 0, 1, "poked")]}, spec)
        self.assertEqual(result["table"]["rows"], [["calibrated", "filter", "10", "5.5; 9.0; 10.0", "3 of 10", "16.50; 27.00; 30.00"]])
        self.assertEqual(result["values"]["calibrated_filter_mean_mm_p90"], 9)
        self.assertEqual(result["values"]["calibrated_filter_in_3_s_share"], 30)
        with self.assertRaises(ValueError):
            figure_tables.result_of({"runs": []}, spec)

    def test_the_parameter_that_makes_the_error_explains_it(self):
        # The sign of the hand's error, and whether pads are softer or stiffer, make no difference.
        factors = [2, 0.5, 1.5, 1, 0.6, 1.2, 0.9, 1.8]
        runs = [run(i, 1 + abs(hand), hand, factors[i]) for i, hand in enumerate((-4, 3, -2, 1, 5, -6, 7, -8))]
        shares, chance = figure_tables.explained(runs, self.COLUMN)
        self.assertEqual(shares[0][0], "hand")
        self.assertAlmostEqual(shares[0][1], 1)
        self.assertEqual({name for name, _ in shares}, {"object", "hand", "pads' stiffness factor"})
        self.assertLess(0.4, chance)
        self.assertLess(chance, 0.6)

    def test_the_object_explains_what_differs_between_objects(self):
        runs = [run(i, 1 + 3 * (i % 2), i, 1, f"six poses, {i % 2}") for i in range(8)]
        self.assertEqual(figure_tables.explained(runs, self.COLUMN)[0][0], ("object", 1.0))

    def test_seeds_have_a_row_for_each_application_and_model_error(self):
        runs = [{**run(i, i, 0, 1, "bar"), "job": {"application": "bar", "method": "filter", "model_error": "none"}} for i in (1, 2, 9)]
        spec = {"levels": ["none"], "methods": ["filter", "other"], "columns": [self.COLUMN, {"states": "mm"}],
                "applications": [{"name": "bar", "title": "a bar"}]}
        self.assertEqual(figure_tables.result_of({"runs": runs}, spec)["table"]["rows"], [["a bar", "none", "2.0 / 4.00", ""]])

    def test_goals_of_a_study_have_a_row_each(self):
        study = {"goals": [{"goal": "reported", "text": "8 of 10", "met": False}, {"goal": "held", "text": "none", "met": None}]}
        self.assertEqual(figure_tables.result_of(study, {"goals": "all"})["table"]["rows"],
                         [["reported", "8 of 10", "missed"], ["held", "none", "not judged"]])

    def test_single_runs_have_a_row_each(self):
        spec = {"runs": [{"name": "method", "at": "/job/method"}, self.COLUMN, {"name": "s", "at": "/none"}]}
        self.assertEqual(figure_tables.result_of({"runs": [run(1, 2, 0, 1)]}, spec)["table"]["rows"], [["filter", "2.0", ""]])


if __name__ == "__main__":
    unittest.main()
