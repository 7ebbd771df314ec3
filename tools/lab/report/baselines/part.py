"""One half of the report: a study's runs compared with palpate's own, as HTML and as lines of
text.
"""
import functools

from baselines.markdown import seeds_of
from baselines.runs import of
from baselines.statistics import cell, differences, mean_difference, verdict
from baselines.tuning import words as words_of_tuning
from page import Markup, element, error_plot, picture, section, table


class Part:
    """Definition of a study in the report.

    runs: of baselines.runs. about: a file of pages. levels: in order. measures: (key, name, unit,
    difference below which two count as equal); less is better. columns: (title, function of runs to
    text). baselines: (method of ours, level at which it is compared regardless of the other
    method's; None: the other method's level, description of that in the report). settings: by
    method. trials: of baselines.tuning.
    """

    def __init__(self, title, runs, about, levels, measures, columns, baselines, settings=None,
                 trials=None):
        self.title, self.runs, self.about = title, runs, about
        self.measures, self.columns = measures, columns
        self.settings, self.trials = settings or {}, trials or {}
        self.levels = [level for level in levels if of(runs, level=level)]
        known = about["methods"]
        missing = sorted({run["method"] for run in runs} - set(known))
        if missing:
            raise SystemExit(f"{title}: no page describes {', '.join(missing)}")
        self.methods = [method for method in known if of(runs, method=method)]
        self.baselines = [base for base in baselines if of(runs, method=base[0])]
        self.published = [m for m in self.methods if known[m]["row"] != "ours"]

    @functools.cache
    def comparisons(self, own, at, task=None):
        """Each method compared with one of ours at each level, over all tasks that both have,
        or on one.
        """
        runs = of(self.runs, application=task) if task else self.runs
        rows = []
        for level in self.levels:
            if not at and (own, level) in {base[:2] for base in self.baselines}:
                continue  # which the other method reports
            ours = of(runs, method=own, level=at or level)
            for method in self.methods:
                if method == own and level == (at or level):
                    continue
                theirs = of(runs, method=method, level=level)
                by_measure = [differences(ours, theirs, key) for key, *_ in self.measures]
                if not by_measure[0]:
                    continue
                means = [mean_difference(d) for d in by_measure]
                rows.append({"level": level, "method": method, "differences": means,
                             "verdicts": [verdict(*mean, margin) for mean, (*_, margin)
                                          in zip(means, self.measures)],
                             "runs": sum(map(len, by_measure[0].values())),
                             "tasks": len(by_measure[0]),
                             "seeds": ", ".join(map(str, sorted({run["seed"] for run in theirs} &
                                                                {run["seed"] for run in ours})))})
        return rows

    def first_lines(self):
        """Which method wins or ties: plain text, the shortest first."""
        lines, wins, ties = [], {}, {}
        for own, at, words in self.baselines:
            for level in self.levels:
                here = [row for row in self.comparisons(own, at)
                        if row["level"] == level and row["method"] in self.published]
                if not here:
                    continue
                parts = []
                for i, (_, name, *_) in enumerate(self.measures):
                    for kind, word, somewhere in (("ahead", "win", wins), ("tie", "tie", ties)):
                        names = [row["method"] for row in here if row["verdicts"][i] == kind]
                        somewhere.update(dict.fromkeys(names))
                        if names:
                            parts.append(f"by {name} {word}: {'; '.join(names)}")
                lines.append(f"{level}, {len(here)} methods compared with {own}, {words}: " +
                             (" - ".join(parts) if parts else "none wins or ties") + ".")
        only_ties = [method for method in ties if method not in wins]
        on_tasks = self.on_single_tasks(wins)
        return [f"{self.title}: {len(wins) + len(only_ties)} of {len(self.published)} other methods win or "
                "tie with one of palpate's own by some measure, at some level of vision, in the mean of all "
                f"tasks. Win somewhere: {'; '.join(wins) or 'none'}. "
                f"Only tie: {'; '.join(only_ties) or 'none'}. In addition, these win on a single task: " +
                ("; ".join(f"{m} ({', '.join(where)})" for m, where in on_tasks.items()) or "none") +
                "."] + lines

    def on_single_tasks(self, known):
        """Tasks by published method that is better there than one of ours, except those in
        `known`.
        """
        found = {}
        for task in dict.fromkeys(run["application"] for run in self.runs):
            for own, at, _ in self.baselines:
                for row in self.comparisons(own, at, task):
                    if row["method"] in self.published and "ahead" in row["verdicts"]:
                        found.setdefault(row["method"], {})[task] = None
        return {method: list(where) for method, where in found.items() if method not in known}

    def verdicts(self):
        """A table for each of ours: one row per method, one column per level of vision, one
        word per measure.
        """
        out = []
        for own, at, words in self.baselines:
            rows = {row["method"]: {} for row in self.comparisons(own, at)}
            for row in self.comparisons(own, at):
                rows[row["method"]][row["level"]] = " / ".join(row["verdicts"])
            levels = [level for level in self.levels if any(level in row for row in rows.values())]
            measures = " / ".join(name for _, name, *_ in self.measures)
            out.append(Markup("<p>Compared with <b>{}</b>, {}; {}:</p>").format(own, words, measures))
            out.append(table(["method"] + levels,
                             [[method] + [row.get(level, "") for level in levels]
                              for method, row in rows.items()]))
        return Markup("").join(out)

    def comparison_tables(self):
        out = []
        for own, at, words in self.baselines:
            header = ["vision", "method"]
            for _, name, unit, _ in self.measures:
                header += [f"{name}, {unit}, minus that of {own}, {words}", "method is"]
            rows = []
            for row in self.comparisons(own, at):
                cells = [row["level"], row["method"]]
                for mean, word in zip(row["differences"], row["verdicts"]):
                    cells += ["{:+.2f} ({:+.2f} to {:+.2f})".format(*mean), word]
                rows.append(cells + [f"{row['runs']} on {row['tasks']}", row["seeds"]])
            if rows:
                out.append(table(header + ["runs, tasks", "seeds"], rows))
        return Markup("").join(out)

    def row(self, runs):
        return [function(runs) for _, function in self.columns] + [
            seeds_of(runs, self.levels) +
            (f", {failed} failed" if (failed := len(of(runs, failed=True))) else "")]

    def header(self):
        return [title for title, _ in self.columns] + ["seeds"]

    def task(self, application):
        out = [element("h2", application)]
        for level in self.levels:
            here = of(self.runs, application=application, level=level)
            methods = [method for method in self.methods if of(here, method=method)]
            if not here:
                continue
            out.append(element("h3", level))
            out.append(table(["method"] + self.header(),
                             [[m] + self.row(of(here, method=m)) for m in methods]))
            seed = min(run["seed"] for run in here)
            out.append(error_plot([(m, run["curve"]) for m in methods
                                   for run in of(here, method=m, seed=seed)]))
        return section(*out)

    def method_page(self, method):
        about = self.about["methods"][method]
        facts = [(key, about[key]) for key in ("row", "cites", "source", "consumes", "keeps",
                                               "leaves out", "note") if key in about]
        settings = "; ".join(self.settings.get(method, []))
        out = [element("h2", method),
               table(["", ""], facts + [("tuned by", words_of_tuning(method, self.trials))] +
                     ([("settings", settings)] if settings else []))]
        here = of(self.runs, method=method)
        groups = dict.fromkeys((run["application"], level) for run in here for level in self.levels)
        rows = [[application, level] + self.row(runs) for application, level in groups
                if (runs := of(here, application=application, level=level))]
        out.append(table(["task", "vision"] + self.header(), rows))
        seed = min(run["seed"] for run in here)
        shown = of(here, level="noisy vision", seed=seed) or of(here, seed=seed)
        out.append(error_plot([(f"{run['application']}, {run['level']}", run["curve"])
                               for run in shown]))
        for run in shown:  # the last state for which there is an image
            for file in sorted(run["folder"].glob("state_*.png"))[-1:]:
                out.append(picture(file, f"{run['application']}, {run['level']}", 360))
        return section(*out)

    def no_score(self):
        return table(["row", "work", "why it has no score"],
                     [[f"[{entry['row']}]", entry["cites"], entry["reason"]]
                      for entry in self.about["no score"]])

    def seeds(self):
        """Number of seeds behind the figures: it may differ between them."""
        rows = []
        for application in dict.fromkeys(run["application"] for run in self.runs):
            here = of(self.runs, application=application)
            for level in self.levels:
                by_method = {}
                for run in of(here, level=level):
                    by_method.setdefault(run["method"], set()).add(run["seed"])
                if not by_method:
                    continue
                seeds = sorted(set().union(*by_method.values()))
                fewer = [f"{m} {sorted(s)}" for m, s in by_method.items() if sorted(s) != seeds]
                rows.append([application, level, ", ".join(map(str, seeds)), "; ".join(fewer)])
        return table(["task", "vision", "seeds", "methods with fewer"], rows)

    def body(self):
        out = [section(element("h2", f"{self.title}: differences"), self.comparison_tables(),
                       self.no_score(), self.seeds())]
        out += [self.task(a) for a in dict.fromkeys(run["application"] for run in self.runs)]
        out += [self.method_page(method) for method in self.methods]
        return Markup("").join(out)
