"""How many clouds and points were used, and why the others were not."""

from __future__ import annotations

from typing import Any

# In the order of the steps.
CLOUDS = ("received", "malformed", "superseded", "old", "ahead", "out_of_order", "without_joints", "too_few_points",
          "published")  # fmt: skip
POINTS = ("received", "not_finite", "range", "crop", "colour", "obstacles", "robot", "edges", "outliers", "thinning",
          "few", "published")  # fmt: skip


class Counters:
    """clouds, points: numbers since the start by reason; all but `received` and `published` were removed. `few` are points
    of clouds of which too few were left; those of clouds that were not used are in `received` only. refused_states: joint
    states that cannot be used."""

    def __init__(self) -> None:
        self.refused_states = 0
        self.clouds = dict.fromkeys(CLOUDS, 0)
        self.points = dict.fromkeys(POINTS, 0)

    def refuse_cloud(self, reason: str) -> None:
        """Counts a cloud that no step has seen, for a reason of CLOUDS."""
        self.clouds["received"] += 1
        self.clouds[reason] += 1

    def line(self) -> str:
        """Each in one line, without the reasons that did not occur."""
        states = f"\njoint states: {self.refused_states} refused" if self.refused_states else ""
        return f"clouds: {_shown(self.clouds)}\npoints: {_shown(self.points)}{states}"

    def as_json(self) -> dict[str, Any]:
        """For --json."""
        return {"clouds": dict(self.clouds), "points": dict(self.points), "refused_states": self.refused_states}


def _shown(numbers: dict[str, int]) -> str:
    always = ("received", "published")
    return ", ".join(f"{count} {name.replace('_', ' ')}" for name, count in numbers.items() if count or name in always)
