"""Reads the results of the two studies, one dictionary per run.

Every run has application, method, level, seed, version, hash (of all its inputs and programs),
folder, failed, curve ({"time_s": [...], "mm": [...]} or empty) and the measures of its study.
"""
import csv
import json
import statistics
import sys

# Methods by the names that results and random draws of earlier versions have for them.
RENAMED = {"palpate, pose, wrench and sight": "palpate, pose, wrench and vision"}
BANDS = ("5mm", "2mm", "1mm")


def current_name(method, file):
    """Name of a method today; warns where a file has an earlier one."""
    if method in RENAMED:
        print(f"warning: {file}: method \"{method}\" is called \"{RENAMED[method]}\" now", file=sys.stderr)
    return RENAMED.get(method, method)


def of(runs, **wanted):
    return [run for run in runs if all(run[key] == value for key, value in wanted.items())]


def results_in(folder):
    for file in sorted(folder.glob("*/result.json")):
        yield file.parent, json.loads(file.read_text(encoding="utf-8"))


def version_of(folder, name):
    """Version of the program that made the study's own report, for results that do not state
    theirs.
    """
    file = folder / f"{name}.json"
    return json.loads(file.read_text(encoding="utf-8")).get("version", "") if file.exists() else ""


def common(result, folder, version):
    job = result["job"]
    return {"application": job["application"], "method": current_name(job["method"], folder),
            "seed": job["seed"], "level": job["model_error"], "version": result.get("version", version),
            "hash": result["inputs_hash"], "folder": folder, "failed": False}


def failures_in(folder):
    """(application, method, level, seed) of the jobs that failed according to runs.csv."""
    for file in sorted(folder.glob("runs*.csv")):
        with open(file, newline="", encoding="utf-8") as text:
            for row in csv.DictReader(text):
                if row.get("outcome") == "failed":
                    yield (row["application"], current_name(row["method"], file), row["model_error"],
                       int(row["seed"]))


def with_failures(folder, runs, fill):
    """The runs, and one for each failed job without a result, with measures that `fill`
    returns.
    """
    known = {(r["application"], r["method"], r["level"], r["seed"]) for r in runs}
    added = []
    for application, method, level, seed in failures_in(folder):
        like = of(runs, application=application)
        if (application, method, level, seed) in known or not like:
            continue
        known.add((application, method, level, seed))
        run = {"application": application, "method": method, "level": level, "seed": seed,
               "version": like[0]["version"], "hash": "", "folder": folder / "none", "failed": True,
               "curve": {}}
        run.update(fill(like))
        added.append(run)
    return runs + added


def control_runs(folder):
    """Error and times of a feature; a run that does not settle counts at the cap, the run's
    length.
    """
    version, runs = version_of(folder, "control"), []
    for place, result in results_in(folder):
        feature = result.get("score", {}).get("feature")
        if feature is None:
            continue
        run = common(result, place, version)
        cap = feature["duration_s"]
        run.update(cap=cap, error=feature["error_mm"], start=feature["start_error_mm"],
                   overshoot=feature["overshoot_percent"], path=feature["path_mm"],
                   curve=result.get("control", {}).get("plant", {}))
        for band in BANDS:
            time = feature[f"time_to_{band}_s"]
            run[f"reached_{band}"] = time is not None
            run[f"time_{band}"] = cap if time is None else time
        runs.append(run)

    def at_the_cap(like):
        start, cap = statistics.median(r["start"] for r in like), max(r["cap"] for r in like)
        filled = {"start": start, "error": start, "overshoot": 0, "path": 0, "cap": cap}
        for band in BANDS:
            filled.update({f"reached_{band}": False, f"time_{band}": cap})
        return filled
    return with_failures(folder, runs, at_the_cap)


def sensing_runs(folder, cap=100.0):
    """Errors of a shape, mm, means over the states; limited to the cap."""
    version, runs = version_of(folder, "published-sensing"), []
    for place, result in results_in(folder):
        if not result.get("states"):
            continue
        run = common(result, place, version)
        for key, measure in (("mean", "mean_mm"), ("hausdorff", "hausdorff_mm"), ("max", "max_mm")):
            run[key] = statistics.fmean(min(cap, state[measure]) for state in result["states"])
        curve = result.get("shape_error", {})
        run["curve"] = {"time_s": curve.get("time_s", []), "mm": curve.get("mean_mm", [])}
        runs.append(run)
    return with_failures(folder, runs,
                         lambda like: {"mean": cap, "hausdorff": cap, "max": cap})


def write_csv(runs, keys, file):
    with open(file, "w", newline="", encoding="utf-8") as out:
        writer = csv.DictWriter(out, ["application", "method", "level", "seed", *keys, "failed",
                                      "version", "hash"], extrasaction="ignore")
        writer.writeheader()
        writer.writerows(runs)
