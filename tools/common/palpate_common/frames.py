"""Poses in a configuration of palpated."""

from __future__ import annotations

import numpy as np

from palpate_common.rotations import Array, from_rpy, from_wxyz
from palpate_common.section import Section


def rotation_and_position(pose: Section) -> tuple[Array, Array]:
    """Of a section with `position`, m, and `rpy_deg` or `quaternion`, w first; what is absent is zero. Raises InputError."""
    position = np.array(pose.numbers("position", 3, -100, 100, [0, 0, 0]))
    if not pose.has("quaternion"):
        return from_rpy(np.radians(pose.numbers("rpy_deg", 3, -360, 360, [0, 0, 0]))), position
    if pose.has("rpy_deg"):
        pose.fail("quaternion", "is given in addition to rpy_deg; allowed: one of them")
    quaternion = np.array(pose.numbers("quaternion", 4, -1.001, 1.001))
    if abs(np.linalg.norm(quaternion) - 1) > 1e-3:
        pose.fail("quaternion", f"{quaternion.tolist()}; allowed: length 1, w first")
    return from_wxyz(quaternion), position
