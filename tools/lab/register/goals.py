"""Goals of the registration and what a number of set-ups reached."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from goal_text import goal_line, interval_lines, rms

Floats = NDArray[np.float64]
WITHIN = {"bar": (0.9e-3, 0.5), "cube": (0.6e-3, 0.8)}  # m, degrees
WITHIN_SEEN = 1.5e-3  # m
FOUND = (2e-3, 3.0)  # m, degrees: of the true pose
SHARE = 0.95  # of the set-ups
RATIO = 1.3  # of root mean squares, error over bound
Z95 = 1.959964


def _sizes(errors: Floats) -> tuple[Floats, Floats]:
    """Of (n, 6) errors: position, m, and angle, degrees, (n,) each."""
    return np.linalg.norm(errors[:, :3], axis=1), np.degrees(np.linalg.norm(errors[:, 3:], axis=1))


def text_of(name: str, by: str, results: list[dict[str, Any]]) -> tuple[str, dict[str, float]]:
    """Lines with each goal, what was reached, and whether it is met; and the numbers."""
    if by == "everywhere":
        return _found_text(name, results)
    column = {key: np.array([result[key] for result in results], float)
              for key in ("error", "deviation", "absolute", "bound", "misses", "fits")}  # fmt: skip
    position, angle = _sizes(column["error"])
    lines = [f"{name}, {len(results)} set-ups, {'12 touches' if by == 'touched' else 'cloud and 4 touches'}"]
    values = {"position_95_mm": 1e3 * float(np.quantile(position, SHARE)), "angle_95_deg": float(np.quantile(angle, SHARE))}
    if by == "touched":
        bound_p = np.sqrt(column["bound"][:, :3].sum(axis=1))
        bound_a = np.degrees(np.sqrt(column["bound"][:, 3:].sum(axis=1)))
        for what, unit, factor, error, bound in (("position", "mm", 1e3, position, bound_p),
                                                 ("angle", "degree", 1.0, angle, bound_a)):  # fmt: skip
            ratio = rms(error) / rms(bound)
            values[f"{what}_ratio"] = ratio
            reached = f"{factor * rms(error):.3f} / {factor * rms(bound):.3f} {unit} = {ratio:.2f}"
            lines.append(goal_line(f"{what}, RMS error / RMS Cramer-Rao bound", reached, f"at most {RATIO}", ratio <= RATIO))
        most_p, most_a = WITHIN[name]
        share = float(np.mean((position <= most_p) & (angle <= most_a)))
        lines.append(goal_line(f"within {1e3 * most_p:g} mm and {most_a:g} degree", f"{100 * share:.0f} %",
                               f"at least {100 * SHARE:.0f} %", share >= SHARE))  # fmt: skip
    else:
        share = float(np.mean(position <= WITHIN_SEEN))
        lines.append(goal_line(f"position within {1e3 * WITHIN_SEEN:g} mm", f"{100 * share:.0f} %",
                               f"at least {100 * SHARE:.0f} %", share >= SHARE))  # fmt: skip
    values["share"] = share
    of_intervals, numbers = interval_lines(column["error"], Z95 * column["deviation"], column["deviation"])
    lines += of_intervals
    values.update(numbers)
    lines.append(f"  95 % of positions within {values['position_95_mm']:.2f} mm, of angles within {values['angle_95_deg']:.2f} degree; largest "
                 f"{1e3 * position.max():.2f} mm, {angle.max():.2f} degree; misses per set-up {column['misses'].mean():.1f}; "
                 f"the mesh fits in {100 * column['fits'].mean():.0f} %")  # fmt: skip
    with_arm, _ = _sizes(column["absolute"])
    lines.append(f"  with the arm's constant error: 95 % of positions within {1e3 * np.quantile(with_arm, SHARE):.2f} mm")
    values["absolute_95_mm"] = 1e3 * float(np.quantile(with_arm, SHARE))
    if by == "seen":
        alone, _ = _sizes(np.array([result["by_cloud_alone"] for result in results]))
        values["cloud_alone_95_mm"] = 1e3 * float(np.quantile(alone, SHARE))
        lines.append(f"  by the cloud alone: 95 % of positions within {values['cloud_alone_95_mm']:.1f} mm")
    return "\n".join(lines), values


def _found_text(name: str, results: list[dict[str, Any]]) -> tuple[str, dict[str, float]]:
    position, angle = _sizes(np.array([result["error"] for result in results]))
    same = float(np.mean((position <= FOUND[0]) & (angle <= FOUND[1])))
    return (f"{name}, {len(results)} set-ups, 12 touches without a guess\n  the search over all poses ends within {1e3 * FOUND[0]:g} mm and "
            f"{FOUND[1]:g} degrees of the true pose or one alike in {100 * same:.0f} %"), {"found": same}  # fmt: skip
