"""Ray casting of boxes, spheres, cylinders and a half-space in numpy, independent of tools/see."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Optional

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
NOWHERE = np.inf


@dataclass(frozen=True, eq=False)
class Body:
    """kind: box (size: edges), sphere (size: radius), cylinder (size: radius, length) or half_space (below z = 0). R, p:
    pose in W, m. label: what it belongs to."""

    kind: str
    size: tuple[float, ...]
    R: Floats
    p: Floats
    label: int

    @property
    def reach(self) -> float:
        """m, radius of a sphere about the origin that contains it."""
        if self.kind == "half_space":
            return NOWHERE
        if self.kind == "cylinder":
            return float(np.hypot(self.size[0], self.size[1] / 2))
        return self.size[0] if self.kind == "sphere" else float(np.linalg.norm(self.size)) / 2


@dataclass(frozen=True, eq=False)
class Hits:
    """Of n rays: distance along each, m, infinite without a hit; label of the body, -1 without; normal there, (n, 3)."""

    distance: Floats
    label: NDArray[np.int64]
    normal: Floats


def cast(origin: Floats, ways: Floats, bodies: list[Body]) -> Hits:
    """The first body that each ray from `origin`, (3,), along unit vectors, (n, 3), meets."""
    hits = Hits(np.full(len(ways), NOWHERE), np.full(len(ways), -1), np.zeros((len(ways), 3)))
    for body in bodies:
        to = body.p - origin
        chosen = np.arange(len(ways))
        if np.isfinite(body.reach):
            along = ways @ to
            chosen = np.flatnonzero((along > -body.reach) & (to @ to - along**2 <= body.reach**2))
        if len(chosen) == 0:
            continue
        start, local = (origin - body.p) @ body.R, ways[chosen] @ body.R
        found = _MEET[body.kind](start, local, body.size)
        nearer = found < hits.distance[chosen]
        rows = chosen[nearer]
        hits.distance[rows] = found[nearer]
        hits.label[rows] = body.label
        places = start + found[nearer, None] * local[nearer]
        hits.normal[rows] = _normals(body, places) @ body.R.T
    return hits


def _first(entry: Floats, exit_: Floats) -> Floats:
    """Where rays that are inside from `entry` to `exit_` begin to be, if that lies ahead."""
    return np.where((entry <= exit_) & (entry > 1e-9), entry, NOWHERE)


def _slabs(start: Floats, ways: Floats, half: Floats) -> tuple[Floats, Floats]:
    with np.errstate(divide="ignore", invalid="ignore"):
        a, b = (-half - start) / ways, (half - start) / ways
    return np.fmin(a, b).max(axis=1), np.fmax(a, b).min(axis=1)


def _box(start: Floats, ways: Floats, size: tuple[float, ...]) -> Floats:
    return _first(*_slabs(start, ways, np.array(size) / 2))


def _roots(a: Floats, b: Floats, c: float) -> tuple[Floats, Floats]:
    """Of a t^2 + 2 b t + c; an empty interval without roots."""
    inside = b * b - a * c
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(np.maximum(inside, 0))
        first, last = (-b - root) / a, (-b + root) / a
    none = (inside < 0) | (a < 1e-15)
    return np.where(none, NOWHERE, first), np.where(none, -NOWHERE, last)


def _sphere(start: Floats, ways: Floats, size: tuple[float, ...]) -> Floats:
    return _first(*_roots(np.ones(len(ways)), ways @ start, float(start @ start - size[0] ** 2)))


def _cylinder(start: Floats, ways: Floats, size: tuple[float, ...]) -> Floats:
    radius, length = size
    flat = ways[:, :2]
    enter, leave = _roots((flat**2).sum(axis=1), flat @ start[:2], float(start[:2] @ start[:2] - radius**2))
    lower, upper = _slabs(start[2:], ways[:, 2:], np.array([length / 2]))
    return _first(np.maximum(enter, lower), np.minimum(leave, upper))


def _half_space(start: Floats, ways: Floats, _: tuple[float, ...]) -> Floats:
    with np.errstate(divide="ignore"):
        found = -start[2] / ways[:, 2]
    return np.where((found > 1e-9) & (ways[:, 2] < 0), found, NOWHERE)


_MEET = {"box": _box, "sphere": _sphere, "cylinder": _cylinder, "half_space": _half_space}


def _normals(body: Body, places: Floats) -> Floats:
    """(m, 3), outward, of places on the surface, in the body's frame."""
    normals = np.zeros_like(places)
    rows = np.arange(len(places))
    if body.kind == "half_space":
        normals[:, 2] = 1
    elif body.kind == "sphere":
        normals = places / body.size[0]
    elif body.kind == "box":
        shares = places / (np.array(body.size) / 2)
        axis = np.abs(shares).argmax(axis=1)
        normals[rows, axis] = np.sign(shares[rows, axis])
    else:
        on_end = np.abs(places[:, 2]) > body.size[1] / 2 - 1e-9
        normals[:, :2] = places[:, :2] / body.size[0]
        normals[on_end] = 0
        normals[on_end, 2] = np.sign(places[on_end, 2])
    return normals


def distance_to_boxes(points: Floats, boxes: list[Body]) -> Floats:
    """(n,), m, of points, (n, 3), from the union of boxes; 0 inside."""
    best: Optional[Floats] = None
    for box in boxes:
        beyond = np.maximum(np.abs((points - box.p) @ box.R) - np.array(box.size) / 2, 0)
        distance = np.linalg.norm(beyond, axis=1)
        best = distance if best is None else np.minimum(best, distance)
    return np.zeros(len(points)) if best is None else best


def depth_below(points: Floats, boxes: list[Body]) -> Floats:
    """(n,), m: how deep points, (n, 3), lie in the box that contains them most; 0 outside."""
    deepest = np.zeros(len(points))
    for box in boxes:
        inside = np.array(box.size) / 2 - np.abs((points - box.p) @ box.R)
        deepest = np.maximum(deepest, inside.min(axis=1))
    return deepest
