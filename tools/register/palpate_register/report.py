"""The result as a table and as JSON."""

from __future__ import annotations

from typing import Any

import numpy as np

from palpate_common.rotations import log_rotation, to_wxyz
from palpate_register.next_touch import Touch
from palpate_register.observations import Observations
from palpate_register.register import Registration

Z95 = 1.959964  # standard deviations of a 95 % interval


def table(result: Registration, observed: Observations, proposals: list[Touch]) -> str:
    """Lines that a user reads."""
    half = Z95 * result.deviations
    degrees = np.degrees(log_rotation(result.pose.R))
    lines = [f"{'object in base W':34}{'value':>12}{'95 % interval':>18}"]
    for i, axis in enumerate("xyz"):
        lines.append(f"{f'centre {axis}, mm':34}{1e3 * result.center[i]:12.2f}{f'+- {1e3 * half[i]:.2f}':>18}")
    for i, axis in enumerate("xyz"):
        lines.append(f"{f'rotation vector {axis}, degrees':34}{degrees[i]:12.3f}{f'+- {np.degrees(half[3 + i]):.3f}':>18}")
    lines.append(f"{'origin of the mesh, mm':34}" + " ".join(f"{1e3 * value:.2f}" for value in result.pose.p))
    if observed.cloud is not None:
        shift, turn = result.refined.state.shift, np.degrees(log_rotation(result.refined.state.turn))
        lines.append(f"{'the camera moves the cloud by, mm':34}" + " ".join(f"{-1e3 * value + 0:.2f}" for value in shift))
        lines.append(f"{'and turns it by, degrees':34}" + " ".join(f"{-value + 0:.3f}" for value in turn))
    lines += ["", f"fit: {result.verdict.text}", f"symmetry: {result.symmetries.text}"]
    if len(result.symmetries.rotations) > 1:
        lines.append(f"  {len(result.symmetries.rotations)} poses are alike; given is the one nearest to "
                     f"{'the guess' if observed.guess else 'the axes of W'}; --json lists all")  # fmt: skip
    if result.undetermined:
        lines.append(f"not determined by these points: {', '.join(result.undetermined)}")
    if result.others:
        lines.append(f"{len(result.others)} other poses explain the points nearly as well; more touches decide:")
        for pose in result.others[:5]:
            center = pose.p + pose.R @ (result.pose.R.T @ (result.center - result.pose.p))
            lines.append(f"  centre {_mm(center)} mm, quaternion {_list(to_wxyz(pose.R), 4)}")
    for i, touch in enumerate(proposals):
        lines.append(f"{'next touch' if i == 0 else 'or':>10}: move along {_list(touch.approach, 3)} onto {_mm(touch.point)} mm; "
                     f"expected gain {touch.gain:.2f} nats, chance of a hit {100 * touch.chance:.0f} %")  # fmt: skip
    return "\n".join(lines)


def as_json(result: Registration, observed: Observations, proposals: list[Touch]) -> dict[str, Any]:
    """Everything, m and rad, in W."""
    verdict = result.verdict
    n = len(observed.touches)
    state = result.refined.state
    document: dict[str, Any] = {
        "object_in_base": {"position": result.pose.p.tolist(), "quaternion": to_wxyz(result.pose.R).tolist()},
        "covariance_of_origin": result.covariance_of_origin().tolist(),
        "center": result.center.tolist(),
        "covariance_of_center": result.covariance.tolist(),
        "order": ["x", "y", "z", "rotation x", "rotation y", "rotation z"],
        "undetermined": result.undetermined,
        "touch_distances": (result.refined.at.r[:n] * observed.touches.deviation).tolist(),
        "fit": {"fits": verdict.fits, "chi_square": verdict.chi_square, "freedom": verdict.freedom,
                "p": None if np.isnan(verdict.p) else verdict.p, "gross_touches": [i + 1 for i in verdict.gross],
                "scale": verdict.scale, "scale_deviation": None if np.isnan(verdict.scale_deviation) else verdict.scale_deviation,
                "fits_scaled": verdict.fits_scaled, "text": verdict.text},
        "symmetry": {"text": result.symmetries.text,
                     "poses": [{"position": pose.p.tolist(), "quaternion": to_wxyz(pose.R).tolist()}
                               for pose in result.symmetries.equivalents(result.pose)]},
        "other_poses": [{"position": pose.p.tolist(), "quaternion": to_wxyz(pose.R).tolist()} for pose in result.others],
        "next_touches": [{"point": touch.point.tolist(), "approach": touch.approach.tolist(), "gain": touch.gain,
                          "chance": touch.chance} for touch in proposals],
    }  # fmt: skip
    if observed.cloud is not None:
        document["camera_error"] = {"shift": (-state.shift).tolist(), "rotation": (-log_rotation(state.turn)).tolist()}
    return document


def _mm(point: Any) -> str:
    return "(" + ", ".join(f"{1e3 * value:.1f}" for value in point) + ")"


def _list(values: Any, digits: int) -> str:
    return "(" + ", ".join(f"{value + 0.0:.{digits}f}" for value in values) + ")"
