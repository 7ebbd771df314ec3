"""Rules by which worlds of palpate-evaluate discrepancies are judged: what is detectable, reported in time, ranked
correctly, recovered, and how well reported intervals hold. A world is one entry of "worlds" in the study's JSON file.
"""
import math
import random
import statistics

DETECTABLE = 3.0     # standard deviations
LIMIT = 3.0          # mm, of the largest node error
IN_TIME = 0.5        # s
RECOVERY = 2.0       # s after the end of a contact
NO_WORSE = 0.1       # mm, than pose alone
CONTACTS = ("table", "cylinder", "wall", "weight")
RESAMPLES = 2000


def quantile(values, share):
    """By linear interpolation; None without values."""
    ordered = sorted(values)
    if not ordered:
        return None
    place = share * (len(ordered) - 1)
    low = int(place)
    high = min(low + 1, len(ordered) - 1)
    return ordered[low] + (place - low) * (ordered[high] - ordered[low])


def share(hits, count):
    """Percent; None of nothing."""
    return 100 * hits / count if count else None


def passes(world):
    """Whether the largest node error passes 3 mm after the onset of a discrepancy; each world counts once."""
    score = world["score"]
    return score["onset_s"] is not None and score["largest_error_passed_s"] is not None


def detectable_from(world):
    """s, first instant of the discrepancy at which the largest node error exceeds 3 mm and a component of the wrench
    differs from its prediction by more than three standard deviations, in at least half of the tests until a report is
    due: that one of six components does so once in a world is likely without any discrepancy. None: never."""
    score = world["score"]
    if score["onset_s"] is None:
        return None
    end = score["end_of_log_s"] if score["end_s"] is None else score["end_s"]
    tests = score["tests"]
    times, values = tests["time_s"], tests["significance"]
    for i, (time, error) in enumerate(zip(times, tests["largest_error_mm"])):
        if not score["onset_s"] <= time <= end or error <= LIMIT or values[i] <= DETECTABLE:
            continue
        due = [value for at, value in zip(times[i:], values[i:]) if at <= time + IN_TIME + 1e-6]
        if 2 * sum(value > DETECTABLE for value in due) >= len(due):
            return time
    return None


def delay(world, since):
    """s from an instant until a report that lasts beyond it, at least zero; None: there is none."""
    begins = [report["begin_s"] for report in world["score"]["reports"] if report["end_s"] >= since]
    return max(0.0, min(begins) - since) if begins else None


def detection(worlds):
    """Of worlds that pass 3 mm: numbers of all, of the detectable, and of those reported in time among them."""
    passing = [world for world in worlds if passes(world)]
    since = [(world, detectable_from(world)) for world in passing]
    delays = [delay(world, time) for world, time in since if time is not None]
    in_time = sum(late is not None and late <= IN_TIME for late in delays)
    return {"passing": len(passing), "detectable": len(delays), "in_time": in_time,
            "delays": [late for late in delays if late is not None],
            "left_out_percent": share(len(passing) - len(delays), len(passing)),
            "in_time_percent": share(in_time, len(delays))}


# Ranking.


def ranked(worlds, key):
    """Numbers of reported worlds with a true cause, of those with the cause first and among the first two."""
    reported = [world for world in worlds if world["cause"] and world["score"]["reported_s"] is not None]
    first = sum(world["score"][key][:1] == [world["cause"]] for world in reported)
    two = sum(world["cause"] in world["score"][key][:2] for world in reported)
    return {"reported": len(reported), "first": first, "first_two": two,
            "first_percent": share(first, len(reported)), "first_two_percent": share(two, len(reported))}


def confusion(worlds, key):
    """{kind: {first cause: number of reported worlds}}; "not explained" without a ranking."""
    counts = {}
    for world in worlds:
        if world["kind"] == "none" or world["score"]["reported_s"] is None:
            continue
        cause = (world["score"][key] or ["not explained"])[0]
        row = counts.setdefault(world["kind"], {})
        row[cause] = row.get(cause, 0) + 1
    return counts


# Recovery after a contact.


def recovery(worlds):
    """Of worlds whose contact ends at least two seconds before the log does: shares that are within 0.1 mm of pose
    alone for the first time, and that stay so, within two seconds."""
    judged = [world["score"] for world in worlds if world["kind"] in CONTACTS and world["score"]["end_s"] is not None and
              world["score"]["end_of_log_s"] - world["score"]["end_s"] >= RECOVERY - 1e-3 and
              world["score"]["average_error_of_pose_alone_mm"] is not None]

    def within(key):
        return sum(score[key] is not None and score[key] <= RECOVERY for score in judged)

    stays = [score["stays_at_pose_alone_s"] for score in judged if score["stays_at_pose_alone_s"] is not None]
    return {"worlds": len(judged), "reached": within("reached_pose_alone_s"), "stay": within("stays_at_pose_alone_s"),
            "reached_percent": share(within("reached_pose_alone_s"), len(judged)),
            "stay_percent": share(within("stays_at_pose_alone_s"), len(judged)),
            "median_s": quantile(stays, 0.5), "90_percent_s": quantile(stays, 0.9)}


def undisturbed(worlds):
    """Of worlds without a discrepancy: numbers of all, and of those at most 0.1 mm worse than by pose alone."""
    scores = [world["score"] for world in worlds if world["kind"] == "none" and
              world["score"]["average_error_of_pose_alone_mm"] is not None]
    near = sum(score["average_error_mm"] <= score["average_error_of_pose_alone_mm"] + NO_WORSE for score in scores)
    return {"worlds": len(scores), "near": near}


# Reports in free air, and intervals.


def free_air(worlds):
    """False reports in worlds without a discrepancy, and their hours."""
    none = [world for world in worlds if world["kind"] == "none"]
    reports = sum(world["score"]["false_reports"] for world in none)
    hours = sum(world["score"]["free_air_s"] for world in none) / 3600
    return {"worlds": len(none), "reports": reports, "worlds_with_reports":
            sum(world["score"]["false_reports"] > 0 for world in none), "hours": hours,
            "per_10_hours": 10 * reports / hours if hours else None}


def bootstrap(numbers, statistic):
    """95 % percentile interval of statistic(numbers) over resamples of the draws, from a fixed seed."""
    if len(numbers) < 2:
        return None
    source = random.Random(1)
    values = [statistic(source.choices(numbers, k=len(numbers))) for _ in range(RESAMPLES)]
    return quantile(values, 0.025), quantile(values, 0.975)


def widths(worlds):
    """At each fixed point of an object, of all its draws: median 95 % radius over the 95 % quantile of the error."""
    ratios = []
    for name in sorted({world["object"] for world in worlds}):
        points = {}
        for world in worlds:
            if world["object"] == name:
                for point in world["intervals"]["points"]:
                    errors, radii = points.setdefault(tuple(point["place"]), ([], []))
                    errors += point["error_mm"]
                    radii += point["radius_mm"]
        for errors, radii in points.values():
            error = quantile(errors, 0.95)
            if error > 0:
                ratios.append(statistics.median(radii) / error)
    return ratios


def intervals(worlds):
    """Coverage and width of the reported deviations in worlds without a discrepancy; None without any."""
    worlds = [world for world in worlds if world.get("intervals") and world["intervals"]["nodes"]]
    if not worlds:
        return None
    parts = [world["intervals"] for world in worlds]

    def covered(some):
        return 100 * sum(part["nodes_inside"] for part in some) / sum(part["nodes"] for part in some)

    def weighted(key, weight):
        total = sum(part[weight] for part in parts)
        return sum(part[key] * part[weight] for part in parts) / total if total else None

    moduli = [abs(part["log_young_modulus_error"]) / part["log_young_modulus_deviation"] for part in parts
              if part["log_young_modulus_deviation"]]
    return {"worlds": len(parts), "covered_percent": covered(parts), "covered_interval": bootstrap(parts, covered),
            "nees": weighted("nees", "nodes"), "width": quantile(widths(worlds), 0.5),
            "wrench_covered_percent": weighted("wrench_inside_percent", "wrench_components"),
            "wrench_nees": weighted("wrench_nees", "wrench_components"),
            "log_young_in_deviations": quantile(moduli, 0.5),
            "log_young_covered_percent": share(sum(value <= 1.96 for value in moduli), len(moduli))}


def covered_while_reported(worlds):
    """Percent of nodes in their 95 % balls, pooled over the reported times of worlds with a discrepancy."""
    scores = [world["score"] for world in worlds if world["kind"] != "none"]
    return share(sum(score["nodes_inside_while_reported"] for score in scores),
                 sum(score["nodes_while_reported"] for score in scores))


def behind_pose_alone(worlds):
    """mm, mean over free-air worlds of the nodes' mean error less that by pose alone."""
    behind = [world["score"]["average_error_mm"] - world["score"]["average_error_of_pose_alone_mm"] for world in worlds
              if world["kind"] == "none" and world["score"]["average_error_of_pose_alone_mm"] is not None]
    return statistics.fmean(behind) if behind else None
