"""The report of palpate-fit: its tables, sentences, files and pictures, from the JSON of fits."""
import contextlib
import csv
import io
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
FILE = pathlib.Path(os.environ["PALPATE_SOURCE_DIR"]) / "tools/fit/report_fits.py"
sys.path.insert(0, str(FILE.parent))
import report_fits  # noqa: E402


def errors(samples, size):
    return {"samples": samples, "median": size, "rmse": 2 * size, "percent": 1e3 * size}


def series(measured, predicted, held_out, **more):
    held = sum(held_out)
    return {"recording": "a", "quantity": "force", "unit": "N", "abscissa": "depth", "abscissa_unit": "m",
            "fitted": errors(len(measured) - held, 1e-3), "held_out": errors(held, 2e-3), "independent_samples": 2.5,
            "samples": {"x": list(range(len(measured))), "measured": measured, "predicted": predicted,
                        "held_out": held_out}, **more}


def fit(name, modulus=2e4, group="g", variant="", **more):
    parameters = {"young_modulus": {"unit": "Pa", "standing": "estimated", "value": modulus,
                                    "interval": [0.9 * modulus, 1.1 * modulus], "by": "profile"},
                  "poisson_ratio": {"unit": "", "standing": "known", "value": 0.3},
                  "a.offset": {"unit": "m", "standing": "undetermined", "value": 1e-4}}
    return {"fit": name, "title": f"{name}, {variant}" if variant else name, "group": group, "variant": variant,
            "model": "linear", "order": list(parameters), "parameters": parameters, "determined": ["young_modulus"],
            "correlation": [[1]], "undetermined": [], "converged": True, "seconds": 1.5, "findings": [],
            "series": [series([1, 2, 3], [1, 2.5, 3], [False, True, False])],
            "evaluations": {"predictions": 10, "with_derivatives": 4},
            "corotational": {"young_modulus": modulus, "young_modulus_interval": [0.9 * modulus, 1.1 * modulus],
                             "poisson_ratio": 0.3, "poisson_ratio_interval": [0.3, 0.3], "strain_range": [-0.1, 0]},
            **more}


def failed(name):
    return {"fit": name, "title": name, "group": "g", "variant": "", "error": "no \"equilibrium\", ever"}


def printed(show, *arguments):
    with contextlib.redirect_stdout(io.StringIO()) as out:
        show(*arguments)
    return out.getvalue()


def cells(text, first):
    """The row of a table that begins with a cell, without its empty cells."""
    rows = [re.split("  +", line.strip()) for line in text.split("\n")]
    return next(row for row in rows if row[0] == first)


class Numbers(unittest.TestCase):
    def test_units_have_prefixes_where_they_can(self):
        for value, unit, text in ((84300, "Pa", "84.3 kPa"), (1.2e-3, "m", "1.2 mm"), (0.31, "", "0.31"),
                                  (2.5e6, "Pa", "2.5 MPa"), (0.95, "N", "0.95 N"), (-3e-5, "m", "-30 um"),
                                  (0, "N", "0 N"), (0.005, "m/s2", "0.005 m/s2"), (None, "N", "")):
            self.assertEqual(report_fits.readable(value, unit), text)

    def test_the_spread_of_many_is_by_quartiles(self):
        self.assertEqual(report_fits.spread([1], "Pa"), "")
        self.assertEqual(report_fits.spread([9e3, 10e3, 11e3], "Pa"), "spread 10 %")
        self.assertEqual(report_fits.spread([0.1, 0.2, 0.3], ""), "spread 0.100")
        self.assertEqual(report_fits.spread(range(1000, 21000, 1000), "Pa"), "quartiles 6 kPa, 16 kPa")


class Text(unittest.TestCase):
    def test_one_fit_has_its_parameters_series_and_material(self):
        text = printed(report_fits.print_details, fit("ball"))
        self.assertIn("\nball (linear)\n", text)
        order = [text.index(name) for name in ("young_modulus ", "poisson_ratio ", "a.offset ")]
        self.assertEqual(order, sorted(order))
        self.assertEqual(cells(text, "young_modulus"), ["young_modulus", "20 kPa", "18 kPa to 22 kPa", "profile"])
        self.assertEqual(cells(text, "poisson_ratio"), ["poisson_ratio", "0.3", "known"])
        self.assertEqual(cells(text, "a.offset"), ["a.offset", "undetermined"])
        self.assertEqual(cells(text, "a, force"),
                         ["a, force", "2", "2", "2 mN", "1.00", "1", "2 mN", "4 mN", "2.00"])
        for part in ("E 20 kPa (18 kPa to 22 kPa), nu 0.300 (0.300 to 0.300), for strains from -10.0 to 0.0 %",
                     "10 predictions, 4 with derivatives, in 1.5 s.\n"):
            self.assertIn(part, text)
        self.assertIn("did NOT converge", printed(report_fits.print_details, fit("ball", converged=False)))
        self.assertIn("no \"equilibrium\"", printed(report_fits.print_details, failed("ball")))

    def test_what_the_data_do_not_determine_is_named(self):
        text = printed(report_fits.print_details, fit(
            "ball", undetermined=[{"a.offset": 0.9, "young_modulus": -0.4}, {"poisson_ratio": 1}],
            determined=["young_modulus", "a.offset"], correlation=[[1, -0.95], [-0.95, 1]]))
        self.assertIn("The data do not determine young_modulus (-0.40), a.offset (+0.90): they may change", text)
        self.assertIn("The data do not determine poisson_ratio: anything allowed fits as well.", text)
        self.assertIn("Correlated by -0.950: young_modulus, a.offset.", text)

    def test_findings_are_compared_with_their_goals(self):
        finding = {"recording": "a", "what": "period", "unit": "s", "measured": 0.5, "predicted": 0.51, "allowed": 0.02,
                   "is_bound": False}
        text = printed(report_fits.print_findings, fit("ball", findings=[
            finding, {**finding, "what": "late", "predicted": 0.53}, {**finding, "what": "free", "allowed": 0},
            {**finding, "what": "bound", "is_bound": True},
            {**finding, "what": "better", "is_bound": True, "predicted": 0.4}]))
        ends = {line.split()[1]: line.split()[-1] for line in text.split("\n") if line.startswith("a ")}
        self.assertEqual(ends, {"period": "met", "late": "MISSED", "free": "ms", "bound": "MISSED", "better": "met"})
        self.assertEqual(printed(report_fits.print_findings, fit("ball")), "")

    def test_a_summary_has_every_fit_and_medians_of_groups_and_variants(self):
        fits = [fit("one", 1e4), fit("two", 3e4), fit("three", 5e4, "h"), failed("four"), fit("one", variant="Ogden")]
        text = printed(report_fits.print_summary, fits)
        self.assertIn("-- Ogden ---", text)
        errors_of = ["2 mN", "1.00", "500 mN", "2.00"]  # the third: of the sample that was held out
        self.assertEqual(cells(text, "one"), ["one", "10 kPa", "9 kPa to 11 kPa", *errors_of])
        self.assertEqual(cells(text, "four"), ["four", "failed"])
        self.assertEqual(cells(text, "median of 3: g"), ["median of 3: g", "20 kPa", "spread 71 %", *errors_of])
        self.assertEqual(cells(text, "median of all 4"), ["median of all 4", "30 kPa", *errors_of])
        many = printed(report_fits.print_summary, [fit(f"f{i}", 1e4 + i) for i in range(report_fits.MOST_ROWS + 1)])
        self.assertNotIn("f7 ", many)
        self.assertIn("median of 61: g", many)

    def test_derivatives_and_searches_are_compared(self):
        check = {"quantity": "force", "parameter": "young_modulus", "difference": 1e-9}
        fits = [fit("ball", gradients=[check, {**check, "parameter": "worst", "difference": 2e-5}])]
        text = printed(report_fits.print_gradients, fits, 1e-6)
        self.assertIn("worst", text)
        self.assertNotIn("young_modulus", text)
        self.assertIn("above 1e-06", text)
        self.assertNotIn("above", printed(report_fits.print_gradients, [fit("ball", gradients=[check])], 1e-6))
        numeric = {"seconds": 4.0, "evaluations": 300, "difference": 1e-8, "analytic_seconds": 2.0,
                   "analytic_evaluations": 100}
        self.assertIn("3.0 times the evaluations (300 / 100), 2.0 times the time (4 s / 2 s); costs differ by at most "
                      "1.0e-08", printed(report_fits.print_comparison, [fit("ball", numeric=numeric), fit("other")]))
        self.assertEqual(printed(report_fits.print_comparison, [fit("ball")]), "")


class Files(unittest.TestCase):
    def report(self, fits, *options):
        name = tempfile.TemporaryDirectory()
        self.addCleanup(name.cleanup)
        folder = pathlib.Path(name.name)
        (folder / "fits.json").write_text(json.dumps({"about": "", "gradient_tolerance": 1e-6, "fits": fits}))
        done = subprocess.run([sys.executable, *options, FILE, folder / "fits.json", "--files"], check=False, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        self.assertEqual(done.returncode, 0, done.stdout)
        return folder, done.stdout

    def test_each_fit_has_its_samples_and_picture(self):
        folder, _ = self.report([fit("one", folder="one"), fit("two"), failed("three")])
        with (folder / "one/samples.csv").open() as text:
            rows = list(csv.DictReader(text))
        self.assertEqual([(row["x"], row["measured"], row["predicted"], row["held_out"]) for row in rows],
                         [("0", "1", "1", "0"), ("1", "2", "2.5", "1"), ("2", "3", "3", "0")])
        self.assertEqual((folder / "one/fit.png").read_bytes()[1:4], b"PNG")
        self.assertFalse((folder / "two").exists())
        with (folder / "fits.csv").open() as text:
            rows = list(csv.DictReader(text))
        self.assertEqual([row["young_modulus_high_Pa"] for row in rows], ["22000", "22000", ""])
        self.assertEqual(rows[2]["error"], "no \"equilibrium\", ever")
        self.assertEqual([row["held_out_percent"] for row in rows], ["2", "2", ""])

    def test_without_matplotlib_only_the_picture_is_missing(self):
        folder, text = self.report([fit("one", folder="")], "-S")  # no site's packages
        self.assertIn("no fit.png: missing Python package: python3-matplotlib", text)
        self.assertTrue((folder / "samples.csv").exists())

    def test_a_picture_has_data_fit_and_residuals(self):
        value, residual = report_fits.panels_of(fit("ball"))
        self.assertEqual((value["title"], residual["title"]), ("ball: a", "a: residual"))
        self.assertEqual((value["x"], value["y"]), ("depth [m]", "force [N]"))
        self.assertEqual([(line["name"], list(line["y"])) for line in value["curves"]],
                         [("measured", [1, 2, 3]), ("fitted", [1, 3]), ("predicted, held out", [2.5])])
        self.assertEqual(residual["curves"][0]["y"], [0, 0.5, 0])

    def test_null_is_no_number(self):
        folder, text = self.report([fit("one", folder="", series=[series([1, 2], [1, None], [False, False])])])
        self.assertIn("one (linear)", text)
        self.assertIn(",1,2,nan,0\n", (folder / "samples.csv").read_text())


if __name__ == "__main__":
    unittest.main()
