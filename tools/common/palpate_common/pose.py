"""Rigid motions. Pose X_AB: rotation `R`, (3, 3), and position `p`, (3,), m, of frame B in A."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate_common.rotations import cross_matrix, exp_rotation, from_wxyz, log_rotation

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Pose:
    """X_AB: maps a point of B, (n, 3), m, to A by `of`, back by `inverse_of`."""

    R: Floats
    p: Floats

    def of(self, points: Any) -> Floats:
        """(n, 3) in B to (n, 3) in A, m."""
        result: Floats = np.asarray(points, float) @ self.R.T + self.p
        return result

    def inverse_of(self, points: Any) -> Floats:
        """(n, 3) in A to (n, 3) in B, m."""
        result: Floats = (np.asarray(points, float) - self.p) @ self.R
        return result

    def times(self, other: "Pose") -> "Pose":
        """X_AC of X_AB and X_BC."""
        return Pose(self.R @ other.R, self.R @ other.p + self.p)

    def inverse(self) -> "Pose":
        """X_BA."""
        return Pose(self.R.T, -self.R.T @ self.p)


def angle_of(R: Floats) -> float:
    """Angle of a rotation, rad, 0 to pi."""
    sine = 0.5 * np.linalg.norm([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    return float(np.arctan2(sine, 0.5 * (np.trace(R) - 1)))


def moved(pose: Pose, step: Floats, about: Floats) -> Pose:
    """Pose after a small motion in A: `step` is (translation, m, of the point that is `about`, (3,)
    in B; rotation vector, rad, in A)."""
    center = pose.R @ about + pose.p + step[:3]
    R = exp_rotation(step[3:]) @ pose.R
    return Pose(R, center - R @ about)


def difference(of: Pose, reference: Pose, about: Floats) -> Floats:
    """(6,): the step by which `moved` takes the reference to the other pose."""
    at = (of.R @ about + of.p) - (reference.R @ about + reference.p)
    return np.concatenate([at, log_rotation(of.R @ reference.R.T)])


def covariance_at(covariance: Floats, offset: Floats) -> Floats:
    """(6, 6) of (position, rotation) of another point of the body, `offset`, (3,), m, away in A."""
    J = np.eye(6)
    J[:3, 3:] = -cross_matrix(offset)
    result: Floats = J @ covariance @ J.T
    return result


def random_rotations(random: np.random.Generator, count: int) -> Floats:
    """(count, 3, 3), uniform over SO(3)."""
    q = random.normal(size=(count, 4))
    return from_wxyz(q)
