"""Tables, goals and page of palpate-evaluate discrepancies."""
import discrepancy_rules as rules

RANKINGS = (("at the end", "ranking_at_the_end"), ("2 s after the report", "ranking_2s_after_report"))
MISSING = "-"


def number(value, decimals=0, unit=""):
    return MISSING if value is None else f"{value:.{decimals}f}{unit}"


def spread(values, decimals):
    """Median; 90 %; worst."""
    if not values:
        return MISSING
    return "; ".join(number(rules.quantile(values, part), decimals) for part in (0.5, 0.9, 1))


def by_kind(worlds):
    """(kind, its worlds) in the order of their first occurrence, then those of all discrepancies."""
    kinds = list(dict.fromkeys(world["kind"] for world in worlds))
    groups = [(kind, [world for world in worlds if world["kind"] == kind]) for kind in kinds]
    return groups + [("all discrepancies", [world for world in worlds if world["kind"] != "none"])]


def discrepancies(worlds):
    groups = [group for group in by_kind(worlds) if group[0] != "none" and group[1]]
    return groups if len(groups) > 1 else []


def numbers(worlds, key):
    return [world["score"][key] for world in worlds if world["score"][key] is not None]


def overview(worlds):
    rows = []
    for kind, group in by_kind(worlds):
        delays = [world["score"]["reported_s"] - world["score"]["largest_error_passed_s"] for world in group
                  if rules.passes(world) and world["score"]["reported_s"] is not None]
        rows.append([kind, str(len(group)), str(sum(map(rules.passes, group))),
                     spread(numbers(group, "largest_error_mm"), 1), str(len(numbers(group, "reported_s"))),
                     spread(delays, 2),
                     str(sum(rules.passes(world) and world["score"]["reported_s"] is None for world in group)),
                     str(sum(world["score"]["false_reports"] for world in group)),
                     number(rules.covered_while_reported(group)),
                     number(rules.quantile(numbers(group, "covered_while_wrong_and_unreported_percent"), 0.5)),
                     spread(numbers(group, "recovered_s"), 1)])
    return {"title": "Worlds by kind of discrepancy (spreads: median; 90 %; worst)",
            "header": ["discrepancy", "worlds", "error passes 3 mm in", "largest error mm", "reported in", "s after 3 mm",
                       "passes 3 mm unreported", "false reports", "nodes in 95 % ball, reported %",
                       "unreported above 3 mm %", "s to below 3 mm after the end"], "rows": rows}


def detection(worlds):
    rows = []
    for kind, group in discrepancies(worlds):
        found = rules.detection(group)
        rows.append([kind, str(found["passing"]), f"{found['passing'] - found['detectable']}",
                     number(found["left_out_percent"]), f"{found['in_time']}/{found['detectable']}",
                     number(found["in_time_percent"]), spread(found["delays"], 2)])
    return {"title": "Reported within 0.5 s of the moment at which the error exceeds 3 mm and the wrench differs from "
                     "its prediction by more than three standard deviations",
            "header": ["discrepancy", "worlds", "left out", "%", "in time", "%", "s until the report"], "rows": rows}


def ranking(worlds):
    rows = []
    for kind, group in discrepancies(worlds):
        row = [kind]
        for _, key in RANKINGS:
            found = rules.ranked(group, key)
            row += [f"{found['first']}/{found['reported']}", number(found["first_percent"]),
                    f"{found['first_two']}/{found['reported']}", number(found["first_two_percent"])]
        rows.append(row)
    return {"title": "Whether the true cause is first, and among the first two, of reported worlds",
            "header": ["discrepancy"] + [f"{what} {when}" for when, _ in RANKINGS
                                         for what in ("first", "% first", "first two", "% first two")], "rows": rows}


def confusion(worlds):
    tables = []
    for when, key in RANKINGS:
        counts = rules.confusion(worlds, key)
        causes = sorted({cause for row in counts.values() for cause in row})
        tables.append({"title": f"First cause {when}, by kind", "header": ["discrepancy", *causes], "rows":
                       [[kind, *(str(row.get(cause, 0)) for cause in causes)] for kind, row in counts.items()]})
    return tables


def recovery(worlds):
    rows = []
    contacts = [world for world in worlds if world["kind"] in rules.CONTACTS]
    for kind, group in [*(group for group in by_kind(contacts) if group[0] != "all discrepancies"), ("all", contacts)]:
        found = rules.recovery(group)
        rows.append([kind, str(found["worlds"]), number(found["reached_percent"]), number(found["stay_percent"]),
                     number(found["median_s"], 2), number(found["90_percent_s"], 2)])
    return {"title": "After the end of a contact: at most 0.1 mm worse than by pose alone", "header":
            ["discrepancy", "contacts that end", "reached within 2 s %", "stays from 2 s on %", "s until it stays, median",
             "90 %"], "rows": rows if contacts else []}


def objects_of(worlds):
    names = sorted({world["object"] for world in worlds})
    groups = [(name, [world for world in worlds if world["object"] == name]) for name in names]
    return groups + ([("all", worlds)] if len(names) > 1 else [])


def free_air(worlds):
    none = [world for world in worlds if world["kind"] == "none"]
    rows = []
    for name, group in objects_of(none):
        found, held = rules.free_air(group), rules.intervals(group) or {}
        interval = held.get("covered_interval")
        rows.append([name, str(found["worlds"]), number(found["hours"], 2), str(found["reports"]),
                     str(found["worlds_with_reports"]), number(rules.behind_pose_alone(group), 3),
                     number(held.get("covered_percent"), 1),
                     f"{interval[0]:.1f} to {interval[1]:.1f}" if interval else MISSING,
                     number(held.get("nees"), 2), number(held.get("width"), 2),
                     number(held.get("wrench_covered_percent"), 1), number(held.get("wrench_nees"), 2),
                     number(held.get("log_young_in_deviations"), 2), number(held.get("log_young_covered_percent"))])
    return {"title": "Free air: false reports, error compared with pose alone, intervals", "header":
            ["object", "worlds", "hours", "false reports", "worlds with one", "mean error less pose alone mm",
             "nodes in 95 % ball %", "95 % interval over draws", "NEES of nodes", "95 % radius / 95 % error",
             "wrench in 95 % interval %", "NEES of wrench", "|error of log E| / deviation", "log E in 95 % interval %"],
            "rows": rows}


def false_reports(worlds):
    none = [world for world in worlds if world["kind"] == "none"]
    rows = [[world["name"], number(world["score"]["free_air_s"], 1), str(world["score"]["false_reports"]),
             "; ".join(sorted({report["reason"] for report in world["score"]["reports"]}))]
            for world in none if world["score"]["false_reports"]]
    return {"title": "Draws with false reports in free air", "header": ["world", "s", "reports", "reasons"], "rows": rows}


def tables_of(worlds):
    """Title, header and rows of each table that has rows."""
    tables = [overview(worlds), detection(worlds), ranking(worlds), *confusion(worlds), recovery(worlds),
              free_air(worlds), false_reports(worlds)]
    return [table for table in tables if table["rows"]]


def goal(name, value, limit, at_least, detail, decimals=1, unit=" %"):
    """A goal without a value is not judged."""
    met = None if value is None else (value >= limit if at_least else value <= limit)
    text = f"{number(value, decimals, unit)} (at {'least' if at_least else 'most'} {limit:g}{unit}); {detail}"
    return {"goal": name, "value": value, "limit": limit, "met": met, "text": text}


def goals_of(worlds):
    goals = []
    found = rules.detection(worlds)
    goals += [goal("reported within 0.5 s of passing 3 mm, of the detectable", found["in_time_percent"], 95, True,
                   f"{found['in_time']} of {found['detectable']} worlds"),
              goal("left out as not detectable", found["left_out_percent"], 15, False,
                   f"{found['passing'] - found['detectable']} of {found['passing']} worlds")]
    air = rules.free_air(worlds)
    goals.append(goal("false reports in 10 h of free air", air["per_10_hours"], 10, False,
                      f"{air['reports']} false reports in {air['hours']:.2f} h, {air['worlds']} draws", unit=""))
    goals.append(goal("nodes in their 95 % balls while reported", rules.covered_while_reported(worlds), 90, True, "pooled"))
    after, free = rules.recovery(worlds), rules.undisturbed(worlds)
    goals.append(goal("at most 0.1 mm worse than pose alone from 2 s after a contact on", after["stay_percent"], 95, True,
                      f"{after['stay']} of {after['worlds']} contacts; reached within 2 s in {after['reached']}; in free air "
                      f"{free['near']} of {free['worlds']} worlds"))
    for when, key in RANKINGS:
        found = rules.ranked(worlds, key)
        goals += [goal(f"true cause first, {when}", found["first_percent"], 70, True,
                       f"{found['first']} of {found['reported']} reported worlds"),
                  goal(f"true cause among the first two, {when}", found["first_two_percent"], 90, True,
                       f"{found['first_two']} of {found['reported']} reported worlds")]
    for name, group in objects_of([world for world in worlds if world["kind"] == "none"]):
        goals.append(goal(f"mean error less that of pose alone, {name}", rules.behind_pose_alone(group), 0.03, False,
                          "free air", 3, " mm"))
    held = rules.intervals(worlds)
    if held:
        interval = held["covered_interval"]
        goals += [goal("nodes in their 95 % balls in free air", held["covered_percent"], 90, True,
                       f"{held['worlds']} draws"),
                  goal("upper end of its bootstrap interval over draws", interval and interval[1], 95, True,
                       f"from {interval[0]:.1f} %" if interval else "one draw"),
                  goal("median 95 % radius over 95 % of the errors", held["width"], 2, False, "over points of the objects",
                       2, "")]
    return goals


def text_of(table):
    """A table as lines of text in columns."""
    columns = [table["header"], *table["rows"]]
    widths = [max(len(row[i]) for row in columns) for i in range(len(table["header"]))]
    lines = ["  ".join(cell.ljust(width) if i == 0 else cell.rjust(width)
                       for i, (cell, width) in enumerate(zip(row, widths))).rstrip() for row in columns]
    return "\n".join([table["title"], *lines, ""])


def goals_table(goals):
    said = {True: "met", False: "missed", None: "not judged"}
    return {"title": "Goals", "header": ["goal", "", "measured"],
            "rows": [[entry["goal"], said[entry["met"]], entry["text"]] for entry in goals]}


def panels_of(worlds):
    """Delay of the report, and error in free air by either estimate, over the shares of worlds."""
    from page import curve
    delays, errors = [], []
    for kind, group in discrepancies(worlds):
        passing = [world for world in group if rules.passes(world)]
        late = sorted(world["score"]["reported_s"] - world["score"]["largest_error_passed_s"] for world in passing
                      if world["score"]["reported_s"] is not None)
        if late:
            delays.append(curve(kind, late, [100 * (i + 1) / len(passing) for i in range(len(late))]))
    none = [world["score"] for world in worlds if world["kind"] == "none"]
    for name, key in (("pose and wrench", "average_error_mm"), ("pose alone", "average_error_of_pose_alone_mm")):
        values = sorted(score[key] for score in none if score[key] is not None)
        if values:
            errors.append(curve(name, values, [100 * (i + 1) / len(values) for i in range(len(values))]))
    panels = [{"title": "Reports after the largest error passes 3 mm", "x": "s", "y": "% of such worlds", "curves": delays},
              {"title": "Mean error in free air", "x": "mm", "y": "% of worlds", "curves": errors}]
    return [panel for panel in panels if panel["curves"]]


def page_of(study):
    """HTML text of the study; needs Jinja and matplotlib."""
    from page import Markup, document, draw, element, figure, table
    out = [element("p", f"palpate {study['version']}, set {study['set']}, seed {study['seed']}; "
                        f"{len(study['worlds'])} worlds.")]
    out += [element("pre", failure) for failure in study["failures"]]
    for part in [goals_table(study["goals"]), *study["tables"]]:
        out += [element("h2", part["title"]), table(part["header"], part["rows"], figures=True)]
    if panels := panels_of(study["worlds"]):
        out.append(figure(draw(panels), "svg+xml", "Shares of worlds"))
    return document("palpate: worlds that the model does not describe", Markup("").join(out))
