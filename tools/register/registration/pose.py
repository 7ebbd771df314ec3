"""Rigid motions. Pose X_AB: rotation `R`, (3, 3), and position `p`, (3,), m, of frame B in A."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

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


def cross_matrix(v: Any) -> Floats:
    """[v]x, (3, 3): [v]x w = v x w."""
    x, y, z = np.asarray(v, float)
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def rotation(vector: Any) -> Floats:
    """exp([v]x), (3, 3), of a rotation vector, rad (Rodrigues' formula)."""
    vector = np.asarray(vector, float)
    angle = float(np.linalg.norm(vector))
    K = cross_matrix(vector)
    if angle < 1e-9:
        return np.eye(3) + K
    result: Floats = np.eye(3) + np.sin(angle) / angle * K + (1 - np.cos(angle)) / angle**2 * K @ K
    return result


def angle_of(R: Floats) -> float:
    """Angle of a rotation, rad, 0 to pi."""
    sine = 0.5 * np.linalg.norm([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    return float(np.arctan2(sine, 0.5 * (np.trace(R) - 1)))


def vector_of(R: Floats) -> Floats:
    """Rotation vector, (3,), rad, of a rotation."""
    w, x, y, z = quaternion(R)
    sine = np.linalg.norm([x, y, z])
    angle = 2 * np.arctan2(sine, w)
    return np.array([x, y, z]) * (2.0 if sine < 1e-9 else angle / sine)


def quaternion(R: Floats) -> Floats:
    """(w, x, y, z) with w >= 0 of a rotation (Bar-Itzhack 2000: the largest eigenvector)."""
    d = np.diag(R)
    K = np.empty((4, 4))
    K[0, 0] = d.sum()
    K[0, 1:] = K[1:, 0] = [R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]
    K[1:, 1:] = R + R.T - d.sum() * np.eye(3)
    q: Floats = np.linalg.eigh(K)[1][:, -1]
    return q if q[0] >= 0 else -q


def from_quaternion(q: Any) -> Floats:
    """Rotations, (..., 3, 3), of unit quaternions, (..., 4), w first."""
    w, x, y, z = np.moveaxis(np.asarray(q, float), -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), [0, 1], [-2, -1])


def from_roll_pitch_yaw(degrees: Any) -> Floats:
    """Rz(yaw) Ry(pitch) Rx(roll), as `rpy_deg` of a configuration."""
    r, p, y = np.radians(degrees)
    return rotation([0, 0, y]) @ rotation([0, p, 0]) @ rotation([r, 0, 0])


def moved(pose: Pose, step: Floats, about: Floats) -> Pose:
    """Pose after a small motion in A: `step` is (translation, m, of the point that is `about`, (3,)
    in B; rotation vector, rad, in A)."""
    center = pose.R @ about + pose.p + step[:3]
    R = rotation(step[3:]) @ pose.R
    return Pose(R, center - R @ about)


def difference(of: Pose, reference: Pose, about: Floats) -> Floats:
    """(6,): the step by which `moved` takes the reference to the other pose."""
    at = (of.R @ about + of.p) - (reference.R @ about + reference.p)
    return np.concatenate([at, vector_of(of.R @ reference.R.T)])


def covariance_at(covariance: Floats, offset: Floats) -> Floats:
    """(6, 6) of (position, rotation) of another point of the body, `offset`, (3,), m, away in A."""
    J = np.eye(6)
    J[:3, 3:] = -cross_matrix(offset)
    result: Floats = J @ covariance @ J.T
    return result


def random_rotations(random: np.random.Generator, count: int) -> Floats:
    """(count, 3, 3), uniform over SO(3)."""
    q = random.normal(size=(count, 4))
    return from_quaternion(q / np.linalg.norm(q, axis=1, keepdims=True))
