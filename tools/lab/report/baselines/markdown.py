"""The same tables as text, for documents."""
import statistics

from baselines.runs import of


def seeds_of(runs, levels):
    """"1, 2", and if a level has different ones "1, 2 (blind: 1)"."""
    by_level = {level: tuple(sorted({run["seed"] for run in of(runs, level=level)})) for level in levels}
    by_level = {level: seeds for level, seeds in by_level.items() if seeds}

    def text(seeds):
        return ", ".join(map(str, seeds))
    most = max(by_level.values(), key=len)
    others = "; ".join(f"{level}: {text(seeds)}" for level, seeds in by_level.items() if seeds != most)
    return text(most) + (f" ({others})" if others else "")


def control_cell(runs):
    error, time = (statistics.median(run[key] for run in runs) for key in ("error", "time_2mm"))
    reached = 2 * sum(run["reached_2mm"] for run in runs) > len(runs)
    return f"{error:.2f}, " + (f"{time:.1f} s" if reached else "never")


def sensing_cell(runs):
    return " / ".join(f"{statistics.median(run[key] for run in runs):.2f}" for key in ("mean", "hausdorff"))


def table(header, rows):
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"


def tasks(part, cell):
    """A table per task: one row per method with its seeds, one column per level of vision."""
    out = []
    for application in dict.fromkeys(run["application"] for run in part.runs):
        here = of(part.runs, application=application)
        levels = [level for level in part.levels if of(here, level=level)]
        rows = [[method] + [cell(runs) if (runs := of(own, level=level)) else "" for level in levels] +
                [seeds_of(own, levels)]
                for method in part.methods if (own := of(here, method=method))]
        out.append(f"### {application}\n\n" + table(["method", *levels, "seeds"], rows))
    return "\n".join(out)


def page(parts_and_cells, note):
    out = [note + "\n"]
    for part, cell in parts_and_cells:
        out.append(f"## {part.title}\n\n" + "\n".join(f"- {line}" for line in part.first_lines()) + "\n")
        out.append(tasks(part, cell))
    return "\n".join(out)
