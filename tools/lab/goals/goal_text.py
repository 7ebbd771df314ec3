"""Lines of a study: what was reached, the goal, and whether it is met."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
LEAST_HOLD, NOMINAL = 0.90, 0.95  # share of intervals that contain the truth
TOO_WIDE = 2.0  # factor by which intervals may be wider than needed
RESAMPLES = 2000


def rms(values: Any) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def bootstrap(share_of_draw: Floats) -> tuple[float, float]:
    """95 % interval of a mean over draws, (n,)."""
    random = np.random.default_rng(0)
    chosen = random.integers(0, len(share_of_draw), (RESAMPLES, len(share_of_draw)))
    low, high = np.quantile(share_of_draw[chosen].mean(axis=1), [0.025, 0.975])
    return float(low), float(high)


def goal_line(what: str, reached: str, goal: str, is_met: bool) -> str:
    """One line."""
    return f"  {what:50}{reached:>26}   goal {goal:24}{'met' if is_met else 'MISSED'}"


def interval_lines(errors: Floats, half_widths: Floats, deviations: Floats) -> tuple[list[str], dict[str, float]]:
    """Of errors, half widths of 95 % intervals and stated deviations, (draws, parameters) each; and the numbers."""
    inside = np.abs(errors) <= half_widths
    low, high = bootstrap(inside.mean(axis=1))
    wide = 1 / rms(errors / deviations)
    hold = float(inside.mean())
    lines = [goal_line("95 % intervals that hold, pooled", f"{100 * hold:.1f} %", f"at least {100 * LEAST_HOLD:.0f} %",
                       hold >= LEAST_HOLD),
             goal_line("  their bootstrap interval", f"{100 * low:.1f} to {100 * high:.1f} %", "reaches 95 % or more",
                       high >= NOMINAL),
             goal_line("  stated deviation / error", f"{wide:.2f}", f"at most {TOO_WIDE:g}", wide <= TOO_WIDE)]  # fmt: skip
    return lines, {"inside": hold, "inside_low": low, "inside_high": high, "wide": wide}
