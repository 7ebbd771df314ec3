"""Poses of the flange at which clouds or images were taken, and the arm's errors there."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from palpate_calibrate.camera.least_squares import Group
from palpate_common.column_file import Layout, read_columns
from palpate_common.input_error import InputError
from palpate_common.pose import Pose, moved
from palpate_common.rotations import from_wxyz

Floats = NDArray[np.float64]
POSITION, QUATERNION = ("x", "y", "z"), ("qw", "qx", "qy", "qz")
LARGEST = 100.0  # m
LAYOUT = Layout(("file", *POSITION, *QUATERNION), (),
                {**dict.fromkeys(POSITION, (-LARGEST, LARGEST)), **dict.fromkeys(QUATERNION, (-1.001, 1.001))})  # fmt: skip
IMAGES_ONLY = Layout(("file",), (POSITION + QUATERNION,), LAYOUT.ranges)  # of a marker that the arm does not carry


@dataclass(frozen=True)
class ArmError:
    """Standard deviations of each axis of a pose of the flange, independent between poses; m and rad."""

    position: float
    rotation: float


@dataclass(frozen=True)
class View:
    """One line of the file."""

    path: Path  # of the cloud or image
    flange: Pose  # X_WE


def read_views(path: Path, has_poses: bool = True) -> list[View]:
    """Of a CSV file with columns file (relative to it), x, y, z, m, qw, qx, qy, qz: X_WE. Raises InputError.

    has_poses: whether the poses are required; without them they are the identity.
    """
    table = read_columns(path, LAYOUT if has_poses else IMAGES_ONLY)
    files = table.texts["file"]
    if not files:
        raise InputError(f"{path}: no lines below the columns' names; allowed: one or more")
    if not has_poses:
        return [View(path.parent / name, Pose(np.eye(3), np.zeros(3))) for name in files]
    positions, quaternions = table.numbers(*POSITION), table.numbers(*QUATERNION)
    views = []
    for i, name in enumerate(files):
        length = np.linalg.norm(quaternions[i])
        if abs(length - 1) > 1e-3:
            table.fail(i, f"qw,qx,qy,qz: length {length:.4f}; allowed: 1")
        views.append(View(path.parent / name, Pose(from_wxyz(quaternions[i]), positions[i])))
    return views


def moved_flanges(flanges: list[Pose], errors: Floats) -> list[Pose]:
    """Where the flange was, of poses as reported and the arm's errors, (n, 6): (position, m; rotation, rad), axes of W."""
    return [moved(flange, error, np.zeros(3)) for flange, error in zip(flanges, errors)]


def error_groups(errors: Floats, arm: ArmError, first: int, count: int) -> list[Group]:
    """The arm's errors, (n, 6), as measurements of zero; they are the parameters from `first` on of `count`."""
    n = len(errors)
    found = []
    for name, part, deviation, factor, unit in (
        ("arm's position", slice(0, 3), arm.position, 1e3, "mm"),
        ("arm's rotation", slice(3, 6), arm.rotation, np.degrees(1), "degree"),
    ):
        J = np.zeros((n, 3, count))
        for k in range(n):
            columns = first + 6 * k + np.arange(6)[part]
            J[k, np.arange(3), columns] = 1 / deviation
        r = errors[:, part].ravel() / deviation
        found.append(Group(name, r, J.reshape(-1, count), np.full(3 * n, factor * deviation), unit, False, True))
    return found
