"""Goals of the camera's calibration and what a number of draws reached."""

from __future__ import annotations

from typing import Any

import numpy as np

from goal_text import goal_line, interval_lines

WITHIN = (2.0, 0.2)  # mm, degrees
SHARE = 0.95  # of the draws


def text_of(way: str, results: list[dict[str, Any]]) -> tuple[str, dict[str, float]]:
    """Lines with each goal, what was reached, and whether it is met; and the numbers."""
    keys = ("error", "half_width", "deviation")
    error, half_width, deviation = (np.array([result[key] for result in results]) for key in keys)
    position, angle = 1e3 * np.linalg.norm(error[:, :3], axis=1), np.degrees(np.linalg.norm(error[:, 3:], axis=1))
    lines, values = [f"by {way}, {len(results)} draws"], {}
    for what, unit, sizes, most in (("position of C", "mm", position, WITHIN[0]), ("rotation", "degree", angle, WITHIN[1])):
        reached = float(np.quantile(sizes, SHARE))
        values[what.split()[0]] = reached
        lines.append(goal_line(f"{what}, 95 % of the draws within", f"{reached:.2f} {unit}", f"at most {most:g} {unit}",
                               reached <= most))  # fmt: skip
    of_intervals, numbers = interval_lines(error, half_width, deviation)
    lines += of_intervals
    values.update(numbers)
    at_work = 1e3 * np.array([result["at_work"] for result in results])
    values["at_work"] = float(np.quantile(at_work, SHARE))
    lines.append(f"  median {np.median(position):.2f} mm and {np.median(angle):.3f} degree, largest {position.max():.2f} mm "
                 f"and {angle.max():.3f} degree; a point in the workspace's middle: 95 % within {values['at_work']:.2f} mm")
    return "\n".join(lines), values
