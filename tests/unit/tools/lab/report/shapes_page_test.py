"""The page of recorded shapes: every score with its verdict, measured lines once, no markup from names."""
import os
import pathlib
import sys
import unittest

sys.dont_write_bytecode = True
HERE = pathlib.Path(os.environ["PALPATE_SOURCE_DIR"]) / "tools/lab/report"
sys.path.insert(0, str(HERE))
from shapes_page import page_of, panel_of, rows_of  # noqa: E402


def score(error, goal=None, fitted=False):
    return {"quantity": "rotation", "unit": "degrees", "error": error, "deviation_of_recording": 1.0,
            "goal": goal, "fitted": fitted, "met": None if goal is None else abs(error) <= goal}


def line(name, measured, is_line=True):
    return {"name": name, "x_mm": [0, 1, 2], "y_mm": [0, -1, -3], "measured": measured, "line": is_line}


def shape(model, **parts):
    return {"recording": "a <b>", "model": model, "material": "M: E 100 kPa", "nodes": 10, "notes": ["a note"],
            "incremental_deviation_m": 2e-9, "scores": [score(1.5, 2), score(-2.5, 2), score(0, None, True)],
            "outlines": [line("predicted", False), line("measured", True, False)], **parts}


class Page(unittest.TestCase):
    def test_verdicts_follow_the_scores(self):
        self.assertEqual([row[-1] for row in rows_of(shape("m"))], ["met", "MISSED", "fitted"])
        self.assertEqual(rows_of(shape("m"))[1][2], "-2.50")

    def test_measured_lines_are_drawn_once_and_as_points(self):
        curves = panel_of("a", [shape("first"), shape("second")])["curves"]
        self.assertEqual([c["name"] for c in curves], ["predicted: first", "predicted: second", "measured"])
        self.assertEqual([c["points"] for c in curves], [False, False, True])

    def test_page_has_everything_and_no_markup_from_names(self):
        empty = shape("m", outlines=[], scores=[], recording="other", incremental_deviation_m=None)
        page = page_of({"shapes": [shape("m"), empty]})
        self.assertIn("a &lt;b&gt;", page)
        self.assertNotIn("<b>", page)
        self.assertEqual(page.count("<img"), 1)
        self.assertIn("MISSED", page)
        self.assertIn("0.002 micrometres", page)


if __name__ == "__main__":
    unittest.main()
