"""Results as text and as JSON."""

from __future__ import annotations

from typing import Any

import numpy as np

from palpate_calibrate.camera.camera_fit import CameraFit
from palpate_calibrate.camera.output import pose_section
from palpate_common.rotations import to_rpy, to_wxyz

_ADVICE = {"touches": "touch points that are spread over the workspace in all directions",
           "tool": "add clouds with the flange in other places and directions, in which more of the tool is seen",
           "marker": "add images with the flange in other places, rotated by 30 degrees or more about all axes"}  # fmt: skip


def _groups(fit: CameraFit) -> list[dict[str, Any]]:
    found = []
    for group in fit.estimate.groups:
        residuals, gross = fit.residuals(group), np.unique(fit.gross(group) // group.each)
        found.append({"name": group.name, "count": len(residuals), "rms": float(np.sqrt(np.mean(residuals**2))),
                      "deviation": fit.deviation(group), "unit": group.unit, "gross": gross.tolist()})  # fmt: skip
    return found


def summary(fit: CameraFit, notes: list[str]) -> dict[str, Any]:
    """Everything that the table shows; m and rad, the groups of residuals in their units. gross: measurements, from 0."""
    return {"way": fit.way, "source": fit.source, "camera_in_base": pose_section(fit.pose),
            "half_widths": {"position": fit.half_widths[:3].tolist(), "rotation": fit.half_widths[3:].tolist()},
            "covariance": fit.covariance.tolist(), "others": {name: pose_section(pose) for name, pose in fit.others.items()},
            "residuals": _groups(fit), "not_determined": fit.undetermined, "notes": notes}  # fmt: skip


def table(fit: CameraFit, notes: list[str]) -> str:
    """For people: the pose with its intervals, the residuals, and what is not determined."""
    half = np.concatenate([1e3 * fit.half_widths[:3], np.degrees(fit.half_widths[3:])])
    lines = [f"{fit.source}: pose of the camera in the base, by {fit.way}", "", f"  {'':<22}{'value':>12}   95 % interval"]
    for i, axis in enumerate("xyz"):
        lines.append(f"  {'position ' + axis:<22}{1e3 * fit.pose.p[i]:>12.2f}   +- {half[i]:<9.2g} mm")
    for i, axis in enumerate("xyz"):
        lines.append(f"  {'rotation about ' + axis:<22}{'':>12}   +- {half[3 + i]:<9.2g} degree")
    lines.append(f"  quaternion (w x y z)    {' '.join(f'{v:.6f}' for v in to_wxyz(fit.pose.R))}")
    lines.append(f"  roll, pitch, yaw        {' '.join(f'{v:.3f}' for v in np.degrees(to_rpy(fit.pose.R)))} degree")
    lines.append("")
    for name, pose in fit.others.items():
        section = pose_section(pose)
        lines.append(f"  {name}: position {section['position']} m, quaternion {section['quaternion']}")
    for entry in _groups(fit):
        lines.append(f"  residual of {entry['name']}: {entry['rms']:.3g} {entry['unit']} RMS of {entry['count']}, "
                     f"standard deviation {entry['deviation']:.3g}, {len(entry['gross'])} gross errors")  # fmt: skip
        if fit.way == "touches" and entry["gross"]:
            lines.append(f"    of the points {', '.join(str(i + 1) for i in entry['gross'])}")
    lines += [f"  {note}" for note in notes]
    if fit.undetermined:
        lines += ["", f"Not determined: {'; '.join(fit.undetermined)}. Remedy: {_ADVICE[fit.way]}"]
    return "\n".join(lines)
