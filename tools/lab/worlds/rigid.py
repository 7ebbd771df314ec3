"""Rigid poses, and the transport of wrenches and twists, by the conventions of core/math/rigid.hpp:
linear part or force first; X_AB is the pose of B in A."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Pose:
    """R_AB and p_A_B, m."""

    rotation: Floats = field(default_factory=lambda: np.eye(3))
    position: Floats = field(default_factory=lambda: np.zeros(3))

    def __matmul__(self, other: "Pose") -> "Pose":
        return Pose(self.rotation @ other.rotation, self.rotation @ other.position + self.position)

    def inverse(self) -> "Pose":
        return Pose(self.rotation.T, -self.rotation.T @ self.position)

    def of(self, points: Floats) -> Floats:
        """Points (..., 3) of B in A."""
        return points @ self.rotation.T + self.position

    def quaternion(self) -> list[float]:
        """w, x, y, z with w >= 0."""
        x, y, z, w = Rotation.from_matrix(self.rotation).as_quat()
        sign = -1.0 if w < 0 else 1.0
        return [sign * w, sign * x, sign * y, sign * z]


def cross(a: Floats, b: Floats) -> Floats:
    """a x b of two vectors; much faster than numpy's for single ones."""
    return np.array(
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    )


def log_rotation(rotation: Floats) -> Floats:
    """Rotation vector, rad."""
    return Rotation.from_matrix(rotation).as_rotvec()


def exp_rotation(vector: Floats) -> Floats:
    return Rotation.from_rotvec(vector).as_matrix()


def twist_at(twist: Floats, offset: Floats) -> Floats:
    """The twist of the same body at a point that lies `offset` further."""
    return np.concatenate([twist[:3] + cross(twist[3:], offset), twist[3:]])
