"""The pose as YAML."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Optional

import numpy as np
import yaml

from palpate_calibrate.camera.camera_fit import CameraFit
from palpate_common.pose import Pose
from palpate_common.rotations import to_wxyz
from palpate_common.section import read_configuration_section


def pose_section(pose: Pose) -> dict[str, list[float]]:
    """`position`, m, and `quaternion`, w first."""
    return {"position": [round(float(v), 6) + 0.0 for v in pose.p],
            "quaternion": [round(float(v), 8) + 0.0 for v in to_wxyz(pose.R)]}  # fmt: skip


def check_scene(scene: Path) -> None:
    """Raises InputError if the file is no scene with a camera. palpate-sim validates the rest of it."""
    read_configuration_section(scene).section("camera")


def _replaced(scene: Path) -> list[str]:
    """Keys of the scene that a pose excludes; an empty entry removes them."""
    camera = read_configuration_section(scene).section("camera")
    return [key for key in ("eye", "target") if camera.has(key)]


def yaml_text(fit: CameraFit, scene: Optional[Path], output: Path) -> str:
    """`camera_in_base`, or with a scene the whole of it, by `base`, with this camera. The covariance is a comment."""
    half = [" ".join(f"{v:.2g}" for v in part) for part in (1e3 * fit.half_widths[:3], np.degrees(fit.half_widths[3:]))]
    lines = [f"# Written by palpate-calibrate camera from {fit.source}, by {fit.way}",
             "# Pose of the camera in the robot's base: z forwards, x right, y down; m, quaternion w first.",
             f"# 95 % intervals about the base's axes: position +- {half[0]} mm, rotation +- {half[1]} degree",
             "# Covariance of (position, m; rotation, rad), axes of the base, row by row:"]  # fmt: skip
    lines += ["#   " + " ".join(f"{v:.4e}" for v in row) for row in fit.covariance]
    lines += [f"# {name}: {pose_section(pose)}" for name, pose in fit.others.items()]
    document: dict[str, Any] = {"camera_in_base": pose_section(fit.pose)}
    if scene is not None:
        document = {"base": os.path.relpath(scene.resolve(), output.resolve().parent),
                    "camera": {**dict.fromkeys(_replaced(scene)), "pose": pose_section(fit.pose)}}  # fmt: skip
    return "\n".join(lines) + "\n" + yaml.safe_dump(document, sort_keys=False, default_flow_style=None, width=120)
