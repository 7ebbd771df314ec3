"""Tables and plots of the documentation, from the JSON files that palpate-evaluate writes. Over drawn
model errors: median, 90 % and worst over all draws of a distribution, whatever their object, and how
much of the error's variation each drawn parameter explains. Over seeds: medians by application.
"""
import re

import numpy as np
import scipy.stats

AXIS = re.compile(r" [xyz]$")
NOISE = 0.05  # a parameter without effect explains more than the plot's line with this probability


def name_of(*parts):
    """A key: "pose and wrench, calibrated" as pose_and_wrench_calibrated."""
    return "_".join(re.sub(r"[^a-z0-9]+", "_", part.lower()).strip("_") for part in parts)


def number_at(document, pointer):
    for part in pointer.strip("/").split("/"):
        document = document.get(part) if isinstance(document, dict) else None
    return document


def values_of(run, column):
    """The numbers of a run for a column; one, or one for each external contact. None: never. A
    number of its states is their mean, or their worst."""
    if "states" in column:
        found = [state[column["states"]] for state in run["states"]]
        reduced = {"mean": np.mean, "median": np.median, "worst": np.max}[column.get("over", "mean")]
        return [float(reduced(found))]
    if "each" not in column:
        return [number_at(run, column["at"])]
    return [number_at(contact, column["at"]) for contact in number_at(run, column["each"]) or []
            if number_at(contact, column.get("if", column["at"])) is not None]


def summary(values):
    """Median, the value that 90 % do not exceed (nearest rank), worst."""
    ordered = np.sort(values)
    return float(np.median(ordered)), float(ordered[int(np.ceil(0.9 * len(ordered))) - 1]), float(ordered[-1])


def cell(runs, column, key, values):
    """Text of a cell; what a sentence may cite is put into `values`."""
    found = [value for run in runs for value in values_of(run, column)]
    if "within" in column:
        count = sum(value is not None and value <= column["within"] for value in found)
        values[name_of(key, column["name"], "share")] = 100 * count / len(found) if found else 0
        return f"{count} of {len(found)}"
    found = [value for value in found if value is not None]
    if not found:
        return "-"
    three = summary(found)
    for name, value in zip(("median", "p90", "worst"), three):
        values[name_of(key, column["name"], name)] = value
    return "; ".join(f"{value:.{column.get('decimals', 2)}f}" for value in three)


def drawn_runs(study, prefix):
    return [run for run in study["runs"] if "draw" in run and run["job"]["application"].startswith(prefix)]


def seeds_table(study, spec):
    """A row for each application and model error, a column for each method: medians over the seeds."""
    rows = []
    for application in spec["applications"]:
        for level in spec["levels"]:
            cells = []
            for method in spec["methods"]:
                runs = [run for run in study["runs"] if run["job"]["application"] == application["name"]
                        and run["job"]["method"] == method and run["job"]["model_error"] == level]
                found = [[value for run in runs for value in values_of(run, column) if value is not None]
                         for column in spec["columns"]]
                cells.append(" / ".join(f"{np.median(values):.{column.get('decimals', 2)}f}" if values else "never"
                                        for values, column in zip(found, spec["columns"])) if runs else "")
            rows.append([application["title"], level, *cells])
    return {"table": {"header": ["", "model error", *spec["methods"]], "rows": rows}}


def runs_table(document, spec):
    """A row for each run of the demo."""
    rows = []
    for run in document["runs"]:
        cells = []
        for column in spec["runs"]:
            value = number_at(run, column["at"])
            cells.append("" if value is None else value if isinstance(value, str) else f"{value:.{column.get('decimals', 2)}f}")
        rows.append(cells)
    return {"table": {"header": [column["name"] for column in spec["runs"]], "rows": rows}}


def goals_table(study):
    """A row for each goal of palpate-evaluate discrepancies."""
    met = {True: "met", False: "missed", None: "not judged"}
    rows = [[goal["goal"], goal["text"], met[goal["met"]]] for goal in study["goals"]]
    return {"table": {"header": ["", "measured", "goal"], "rows": rows}}


def result_of(study, spec, picture=None):
    """{"table": {"header", "rows"}, "values"} of a study; draws the picture if a file is given.
    `spec`: begin of the applications' names (`of`), `methods`, `columns` with `name` and `at` (JSON
    pointer in a run), `explained`: method and column of the picture. With `levels` a table over
    seeds, with `runs` one of single runs, with `goals` one of the study's goals."""
    if "goals" in spec:
        return goals_table(study)
    if "levels" in spec:
        return seeds_table(study, spec)
    if "runs" in spec:
        return runs_table(study, spec)
    runs = drawn_runs(study, spec["of"])
    if not runs:
        raise ValueError(f"no drawn run of \"{spec['of']}\"")
    values, rows = {}, []
    families = list(dict.fromkeys(run["draw"]["distribution"] for run in runs))
    for family in families:
        for method in spec["methods"]:
            group = [run for run in runs if run["draw"]["distribution"] == family and run["job"]["method"] == method]
            if not group:
                continue
            key = name_of(family, method)
            values[name_of(key, "draws")] = len(group)
            rows.append([family, method, str(len(group))] + [cell(group, column, key, values) for column in spec["columns"]])
    header = ["model error", "method", "draws"] + [column["name"] for column in spec["columns"]]
    if picture:
        draw(runs, families, spec["explained"], spec["columns"], picture)
    return {"table": {"header": header, "rows": rows}, "values": values}


def parameters_of(run):
    """Size of each drawn parameter: the distance from none; the axes of one together."""
    squares = {}
    for entry in run["draw"]["parameters"]:
        if "seed" in entry["parameter"]:
            continue
        name = AXIS.sub("", entry["parameter"])
        value = np.log(entry["value"]) if "factor" in name else entry["value"]
        squares[name] = squares.get(name, 0) + value ** 2
    return {name: np.sqrt(square) for name, square in squares.items()}


def explained(runs, column):
    """[(parameter, share)] of the variation between runs, largest first, and the share that one
    without effect exceeds by chance. Object: share of the variance of the error's logarithm. The
    others: squared rank correlation with what remains. Ranks of sizes, since either sign harms.
    With fewer than three runs of an object on average, objects are not separated."""
    errors = np.array([np.log(max(1e-9, number_at(run, column["at"]))) for run in runs])
    objects = [run["job"]["application"] for run in runs]
    rest = errors.copy()
    is_apart = len(runs) >= 3 * len(set(objects))
    for name in set(objects) if is_apart else ():
        at = np.array([other == name for other in objects])
        rest[at] -= rest[at].mean()
    total = errors.var()
    shares = {"object": 1 - rest.var() / total} if is_apart and total > 0 else {}
    sizes = [parameters_of(run) for run in runs]
    for name in dict.fromkeys(name for size in sizes for name in size):
        at = [i for i, size in enumerate(sizes) if name in size]
        column_of = [sizes[i][name] for i in at]
        if len(at) > 3 and len(set(column_of)) > 1:
            shares[name] = scipy.stats.spearmanr(column_of, rest[at])[0] ** 2
    count = len(runs)
    t = scipy.stats.t.ppf(1 - NOISE / 2, max(1, count - 2))
    return sorted(shares.items(), key=lambda item: -item[1]), t * t / (max(1, count - 2) + t * t)


def draw(runs, families, spec, columns, file):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    column = next(column for column in columns if column["name"] == spec["column"])
    drawing, axes = pyplot.subplots(1, len(families), figsize=(5.2 * len(families), 4.6), squeeze=False)
    for axis, family in zip(axes[0], families):
        group = [run for run in runs if run["draw"]["distribution"] == family and run["job"]["method"] == spec["method"]
                 and number_at(run, column["at"]) is not None]
        shares, chance = explained(group, column)
        names = [name for name, _ in shares][::-1]
        axis.barh(names, [100 * share for _, share in shares][::-1], color="#4878a8")
        axis.axvline(100 * chance, color="#888888", linestyle="--", linewidth=1)
        axis.set(title=f"{family}, {len(group)} draws", xlabel="explained, %", xlim=(0, 100))
        axis.tick_params(labelsize=8)
    drawing.suptitle(f"{spec['method']}\n{spec['column']}", fontsize=9)
    drawing.tight_layout()
    drawing.savefig(file, dpi=90, metadata={"Software": None})
    pyplot.close(drawing)
