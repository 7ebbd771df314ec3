"""Rigid obstacles at rest, and the signed distance of points from them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Optional, Sequence, Union

import numpy as np
from rigid import Floats, Pose


@dataclass(frozen=True)
class HalfSpace:
    """Below z = 0 of its frame."""

    def distance(self, points: Floats) -> Floats:
        return np.asarray(points[:, 2])


@dataclass(frozen=True)
class Cuboid:
    """About the origin."""

    size: Floats  # m, edge lengths

    def distance(self, points: Floats) -> Floats:
        beyond = np.abs(points) - self.size / 2
        return _combined(beyond)


@dataclass(frozen=True)
class Sphere:
    """About the origin."""

    radius: float  # m

    def distance(self, points: Floats) -> Floats:
        return np.asarray(np.linalg.norm(points, axis=1) - self.radius)


@dataclass(frozen=True)
class Cylinder:
    """About the axis z, with the origin in the middle."""

    radius: float  # m
    length: Optional[float]  # m; None: infinite

    def distance(self, points: Floats) -> Floats:
        radial = np.hypot(points[:, 0], points[:, 1]) - self.radius
        if self.length is None:
            return np.asarray(radial)
        axial = np.abs(points[:, 2]) - self.length / 2
        return _combined(np.column_stack([radial, axial]))


@dataclass(frozen=True)
class Capsule:
    """A cylinder with a half sphere at each end."""

    radius: float  # m
    length: float  # m, of the cylinder

    def distance(self, points: Floats) -> Floats:
        nearest = np.zeros_like(points)
        nearest[:, 2] = np.clip(points[:, 2], -self.length / 2, self.length / 2)
        return np.asarray(np.linalg.norm(points - nearest, axis=1) - self.radius)


Shape = Union[HalfSpace, Cuboid, Sphere, Cylinder, Capsule]


@dataclass(frozen=True)
class Obstacle:
    """A shape in O, and Coulomb's coefficient of friction between it and the object."""

    name: str
    shape: Shape
    pose: Pose  # X_OS, of the shape's frame
    friction: float

    def distance(self, points: Floats) -> Floats:
        """Of points (n, 3) in O, m, negative inside."""
        return self.shape.distance(self.pose.inverse().of(points))


def penetrations(obstacles: Sequence[Obstacle], points: Floats) -> Floats:
    """Largest depth of any of the points (n, 3), m in O, in each obstacle: m; 0 without contact."""
    return np.array([max(0.0, -float(each.distance(points).min())) for each in obstacles])


def _combined(beyond: Floats) -> Floats:
    """Distance from the intersection of slabs at right angles, from the distances (n, slabs)
    beyond each."""
    outside = np.linalg.norm(np.maximum(beyond, 0), axis=1)
    return np.asarray(outside + np.minimum(beyond.max(axis=1), 0))
