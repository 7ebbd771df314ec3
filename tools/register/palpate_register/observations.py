"""What was measured: touched points, a cloud, and what was known of the pose before."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Optional

import numpy as np
from numpy.typing import NDArray

from palpate_common.pose import Pose
from palpate_common.rotations import perpendiculars

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Touches:
    """Points of the object's surface that a probe touched, in W."""

    points: Floats  # (n, 3), m, centres of the probe's tip
    normals: Floats  # (n, 3), outward normals of the object as measured; rows of zeros: none
    deviation: Floats  # (n,), m, standard deviation of each axis of a point, independent
    normal_deviation: float = np.radians(10)  # rad, of each of the two angles of a normal
    radius: float = 0.0  # m, of the probe's tip
    common_deviation: float = 0.0  # m, of each axis of a shift that all touches have in common

    def __len__(self) -> int:
        return len(self.points)

    @cached_property
    def has_normal(self) -> NDArray[np.bool_]:
        """(n,)."""
        result: NDArray[np.bool_] = np.linalg.norm(self.normals, axis=1) > 0.5
        return result

    @cached_property
    def across(self) -> Floats:
        """(k, 2, 3): two unit directions across each measured normal."""
        return perpendiculars(self.normals[self.has_normal])

    def only(self, chosen: NDArray[np.bool_]) -> "Touches":
        """Those that a mask, (n,), selects."""
        return Touches(self.points[chosen], self.normals[chosen], self.deviation[chosen],
                       self.normal_deviation, self.radius, self.common_deviation)  # fmt: skip


def no_touches() -> Touches:
    """Of a registration by a cloud alone."""
    return Touches(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0))


@dataclass(frozen=True, eq=False)
class Cloud:
    """Points of the visible part of the surface by a camera whose pose is known roughly, in W.

    The camera's error is a rigid motion: a shift, and a rotation about the middle of the cloud.
    """

    points: Floats  # (n, 3), m
    deviation: float = 1e-3  # m, of a point along the surface's normal
    independent: int = 100  # points count as at most that many: neighbours err alike
    shift_deviation: float = 0.02  # m, of each axis of the shift
    rotation_deviation: float = np.radians(2)  # rad, of each axis of the rotation

    @cached_property
    def middle(self) -> Floats:
        """(3,), m: point about which the camera's error rotates."""
        result: Floats = self.points.mean(axis=0)
        return result

    @property
    def point_deviation(self) -> float:
        """m, deviation of a point that gives all of them the weight of the independent ones."""
        return self.deviation * np.sqrt(max(1.0, len(self.points) / self.independent))

    def thinned(self, most: int) -> "Cloud":
        """At most `most` points, spread evenly over the file's order, of the same weight."""
        if len(self.points) <= most:
            return self
        chosen = np.linspace(0, len(self.points) - 1, most).round().astype(int)
        return Cloud(self.points[chosen], self.deviation, min(self.independent, most),
                     self.shift_deviation, self.rotation_deviation)  # fmt: skip


@dataclass(frozen=True, eq=False)
class Guess:
    """X_WO before any observation; the object's centre and rotation are off by at most the range."""

    pose: Pose
    position_range: float = 0.05  # m, each axis
    angle_range: float = np.radians(20)  # rad

    @property
    def deviation(self) -> Floats:
        """(6,), m and rad, of a uniform distribution over the range, position first."""
        return np.array([self.position_range] * 3 + [self.angle_range] * 3) / np.sqrt(3)


@dataclass(frozen=True, eq=False)
class Observations:
    """All that a registration uses."""

    touches: Touches = field(default_factory=no_touches)
    cloud: Optional[Cloud] = None
    guess: Optional[Guess] = None

    @property
    def points(self) -> Floats:
        """(n, 3), W, m: touches, then the cloud."""
        parts = [self.touches.points] + ([] if self.cloud is None else [self.cloud.points])
        return np.concatenate(parts)
