"""A plan as YAML and as a picture."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import yaml

from palpate_calibrate.plan import Plan, Room
from palpate_common.rotations import to_rpy

_SHOWN = {"mass": ("mass", "kg", 1), "moment": ("center_of_mass", "mm", 1e3),
          "sensor_rotation": ("sensor_rotation", "deg", np.degrees(1)),
          "force_bias": ("force_bias", "N", 1), "torque_bias": ("torque_bias", "N m", 1),
          "imu_rotation": ("imu_rotation", "deg", np.degrees(1))}  # fmt: skip


def document(plan: Plan) -> dict[str, Any]:
    """Poses of the flange in the base as in a configuration, and the expected half widths of 95 % intervals."""
    poses = [{"position": [round(float(v), 4) for v in p], "rpy_deg": [round(float(v), 2) for v in np.degrees(to_rpy(r))]}
             for p, r in zip(plan.positions, plan.rotations)]  # fmt: skip
    expected = {name: {"half_width": float(f"{1.96 * factor * plan.expected[block].max():.3g}"), "unit": unit}
                for block, (name, unit, factor) in _SHOWN.items() if block in plan.expected}  # fmt: skip
    return {"poses": poses, "expected": expected}


def table(plan: Plan) -> str:
    """For people."""
    values = document(plan)
    lines = [f"{len(plan.positions)} poses of the flange in the base, to be visited in this order and held for 1 s each:", "",
             f"  {'x':>8}{'y':>8}{'z':>8} m{'roll':>9}{'pitch':>9}{'yaw':>9} deg"]  # fmt: skip
    for pose in values["poses"]:
        place, angles = ("".join(f"{v:>{w}}" for v in values) for values, w in
                         (([f"{v:.3f}" for v in pose["position"]], 8), ([f"{v:.1f}" for v in pose["rpy_deg"]], 9)))  # fmt: skip
        lines.append(f"  {place}  {angles}")
    lines += ["", "Expected 95 % intervals from these poses at rest:"]
    lines += [f"  {name:<18}+- {entry['half_width']:g} {entry['unit']}" for name, entry in values["expected"].items()]
    lines += ["", "For delays and inertia: record the whole motion, and turn to and fro by 2 degrees at about 0.7 Hz about "
              "each axis."]  # fmt: skip
    return "\n".join(lines)


def write_yaml(plan: Plan, file: Path) -> None:
    text = yaml.safe_dump(document(plan), sort_keys=False, default_flow_style=None, width=120)
    file.write_text("# Written by palpate-calibrate wrist --plan\n" + text)


def plot_plan(plan: Plan, room: Room, file: Path) -> None:
    """The poses as triads with their numbers, the way between them, and the room."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure = pyplot.figure(figsize=(8, 7))
    axes = figure.add_subplot(projection="3d")
    length = 0.25 * float(np.max(room.upper - room.lower)) + 0.02
    axes.plot(*plan.positions.T, "-", color="0.7", linewidth=0.8)
    for i, (p, r) in enumerate(zip(plan.positions[:-1], plan.rotations[:-1])):
        for k, colour in enumerate(("tab:red", "tab:green", "tab:blue")):
            end = p + length * r[:, k]
            axes.plot(*np.array([p, end]).T, color=colour, linewidth=1.2)
        axes.text(*p, str(i + 1), fontsize=9)
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    for a in corners:
        for b in corners:
            if np.abs(a - b).sum() == 1:
                edge = room.lower + np.array([a, b]) * (room.upper - room.lower)
                axes.plot(*edge.T, ":", color="0.5", linewidth=0.8)
    axes.set(xlabel="x of W, m", ylabel="y, m", zlabel="z, m",
             title="flange: x red, y green, z blue; dotted: room of its origin")  # fmt: skip
    axes.set_box_aspect((1, 1, 1))
    middle, half = (room.lower + room.upper) / 2, float(np.max(room.upper - room.lower)) / 2 + length
    for setter, value in zip((axes.set_xlim, axes.set_ylim, axes.set_zlim), middle):
        setter(value - half, value + half)
    figure.tight_layout()
    figure.savefig(file, dpi=110)
    pyplot.close(figure)
