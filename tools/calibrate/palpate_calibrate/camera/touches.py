"""Points that the robot touched and that were picked in the camera's frame: rigid fit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate_calibrate.camera.camera_fit import CameraFit
from palpate_calibrate.camera.depth_error import DepthError
from palpate_calibrate.camera.least_squares import Group, estimate
from palpate_common import robust
from palpate_common.input_error import InputError
from palpate_common.pose import Pose, moved
from palpate_common.rotations import fit_rotation, perpendiculars

Floats = NDArray[np.float64]
FEWEST = 4
TRIPLES = 300  # that are tried as start
SPREAD = 1e-3  # m: least second extent of the points, without which a rotation about their line is free


@dataclass(frozen=True, eq=False)
class PickedTouches:
    """Pairs of points. Raises InputError for fewer than FEWEST or points on one line."""

    source: str  # file, for messages
    points_W: Floats  # (n, 3), m, touched, in W
    points_C: Floats  # (n, 3), m, picked, in C
    touch_deviation: float  # m, of each axis of a touched point
    error: DepthError  # of a picked point

    def __post_init__(self) -> None:
        n = len(self.points_W)
        if n < FEWEST:
            raise InputError(f"{self.source}: {n} points; allowed: {FEWEST} or more")
        extent = np.linalg.svd(self.points_W - self.points_W.mean(axis=0))[1] / np.sqrt(n)
        if extent[1] < SPREAD:
            raise InputError(f"{self.source}: the points lie on a line, within {1e3 * extent[1]:.2g} mm; allowed: "
                             f"{1e3 * SPREAD:g} mm or more across it")  # fmt: skip


def rigid_fit(points_W: Floats, points_C: Floats) -> Pose:
    """X_WC that minimises the squared distances of pairs, (n, 3) each, m (Kabsch 1976)."""
    middle_W, middle_C = points_W.mean(axis=0), points_C.mean(axis=0)
    R = fit_rotation(points_C - middle_C, points_W - middle_W)
    return Pose(R, middle_W - R @ middle_C)


def start_pose(picked: PickedTouches) -> Pose:
    """The rigid fit of three pairs, among many, that most of the others agree with."""
    random = np.random.default_rng(0)
    n = len(picked.points_W)
    size = np.hypot(picked.touch_deviation, picked.error.along(picked.points_C))
    best, least = rigid_fit(picked.points_W, picked.points_C), np.inf
    for trial in range(TRIPLES + 1):
        chosen = random.choice(n, 3, replace=False) if trial else np.arange(n)
        pose = rigid_fit(picked.points_W[chosen], picked.points_C[chosen])
        distance = np.linalg.norm(pose.of(picked.points_C) - picked.points_W, axis=1)
        cost = float(robust.loss(distance / (3 * size)).sum())
        if cost < least:
            best, least = pose, cost
    return best


class TouchProblem:
    """Residuals of pairs, in C along and across the viewing rays, since a camera's errors differ along and across."""

    count = leading = 6

    def __init__(self, picked: PickedTouches) -> None:
        self._picked = picked
        rays = picked.points_C / np.linalg.norm(picked.points_C, axis=1, keepdims=True)
        self._directions = {"depth of picks": rays[:, None], "picks across the ray": perpendiculars(rays)}
        touch = picked.touch_deviation
        self._deviations = {"depth of picks": np.hypot(picked.error.along(picked.points_C), touch),
                            "picks across the ray": np.hypot(picked.error.across(picked.points_C), touch)}  # fmt: skip

    def groups(self, state: Pose) -> list[Group]:
        """Derivatives by the step of `moved`, about C's origin."""
        arm = self._picked.points_W - state.p
        error = self._picked.points_C - arm @ state.R
        found = []
        for name, directions in self._directions.items():
            deviation = np.repeat(self._deviations[name], directions.shape[1])
            a = (directions @ state.R.T).reshape(-1, 3)
            turns = np.cross(np.repeat(arm, directions.shape[1], axis=0), a)
            r = np.einsum("nki,ni->nk", directions, error).ravel()
            J = np.hstack([a, turns]) / deviation[:, None]
            found.append(Group(name, r / deviation, J, 1e3 * deviation, "mm", True, True, directions.shape[1]))
        return found

    def stepped(self, state: Pose, step: Floats) -> Pose:
        return moved(state, step, np.zeros(3))


def fit_touches(picked: PickedTouches) -> CameraFit:
    """X_WC by all pairs; gross errors have no weight."""
    found = estimate(TouchProblem(picked), start_pose(picked))
    assert isinstance(found.state, Pose)
    return CameraFit("touches", picked.source, found.state, found)
