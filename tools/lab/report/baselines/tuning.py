"""Results of the random search: number of trials of each method, and the selected trial."""
import csv


def read_trials(file):
    """By method: trials, best (number), score, seed, version. Empty if no results were kept."""
    found = {}
    if not file.exists():
        return found
    with open(file, newline="", encoding="utf-8") as text:
        for row in csv.DictReader(text):
            told = found.setdefault(row["method"], {"trials": 0, "score": float("inf")})
            told["trials"] += 1
            if float(row["score"]) < told["score"]:
                told.update(best=int(row["trial"]), score=float(row["score"]), seed=row["seed"],
                            version=row["version"])
    return found


def words(method, trials):
    """"10 trials at random, the best #3 with 1.87"."""
    if method not in trials:
        return "none: nothing to tune, or trained"
    told = trials[method]
    if told["trials"] == 1:
        return "1 trial: nothing to tune"
    return f"{told['trials']} trials at random, the best #{told['best']} with {told['score']:.2f}"
