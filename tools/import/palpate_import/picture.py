"""A picture of what was understood."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate_import.recording import Channel
from palpate_import.summary import GAP

Floats = NDArray[np.float64]
MOST_DRAWN = 4000  # points of a curve: of longer ones the lowest and highest of each part
MOST_GAPS = 200  # that are shaded
_CURVES: dict[str, list[tuple[str, str, int, tuple[str, ...]]]] = {
    "force_torque": [("force, N", "wrench", 0, ("fx", "fy", "fz")), ("torque, Nm", "wrench", 3, ("tx", "ty", "tz"))],
    "imu": [("specific force, m/s²", "acceleration", 0, ("ax", "ay", "az")),
            ("angular velocity, rad/s", "angular_velocity", 0, ("wx", "wy", "wz"))],
    "robot_state": [("position, m", "position", 0, ("px", "py", "pz")), ("quaternion", "quaternion", 0, ("qw", "qx", "qy", "qz")),
                    ("twist, m/s and rad/s", "twist", 0, ("vx", "vy", "vz", "wx", "wy", "wz"))],
    "biotac": [("electrodes, counts", "electrodes", 0, tuple(f"e{i + 1}" for i in range(19)))],
}  # fmt: skip


def _panels(channel: Channel) -> list[tuple[str, Floats, list[str]]]:
    messages = channel.messages
    made = [(label, np.array(messages[name][:, first : first + len(names)], float), list(names))
            for label, name, first, names in _CURVES.get(channel.format, [])]  # fmt: skip
    if channel.format == "robot_state":
        count = int(messages["joint_count"].max())
        made.append(("joints, rad", np.array(messages["q"][:, :count], float), [f"q{i + 1}" for i in range(count)]))
    if channel.format == "biotac":
        made.append(("counts", np.array([messages[name] for name in ("pdc", "tac", "tdc")], float).T, ["pdc", "tac", "tdc"]))
    if channel.format == "hand_state":
        tips, joints = int(messages["fingertip_count"].max()), int(messages["joint_count"].max())
        made.append(("fingertips, m", np.array(messages["fingertip_position"][:, :tips], float).reshape(len(messages), -1),
                     [f"f{i}p{axis}" for i in range(tips) for axis in "xyz"]))  # fmt: skip
        made.append(("joints, rad", np.array(messages["q"][:, :joints], float), [f"q{i + 1}" for i in range(joints)]))
    if channel.format == "shape_observation":
        made += [
            ("points", np.array(messages["count"], float)[:, None], ["count"]),
            ("mean of the points, m", _means(messages), ["x", "y", "z"]),
        ]
    return [panel for panel in made if panel[2]]


def _means(messages: NDArray[Any]) -> Floats:
    count = np.array(messages["count"], float)[:, None]
    return np.asarray(np.array(messages["points"], float).sum(axis=1) / np.where(count > 0, count, np.nan))


def _thinned(time: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Of a long curve the lowest and the highest value of each part, so that no peak is lost."""
    parts = MOST_DRAWN // 2
    if len(time) <= MOST_DRAWN:
        return time, values
    kept = len(time) // parts * parts
    blocks = values[:kept].reshape(parts, -1)
    pairs = np.sort(np.stack([blocks.argmin(axis=1), blocks.argmax(axis=1)], axis=1), axis=1)
    index = np.unique((pairs + np.arange(parts)[:, None] * blocks.shape[1]).ravel())
    return time[index], values[index]


def draw(channels: list[Channel], path: Path) -> None:
    """PNG, SVG or PDF by the suffix: a row a channel, grey where it has gaps. Raises OSError, or ValueError for another suffix."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    panels = [_panels(channel) for channel in channels]
    columns = max(len(row) for row in panels)
    figure, axes = pyplot.subplots(len(channels), columns, squeeze=False, sharex=True, layout="constrained",
                                   figsize=(4.6 * columns, 2.5 * len(channels)))  # fmt: skip
    start = min(int(channel.utimes[0]) for channel in channels)
    for row, channel, own in zip(axes, channels, panels):
        time = (channel.utimes - start) * 1e-6
        steps = np.diff(time)
        gaps = np.flatnonzero(steps > GAP * max(float(np.median(steps)), 1e-6)) if steps.size else steps.astype(int)
        for on, panel in zip(row, own):
            label, values, names = panel
            for i, name in enumerate(names):
                on.plot(*_thinned(time, values[:, i]), linewidth=0.8, label=name)
            for k in gaps[:MOST_GAPS]:
                on.axvspan(time[k], time[k + 1], color="#ddd", zorder=0)
            on.set_title(f"{channel.name}: {label}", fontsize=9)
            on.tick_params(labelsize=7)
            on.grid(alpha=0.3)
            if len(names) <= 8:
                on.legend(fontsize=6, loc="upper right", ncols=2)
        for on in row[len(own) :]:
            on.set_visible(False)
    for on in axes[-1]:
        on.set_xlabel("time from the first message, s", fontsize=8)
    figure.savefig(path, dpi=110)
    pyplot.close(figure)
