"""What was understood: a short table, and the same for JSON."""

from __future__ import annotations

from typing import Any

import numpy as np

from palpate_import.quantities import MAGNITUDES, values_of
from palpate_import.recording import Channel

GAP = 5  # times the median interval: longer ones are gaps
_UNITS = {
    "force": "N",
    "torque": "Nm",
    "acceleration": "m/s2",
    "angular_speed": "rad/s",
    "speed": "m/s",
    "joint_speed": "rad/s",
}


def gaps_of(channel: Channel) -> tuple[int, float]:
    """Intervals above GAP medians: how many, and the longest interval at all, s."""
    steps = np.diff(channel.utimes) * 1e-6
    if not steps.size:
        return 0, 0.0
    return int((steps > GAP * max(float(np.median(steps)), 1e-6)).sum()), float(steps.max())


def rate_of(channel: Channel) -> float:
    """Hz; 0 for one message."""
    seconds = (channel.utimes[-1] - channel.utimes[0]) * 1e-6
    return float((len(channel.utimes) - 1) / seconds) if seconds > 0 else 0.0


def ranges_of(channel: Channel) -> dict[str, tuple[float, float]]:
    """Lowest and highest value of the main quantities of a channel, SI."""
    if channel.format == "biotac":
        return {
            name: (float(channel.messages[name].min()), float(channel.messages[name].max())) for name in ("electrodes", "pdc")
        }
    if channel.format == "shape_observation":
        return {"count": (float(channel.messages["count"].min()), float(channel.messages["count"].max()))}
    names = list(MAGNITUDES.get(channel.format, {}))
    found = {name: values_of(channel, name) for name in names}
    ranges = {name: (float(values.min()), float(values.max())) for name, values in found.items()}
    if channel.format == "robot_state":
        for i, axis in enumerate("xyz"):
            positions = channel.messages["position"][:, i]
            ranges[f"p{axis}"] = (float(positions.min()), float(positions.max()))
    if channel.format == "hand_state":
        ranges["fingertip_count"] = (
            float(channel.messages["fingertip_count"].min()),
            float(channel.messages["fingertip_count"].max()),
        )
    return ranges


def document(channel: Channel) -> dict[str, Any]:
    """For JSON."""
    gaps, longest = gaps_of(channel)
    return {"format": channel.format, "recording": channel.path, "messages": len(channel.utimes),
            "first_utime": int(channel.utimes[0]), "last_utime": int(channel.utimes[-1]), "rate": rate_of(channel), "gaps": gaps,
            "longest_interval": longest, "ranges": {name: list(pair) for name, pair in ranges_of(channel).items()}}  # fmt: skip


def table(channels: list[Channel]) -> str:
    """One line a channel, times in s from the first message of all."""
    start = min(int(channel.utimes[0]) for channel in channels)
    lines = [("channel", "messages", "from s", "to s", "Hz", "gaps", "longest s", "range")]
    for channel in channels:
        gaps, longest = gaps_of(channel)
        ranges = [f"{name} {low:.3g} to {high:.3g}{' ' + _UNITS[name] if name in _UNITS else ''}"
                  for name, (low, high) in list(ranges_of(channel).items())[:3]]  # fmt: skip
        lines.append((channel.name, str(len(channel.utimes)), f"{(channel.utimes[0] - start) * 1e-6:.3f}",
                      f"{(channel.utimes[-1] - start) * 1e-6:.3f}", f"{rate_of(channel):.1f}", str(gaps), f"{longest:.4f}",
                      ", ".join(ranges)))  # fmt: skip
    widths = [max(len(line[i]) for line in lines) for i in range(len(lines[0]))]
    padded = [
        [cell.ljust(width) if i in (0, 7) else cell.rjust(width) for i, (cell, width) in enumerate(zip(line, widths))]
        for line in lines
    ]
    return "\n".join("  " + "  ".join(line).rstrip() for line in padded)
