"""Signed distances of points from the shapes of robots and obstacles, each in its own frame."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, Sequence

import numpy as np

from palpate_common.pose import Pose
from palpate_common.surface import Surface
from palpate_see.cloud import Floats, Mask


class Shape(Protocol):
    """reach: radius, m, of a sphere about the origin that contains the shape; infinite for one without bounds."""

    @property
    def reach(self) -> float: ...

    def distance(self, points: Floats) -> Floats:
        """(n,), m, negative inside, of points, (n, 3), m, in the shape's frame."""
        ...


@dataclass(frozen=True)
class HalfSpace:
    """Below z = 0."""

    reach: float = np.inf

    def distance(self, points: Floats) -> Floats:
        return points[:, 2]


@dataclass(frozen=True)
class Sphere:
    """About the origin. radius: m."""

    radius: float

    @property
    def reach(self) -> float:
        return self.radius

    def distance(self, points: Floats) -> Floats:
        result: Floats = np.linalg.norm(points, axis=1) - self.radius
        return result


@dataclass(frozen=True)
class Box:
    """About the origin. size: edges, m."""

    size: tuple[float, float, float]

    @property
    def reach(self) -> float:
        return 0.5 * float(np.linalg.norm(self.size))

    def distance(self, points: Floats) -> Floats:
        return _outside(np.abs(points) - 0.5 * np.array(self.size))


@dataclass(frozen=True)
class Cylinder:
    """About the axis z, with the origin in the middle. radius, length: m; the length may be infinite."""

    radius: float
    length: float

    @property
    def reach(self) -> float:
        return float(np.hypot(self.radius, 0.5 * self.length))

    def distance(self, points: Floats) -> Floats:
        around = np.hypot(points[:, 0], points[:, 1]) - self.radius
        return _outside(np.stack([around, np.abs(points[:, 2]) - 0.5 * self.length], axis=1))


@dataclass(frozen=True)
class Capsule:
    """About a segment of the axis z, with the origin in the middle. radius, length of the segment: m."""

    radius: float
    length: float

    @property
    def reach(self) -> float:
        return self.radius + 0.5 * self.length

    def distance(self, points: Floats) -> Floats:
        beyond = np.maximum(np.abs(points[:, 2]) - 0.5 * self.length, 0)
        result: Floats = np.sqrt(points[:, 0] ** 2 + points[:, 1] ** 2 + beyond**2) - self.radius
        return result


class Mesh:
    """A closed surface."""

    def __init__(self, surface: Surface) -> None:
        self._surface = surface
        self.reach = float(np.linalg.norm(surface.nodes, axis=1).max())

    def distance(self, points: Floats) -> Floats:
        closest, triangles = self._surface.closest(points)
        away = points - closest
        # Of the triangles at one edge the one that faces the point most is returned, which decides the side.
        inside = np.einsum("ij,ij->i", away, self._surface.normals[triangles]) < 0
        distance = np.linalg.norm(away, axis=1)
        return np.asarray(np.where(inside, -distance, distance))


def _outside(beyond: Floats) -> Floats:
    """(n,): distance from what is bounded in each of k directions, of distances beyond the bounds, (n, k)."""
    result: Floats = np.linalg.norm(np.maximum(beyond, 0), axis=1) + np.minimum(beyond.max(axis=1), 0)
    return result


@dataclass(frozen=True, eq=False)
class PlacedShape:
    """X_WS: pose of the shape's frame in W."""

    shape: Shape
    X_WS: Pose


def within(points: Floats, placed: Sequence[PlacedShape], margins: Floats) -> Mask:
    """(n,) of points in W, (n, 3), m: whether they are inside a shape or at most as far away as their margin, (n,), m."""
    result: Mask = np.zeros(len(points), bool)
    for item in placed:
        local = points - item.X_WS.p
        reach = item.shape.reach + margins
        near = np.flatnonzero(~result & ((local**2).sum(axis=1) <= reach**2))
        if len(near):
            result[near] = item.shape.distance(local[near] @ item.X_WS.R) <= margins[near]
    return result
