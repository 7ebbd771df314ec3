#!/usr/bin/python3
"""Prints the results of fits as tables, from the JSON file of palpate-fit, which starts it at its end.

  tools/fit/report_fits.py fitted/fits.json --details

A summary of several fits; of one, or with --details, its parameters, series and findings.
"""
import argparse
import csv
import json
import math
import pathlib
import statistics
import sys

sys.dont_write_bytecode = True
sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "common"))
import plots  # noqa: E402

MOST_ROWS = 60  # more fits are reported by their medians alone
MANY = 20  # values from which on quartiles are reported, not a deviation
CORRELATED = 0.9  # from which on a correlation is reported
MOST_SERIES = 6  # in a picture
LISTS = ("modulus", "poisson", "rmse", "percent", "held_errors", "held_percent")


def with_nan(node):
    """The same with a number that is none wherever JSON has null."""
    if isinstance(node, list):
        return [with_nan(one) for one in node]
    if isinstance(node, dict):
        return {key: with_nan(one) for key, one in node.items()}
    return math.nan if node is None else node


def readable(value, unit):
    """A value in its unit with an SI prefix: "84.3 kPa", "1.2 mm", "0.31"; empty if there is none."""
    if value is None:
        return ""
    # Compound units such as "m/s2" are printed without prefix: it would belong to their first letter alone.
    if unit in ("Pa", "N", "m", "s", "Pa s") and value:
        for least, factor, prefix in ((1e6, 1e-6, "M"), (1e3, 1e-3, "k"), (0.9, 1, ""), (9e-4, 1e3, "m"),
                                      (0, 1e6, "u")):
            if abs(value) >= least:
                return f"{value * factor:.4g} {prefix}{unit}"
    return f"{value:.4g} {unit}".rstrip()


def number(value, decimals):
    return "" if value is None else f"{value:.{decimals}f}"


def interval(ends, unit):
    return " to ".join(readable(end, unit) for end in ends)


def print_table(header, rows):
    """Aligned columns; a row that is text spans them as a title."""
    lines = [header] + [row + [""] * (len(header) - len(row)) for row in rows if isinstance(row, list)]
    widths = [max(map(len, column)) for column in zip(*lines)]
    total = sum(widths) + 2 * len(widths) - 2
    lines = iter(lines)
    for row in (header, "", *rows):
        if isinstance(row, list):
            first, *others = next(lines)
            print("  ".join([first.ljust(widths[0]), *(cell.rjust(width) for cell, width in zip(others, widths[1:]))]))
        else:
            print((f"-- {row} " if row else "").ljust(total, "-"))


def is_estimated(fit, name):
    return fit["parameters"][name]["standing"] == "estimated"


# A line for each fit, and for each group of several the medians.

def figures_of(fit):
    """Values of a fit to be pooled, by LISTS; errors are those of the quantity of its first series."""
    found = {name: [] for name in LISTS}
    if "error" in fit:
        return found
    if "corotational" in fit:
        found["modulus"] = [fit["corotational"]["young_modulus"]]
        if is_estimated(fit, "poisson_ratio"):
            found["poisson"] = [fit["corotational"]["poisson_ratio"]]
    for series in fit["series"]:
        if series["quantity"] != fit["series"][0]["quantity"]:
            continue
        if series["fitted"]["samples"]:
            found["rmse"].append(series["fitted"]["rmse"])
            found["percent"].append(series["fitted"]["percent"])
        if series["held_out"]["samples"]:
            found["held_percent"].append(series["held_out"]["percent"])
            found["held_errors"] += [abs(predicted - measured) for predicted, measured, held in
                                     zip(*samples(series, "predicted", "measured", "held_out")) if held]
    return found


def samples(series, *names):
    return [series["samples"][name] for name in names]


def pooled(fits):
    figures = [figures_of(fit) for fit in fits]
    return {name: [value for one in figures for value in one[name]] for name in LISTS}


def unit_of(fits):
    """Of the errors."""
    return next((fit["series"][0]["unit"] for fit in reversed(fits) if "error" not in fit), "")


def median(values):
    """None if there is no value."""
    return statistics.median(values) if values else None


def spread(values, unit):
    """The spread of several values; quartiles of many."""
    if len(values) < 2:
        return ""
    ordered = sorted(values)
    if len(ordered) >= MANY:
        return "quartiles " + ", ".join(readable(ordered[k * len(ordered) // 4], unit) for k in (1, 3))
    deviation = statistics.stdev(ordered)
    return f"spread {100 * deviation / statistics.mean(ordered):.0f} %" if unit else f"spread {deviation:.3f}"


def summary_row(title, fits, modulus_note="", poisson_note=""):
    figures, unit = pooled(fits), unit_of(fits)
    return [title, readable(median(figures["modulus"]), "Pa") or "undetermined", modulus_note,
            number(median(figures["poisson"]), 3), poisson_note,
            readable(median(figures["rmse"]), unit), number(median(figures["percent"]), 2),
            readable(median(figures["held_errors"]), unit), number(median(figures["held_percent"]), 2)]


def fit_row(fit):
    if "error" in fit:
        return [fit["fit"], "failed"]
    notes = []
    if soft := fit.get("corotational"):
        notes = [interval(soft["young_modulus_interval"], "Pa")]
        if is_estimated(fit, "poisson_ratio"):
            notes.append(" to ".join(number(end, 3) for end in soft["poisson_ratio_interval"]))
    return summary_row(fit["fit"], [fit], *notes)


def group_row(title, fits):
    figures = pooled(fits)
    return summary_row(title, fits, spread(figures["modulus"], "Pa"), spread(figures["poisson"], ""))


def print_summary(fits):
    rows = []
    for variant in dict.fromkeys(fit["variant"] for fit in fits):
        members = [fit for fit in fits if fit["variant"] == variant]
        groups = {}
        for fit in members:
            groups.setdefault(fit["group"], []).append(fit)
        rows += [variant] if variant else []
        if len(members) <= MOST_ROWS:
            rows += [fit_row(fit) for fit in members]
        rows += [group_row(f"median of {len(group)}: {name}", group)
                 for name, group in groups.items() if len(group) > 1]
        if len(groups) > 1 and len(members) <= MOST_ROWS:
            rows.append(summary_row(f"median of all {len(members)}", members))
    print_table(["fit", "E", "95 % interval", "nu", "95 % interval", "RMSE", "% of range", "held out: median |error|",
                 "% of range"], rows)


# One fit.

def print_parameters(fit):
    rows = []
    for name in fit["order"]:
        one = fit["parameters"][name]
        rows.append([name, "" if one["standing"] == "undetermined" else readable(one["value"], one["unit"]),
                     interval(one["interval"], one["unit"]) if "interval" in one else "",
                     one.get("by", one["standing"])])
    print_table(["parameter", "value", "95 % interval", "by"], rows)


def print_undetermined(fit):
    for shares in fit["undetermined"]:
        named = sorted(shares.items(), key=lambda pair: fit["order"].index(pair[0]))
        if len(named) > 1:
            print("The data do not determine", ", ".join(f"{name} ({share:+.2f})" for name, share in named) +
                  ": they may change together by these shares.")
        else:
            print(f"The data do not determine {named[0][0]}: anything allowed fits as well.")
    names = fit["determined"]
    for i, row in enumerate(fit.get("correlation") or []):
        for j, r in enumerate(row[:i]):
            if abs(r) >= CORRELATED:
                print(f"Correlated by {r:.3f}: {names[j]}, {names[i]}.")


def print_series(fit):
    rows = []
    for series in fit["series"]:
        fitted, held, unit = series["fitted"], series["held_out"], series["unit"]
        rows.append([f"{series['recording']}, {series['quantity']}", str(fitted["samples"])])
        rows[-1] += [number(series["independent_samples"], 0), readable(fitted["rmse"], unit),
                     number(fitted["percent"], 2)] if fitted["samples"] else [""] * 3
        if held["samples"]:
            rows[-1] += [str(held["samples"]), readable(held["median"], unit), readable(held["rmse"], unit),
                         number(held["percent"], 2)]
    print_table(["recording, quantity", "samples", "independent", "RMSE", "% of range", "held out", "median |error|",
                 "RMSE", "% of range"], rows)


def print_details(fit):
    print(f"\n{fit['title']} ({fit.get('model', '')})")
    if "error" in fit:
        print(" ", fit["error"])
        return
    print_parameters(fit)
    print_undetermined(fit)
    print()
    print_series(fit)
    if soft := fit.get("corotational"):
        nu = [number(end, 3) for end in (soft["poisson_ratio"], *soft["poisson_ratio_interval"])]
        strains = [number(100 * strain, 1) for strain in soft["strain_range"]]
        print(f"\nCo-rotational: E {readable(soft['young_modulus'], 'Pa')} "
              f"({interval(soft['young_modulus_interval'], 'Pa')}), nu {nu[0]} ({nu[1]} to {nu[2]}), "
              f"for strains from {strains[0]} to {strains[1]} %.")
    count = fit["evaluations"]
    print(f"Evaluations: {count['predictions']} predictions, {count['with_derivatives']} with derivatives, in "
          f"{readable(fit['seconds'], 's')}{'' if fit['converged'] else '; the search did NOT converge'}.")


def print_findings(fit):
    rows = []
    for one in fit.get("findings", []):
        difference, unit = one["predicted"] - one["measured"], one["unit"]
        is_met = difference < 0 if one["is_bound"] else abs(difference) <= one["allowed"]
        has_goal = one["is_bound"] or one["allowed"] > 0
        rows.append([one["recording"], one["what"], readable(one["measured"], unit), readable(one["predicted"], unit),
                     readable(difference, unit),
                     "" if not has_goal else "less" if one["is_bound"] else readable(one["allowed"], unit),
                     "" if not has_goal else "met" if is_met else "MISSED"])
    if rows:
        print()
        print_table([fit["title"], "quantity", "measured", "predicted", "difference", "goal", ""], rows)


# Derivatives, over all fits.

def print_gradients(fits, tolerance):
    checks = [check for fit in fits for check in fit.get("gradients", [])]
    if not checks:
        return
    print("\nDerivatives against Ridders' differences, at start and result:")
    rows, worst = [], 0
    for quantity in sorted({check["quantity"] for check in checks}):
        most = max((check for check in checks if check["quantity"] == quantity), key=lambda one: one["difference"])
        rows.append([quantity, f"{most['difference']:.1e}", most["parameter"]])
        worst = max(worst, most["difference"])
    print_table(["residual", "largest relative difference", "of"], rows)
    if worst > tolerance:
        print(f"above {tolerance:.0e}")


def print_comparison(fits):
    runs = [fit["numeric"] for fit in fits if "numeric" in fit]
    numeric, analytic = ([sum(run[side + name] for run in runs) for name in ("evaluations", "seconds")]
                         for side in ("", "analytic_"))
    if all(analytic):
        print(f"\nNumeric differentiation against analytic: {numeric[0] / analytic[0]:.1f} times the evaluations "
              f"({numeric[0]} / {analytic[0]}), {numeric[1] / analytic[1]:.1f} times the time "
              f"({readable(numeric[1], 's')} / {readable(analytic[1], 's')}); costs differ by at most "
              f"{max(run['difference'] for run in runs):.1e}.")


# Files.

def exact(value):
    return f"{value:.9g}"


def write_csv(file, header, rows):
    with file.open("w", encoding="utf-8", newline="") as text:
        csv.writer(text, lineterminator="\n").writerows([header.split(","), *rows])


def csv_row(fit):
    row = [fit["fit"], fit["group"], fit["variant"]]
    soft = fit.get("corotational")
    moduli = [soft["young_modulus"], *soft["young_modulus_interval"], soft["poisson_ratio"]] if soft else []
    row += [*map(exact, moduli), *[""] * (4 - len(moduli))]
    if "error" in fit:
        return row + [""] * 4 + [fit["error"]]
    fitted, held = fit["series"][0]["fitted"], fit["series"][0]["held_out"]
    row += [exact(fitted["rmse"]), exact(fitted["percent"])]
    return row + ([exact(held["median"]), exact(held["percent"])] if held["samples"] else ["", ""]) + [""]


def sample_rows(fit):
    """Every sample: recording, quantity, abscissa, measured, predicted, whether it was held out."""
    for series in fit["series"]:
        for x, measured, predicted, held in zip(*samples(series, "x", "measured", "predicted", "held_out")):
            yield [*(series[name] for name in ("recording", "quantity", "unit", "abscissa", "abscissa_unit")),
                   exact(x), exact(measured), exact(predicted), int(held)]


def with_unit(name, unit):
    return f"{name} [{unit}]" if unit else name


def panels_of(fit):
    """Data with fit, and residuals below, by series in the recorded order."""
    panels = []
    for series in fit["series"][:MOST_SERIES]:
        x, measured, predicted, held_out = samples(series, "x", "measured", "predicted", "held_out")
        curves = [plots.curve("measured", x, measured)]
        for name, is_held in (("fitted", False), ("predicted, held out", True)):
            points = [(a, b) for a, b, held in zip(x, predicted, held_out) if held == is_held]
            if points:
                curves.append(plots.curve(name, *zip(*points)))
        labels = {"x": with_unit(series["abscissa"], series["abscissa_unit"]),
                  "y": with_unit(series["quantity"], series["unit"])}
        residuals = [p - m for p, m in zip(predicted, measured)]
        panels += [{"title": series["recording"], **labels, "curves": curves},
                   {"title": series["recording"] + ": residual", **labels,
                    "curves": [plots.curve("predicted - measured", x, residuals)]}]
    panels[0]["title"] = f"{fit['title']}: {panels[0]['title']}"
    return panels


def write_files(fits, folder):
    write_csv(folder / "fits.csv", "fit,group,variant,young_modulus_Pa,young_modulus_low_Pa,young_modulus_high_Pa,"
              "poisson_ratio,rmse,percent_of_range,held_out_median,held_out_percent,error", map(csv_row, fits))
    lacking = plots.missing("matplotlib")
    for fit in fits:
        if "folder" not in fit:
            continue
        own = folder / fit["folder"]
        own.mkdir(exist_ok=True)
        write_csv(own / "samples.csv", "recording,quantity,unit,abscissa,abscissa_unit,x,measured,predicted,held_out",
                  sample_rows(fit))
        if not lacking:
            (own / "fit.png").write_bytes(plots.draw(panels_of(fit), "png"))
    if lacking:
        print(f"\nno fit.png: {lacking}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", type=pathlib.Path, help="the JSON file")
    parser.add_argument("--details", action="store_true", help="print every fit's parameters, series and findings")
    parser.add_argument("--files", action="store_true",
                        help="write fits.csv next to the JSON file, and each fit's samples.csv and fit.png")
    options = parser.parse_args()
    results = with_nan(json.loads(options.results.read_text(encoding="utf-8")))
    fits = results["fits"]
    if results["about"]:
        print(results["about"])
    if len(fits) > 1:
        print_summary(fits)
    detailed = fits if len(fits) == 1 or options.details else []
    for show in (print_details, print_findings):
        for fit in detailed:
            show(fit)
    print_gradients(fits, results["gradient_tolerance"])
    print_comparison(fits)
    if options.files:
        write_files(fits, options.results.parent)
    return 0


if __name__ == "__main__":
    sys.exit(main())
