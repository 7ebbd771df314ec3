"""The section of palpated's configuration that states the pose and its uncertainty."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Optional

import numpy as np

from palpate_common.pose import covariance_at
from palpate_common.rotations import to_wxyz
from palpate_register.configuration import FILTER, Configuration
from palpate_register.register import Registration

# Ranges of the keys.
POSITION = (1e-6, 0.1)  # m
ROTATION = (1e-6, 1.0)  # rad
CLAMP = (0.0, 0.1)  # m


def prior_of(result: Registration, configuration: Optional[Configuration]) -> dict[str, float]:
    """Keys of `estimation` of pose_wrench_filter, m and rad, standard deviation of each axis.

    palpated has no covariance of `frames.object_in_base`. Its filter knows the offset of the grasp
    from its kinematic pose: an error of the object's pose moves the material that the hand holds by
    the covariance at the grasp. `clamp_deviation`: root mean square over the axes, at the object's
    centre. `pose_*_deviation`: the same at the grasp, added in squares to the configured value,
    which stands for the arm and the grasp itself.
    """
    at_grasp, own = result.covariance, (0.001, 0.009)
    if configuration is not None:
        own = (configuration.pose_position_deviation, configuration.pose_rotation_deviation)
        if configuration.grasp is not None:
            offset = result.pose.R @ (configuration.grasp - configuration.surface.center)
            at_grasp = covariance_at(result.covariance, offset)
    position = np.sqrt(np.trace(at_grasp[:3, :3]) / 3)
    rotation = np.sqrt(np.trace(at_grasp[3:, 3:]) / 3)
    clamp = np.sqrt(np.trace(result.covariance[:3, :3]) / 3)
    return {
        "pose_position_deviation": float(np.clip(np.hypot(own[0], position), *POSITION)),
        "pose_rotation_deviation": float(np.clip(np.hypot(own[1], rotation), *ROTATION)),
        "clamp_deviation": float(np.clip(clamp, *CLAMP)),
    }


def yaml_text(result: Registration, configuration: Optional[Configuration], output: Path) -> str:
    """Content of the file: with `base`, if there is a configuration to change."""
    p, q = result.pose.p, to_wxyz(result.pose.R)
    lines = ["# Pose of the object by palpate-register: X_WO, its mesh's frame O in the robot's base W."]
    if configuration is not None:
        base = os.path.relpath(configuration.path.resolve(), output.resolve().parent)
        lines += [f"base: {base}"]
    # The base's own notation of the rotation would contradict the quaternion.
    removed = ", rpy_deg: ~" if configuration is not None else ""
    lines += [
        "frames:",
        f"  object_in_base: {{position: {_numbers(p, '.6f')}, quaternion: {_numbers(q, '.8f')}{removed}}}",
        "  # Its covariance, of (position of O, m; rotation, rad) along the axes of W:",
    ]
    lines += [f"  #   {_numbers(row, ' .3e')}" for row in result.covariance_of_origin()]
    comment = ""
    if configuration is None or configuration.component != FILTER:
        comment = "# "
        lines += [f"# With `estimation.component: {FILTER}`, its prior:"]
    lines += [f"{comment}estimation:"]
    lines += [f"{comment}  {key}: {value:.3g}" for key, value in prior_of(result, configuration).items()]
    return "\n".join(lines) + "\n"


def _numbers(values: Any, form: str) -> str:
    return "[" + ", ".join(format(value + 0.0, form) for value in values) + "]"
