"""Results of the random search: number of trials of each method, and the selected trial."""
import csv

from baselines.runs import current_name


def read_trials(file):
    """By method: trials, best (number), score, seed, version. Empty if no results were kept."""
    found = {}
    if not file.exists():
        return found
    with open(file, newline="", encoding="utf-8") as text:
        for row in csv.DictReader(text):
            entry = found.setdefault(current_name(row["method"], file), {"trials": 0, "score": float("inf")})
            entry["trials"] += 1
            if float(row["score"]) < entry["score"]:
                entry.update(best=int(row["trial"]), score=float(row["score"]), seed=row["seed"],
                             version=row["version"])
    return found


def words(method, trials):
    """"10 trials at random, the best #3 with 1.87"."""
    if method not in trials:
        return "none: nothing to tune, or trained"
    entry = trials[method]
    if entry["trials"] == 1:
        return "1 trial: nothing to tune"
    return f"{entry['trials']} trials at random, the best #{entry['best']} with {entry['score']:.2f}"
