"""Medians, differences and verdicts, with intervals by bootstrap."""
import random
import statistics

DRAWS = 2000


def interval(values, seed=1):
    """Median and its 95 % bootstrap interval."""
    middle = statistics.median(values)
    if len(values) == 1:
        return middle, middle, middle
    generator = random.Random(seed)
    medians = sorted(statistics.median(generator.choices(values, k=len(values)))
                     for _ in range(DRAWS))
    return middle, medians[int(0.025 * DRAWS)], medians[int(0.975 * DRAWS) - 1]


def cell(values, decimals):
    """"1.20 (1.10 to 1.40)"; for a single value "1.20"."""
    middle, low, high = interval(values)
    if len(values) == 1:
        return f"{middle:.{decimals}f}"
    return f"{middle:.{decimals}f} ({low:.{decimals}f} to {high:.{decimals}f})"


def differences(ours, theirs, key):
    """theirs - ours by task, over the seeds that both have."""
    mine = {(run["application"], run["seed"]): run[key] for run in ours}
    by_task = {}
    for run in theirs:
        place = (run["application"], run["seed"])
        if place in mine:
            by_task.setdefault(place[0], []).append(run[key] - mine[place])
    return by_task


def mean_difference(by_task, seed=1):
    """Mean over the tasks and its 95 % interval; tasks are fixed, seeds are resampled."""
    def mean(tasks):
        return statistics.fmean(statistics.fmean(task) for task in tasks)
    generator = random.Random(seed)
    means = sorted(mean([generator.choices(task, k=len(task)) for task in by_task.values()])
                   for _ in range(DRAWS))
    return mean(by_task.values()), means[int(0.025 * DRAWS)], means[int(0.975 * DRAWS) - 1]


def verdict(middle, low, high, margin):
    """For a difference where less is better: "ahead", "tie" or "behind", from the method's
    view.
    """
    if low <= 0 <= high or abs(middle) < margin:
        return "tie"
    return "behind" if low > 0 else "ahead"
