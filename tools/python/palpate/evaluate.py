"""Scores of a recorded run against the simulator's ground truth, as defined by
palpate-evaluate.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple, Optional

import numpy as np
from numpy.typing import NDArray

from palpate.channels import text_of
from palpate.log import Log
from palpate.mesh import Mesh, PointsInMesh

Floats = NDArray[np.float64]

_REST = 0.5  # s at the end of a run over which a steady-state error is taken


class Summary(NamedTuple):
    """Over nodes and time, m."""

    mean: float
    rms: float
    maximum: float


@dataclass(frozen=True)
class ShapeError:
    """Distance of the estimate's nodes from the simulator's corresponding material points."""

    time: Floats  # (m,), s since the first SHAPE
    mean: Floats  # (m,), m, over the nodes
    rms: Floats  # (m,), m
    maximum: Floats  # (m,), m
    displacement: Floats  # (m,), m, largest true displacement from rest
    distance: Floats  # (m, nodes), m
    length: float  # m, largest side of the object
    not_current: int  # shapes that were marked stale or not converged

    @property
    def whole(self) -> Summary:
        return self.between(-np.inf, np.inf)

    @property
    def at_end(self) -> Summary:
        """Over the last half second."""
        return self.between(float(self.time[-1]) - _REST, np.inf)

    def between(self, begin: float, end: float) -> Summary:
        """Of the shapes from `begin` to `end`, s. Raises ValueError if there are none."""
        at = (self.time >= begin) & (self.time <= end)
        if not at.any():
            raise ValueError(f"no shape from {begin} to {end} s")
        return Summary(
            float(self.mean[at].mean()),
            float(np.sqrt(np.square(self.rms[at]).mean())),
            float(self.maximum[at].max()),
        )


@dataclass(frozen=True)
class FeatureError:
    """The plant's own feature relative to the last target of the log."""

    kind: str
    target: Floats  # as in SHAPE_TARGET
    time: Floats  # (m,), s since the target was first sent
    value: Floats  # (m, values)
    distance: Floats  # (m,), m to the target; RMS over the points of a set
    angle: Floats  # (m,), rad to the target; 0 but for a pose
    overshoot: float  # overshoot along the line from the start, as a fraction of that line

    @property
    def at_rest(self) -> float:
        """m, mean over the last half second."""
        return float(self.distance[self.time >= self.time[-1] - _REST].mean())

    @property
    def angle_at_rest(self) -> float:
        """rad, mean over the last half second."""
        return float(self.angle[self.time >= self.time[-1] - _REST].mean())

    def settle_time(self, distance: float, angle: float = np.inf) -> Optional[float]:
        """Settling time: s from the target until the feature is within both bands and stays
        so to the end; None if it never does."""
        return settle_time(self.time, (self.distance <= distance) & (self.angle <= angle))


def settle_time(time: Any, within: Any) -> Optional[float]:
    """The first of `time` from which `within` holds to the end; None if it does not hold at
    the end."""
    times, inside = np.asarray(time, float), np.asarray(within, bool)
    if times.shape != inside.shape:
        raise ValueError("time and within differ in length")
    outside = np.flatnonzero(~inside)
    first = int(outside[-1]) + 1 if outside.size else 0
    return float(times[first]) if first < len(times) else None


def _truth_at(log: Log, utime: NDArray[np.int64], mesh: Mesh) -> tuple[NDArray[Any], Floats]:
    """Which of `utime` the truth covers, and the plant's nodes there, linearly interpolated."""
    truth = log["TRUTH_SHAPE"].of_mesh(mesh.hash)
    if not len(truth):
        raise ValueError("no TRUTH_SHAPE of the truth's mesh")
    positions = truth.positions
    covered = np.flatnonzero((utime >= truth.utime[0]) & (utime <= truth.utime[-1]))
    if not covered.size:
        raise ValueError("no SHAPE at a time that the truth covers")
    after = np.searchsorted(truth.utime, utime[covered], side="left")
    before = np.maximum(after - 1, 0)
    span = np.maximum(truth.utime[after] - truth.utime[before], 1)
    share = ((utime[covered] - truth.utime[before]) / span)[:, None, None]
    exact = (truth.utime[after] == utime[covered])[:, None, None]
    nodes = np.where(
        exact, positions[after], (1 - share) * positions[before] + share * positions[after]
    )
    return covered, nodes


def shape_error(log: Log) -> ShapeError:
    """Compares every SHAPE with the ground truth of the same instant at the estimate's nodes.
    The log must hold SHAPE, SHAPE_MESH, TRUTH_SHAPE and TRUTH_MESH, which travel on the
    housekeeping URL. Raises KeyError or ValueError if data are missing."""
    mesh, plant = log.mesh, log.truth_mesh
    shapes = log["SHAPE"].of_mesh(mesh.hash)
    if not len(shapes):
        raise ValueError("no SHAPE of the mesh that the log holds")
    covered, nodes = _truth_at(log, shapes.utime, plant)
    truth = PointsInMesh(plant, mesh.nodes).at(nodes)
    distance = np.linalg.norm(shapes.positions[covered] - truth, axis=2)
    if not np.isfinite(distance).all():
        raise ValueError("a shape that is not finite")
    moved = np.linalg.norm(nodes - plant.nodes, axis=2)
    return ShapeError(
        (shapes.utime[covered] - log["SHAPE"].utime[0]) * 1e-6,
        distance.mean(axis=1),
        np.sqrt(np.square(distance).mean(axis=1)),
        distance.max(axis=1),
        moved.max(axis=1),
        distance,
        plant.longest_side,
        int(np.count_nonzero(shapes.status[covered])),
    )


def coverage(error: Any, deviation: Any, dimensions: int = 3, level: float = 0.95) -> float:
    """The fraction of errors within their interval (1 dimension) or ball (3) of `level`;
    those with a deviation of 0 or below, fixed or not estimated, do not count. `error`: norm
    of the error; `deviation`: standard deviation of each axis, equal for all. Raises
    ValueError if none counts."""
    errors, deviations = np.broadcast_arrays(np.asarray(error, float), np.asarray(deviation, float))
    counted = deviations > 0
    if not counted.any():
        raise ValueError("no deviation is above 0: none was estimated")
    radius = _radius(dimensions, level)
    return float((np.abs(errors[counted]) <= radius * deviations[counted]).mean())


def shape_coverage(log: Log, level: float = 0.95) -> float:
    """The fraction of nodes and times at which the truth lies within the ball of `level`
    around the estimated node, by SHAPE's own standard deviations. Raises ValueError if it
    reports none."""
    mesh, plant = log.mesh, log.truth_mesh
    shapes = log["SHAPE"].of_mesh(mesh.hash)
    shapes = shapes.where(shapes.deviation_count == shapes.node_count)
    if not len(shapes):
        raise ValueError("no SHAPE with deviations: the estimator reports none")
    covered, nodes = _truth_at(log, shapes.utime, plant)
    truth = PointsInMesh(plant, mesh.nodes).at(nodes)
    distance = np.linalg.norm(shapes.positions[covered] - truth, axis=2)
    return coverage(distance, shapes.deviation[covered], 3, level)


def _radius(dimensions: int, level: float) -> float:
    """Radius of the ball that holds the probability `level` of a normal distribution with
    unit standard deviation in each axis.
    """
    if dimensions not in (1, 3) or not 0 < level < 1:
        raise ValueError("dimensions: 1 or 3; level: above 0, below 1")
    grid = np.linspace(0, 12, 1_200_001)
    weight = np.exp(-0.5 * np.square(grid)) * (np.square(grid) if dimensions == 3 else 1)
    share = np.cumsum(weight)
    return float(np.interp(level, share / share[-1], grid))


def feature_error(log: Log) -> FeatureError:
    """Scores the last target in the log, of kind point, points, pose or distance, on the
    plant. The target must name its rest points (Daemon.target(..., points=...)). Raises
    KeyError or ValueError if data are missing."""
    targets = log["SHAPE_TARGET"].messages
    last = targets[-1]
    first = next(i for i, target in enumerate(targets) if target.revision == last.revision)
    kind = text_of(last.kind)
    if last.point_count < 1:
        raise ValueError("the target names no rest points: it cannot be scored")
    points = np.asarray(last.rest_points, float)[: last.point_count]
    target = np.asarray(last.values, float)[: last.value_count]
    begin = int(log["SHAPE_TARGET"].utime[first])
    if log.clock == "sent":  # its sender does not run in lock-step
        features = log["FEATURE"]
        begin = int(features.utime[np.flatnonzero(features.revision == last.revision)[0]])
    plant = log.truth_mesh
    truth = log["TRUTH_SHAPE"].of_mesh(plant.hash)
    truth = truth.where(truth.utime >= begin)
    if not len(truth):
        raise ValueError("no TRUTH_SHAPE after the target was sent")
    value = feature_values(kind, PointsInMesh(plant, points).at(truth.positions))
    if value.shape[1] != len(target):
        raise ValueError(f"a target of kind {kind} with {len(target)} values")
    distance, angle = _errors(kind, value, target)
    places, goal = _places(kind, value), _places(kind, target[None])[0]
    way = goal - places[0]
    length = float(np.linalg.norm(way))
    beyond = float(((places - goal) @ way).max()) / length if length > 1e-9 else 0.0
    return FeatureError(
        kind,
        target,
        (truth.utime - begin) * 1e-6,
        value,
        distance,
        angle,
        max(0.0, beyond) / length if length > 1e-9 else 0.0,
    )


def feature_values(kind: str, points: Floats) -> Floats:
    """The feature at each time, (m, values), from the positions of its points, (m, points,
    3).
    """
    count = points.shape[1]
    if kind == "point" and count == 1:
        return points[:, 0]
    if kind == "points":
        return points.reshape(len(points), -1)
    if kind == "distance" and count == 2:
        return np.asarray(np.linalg.norm(points[:, 1] - points[:, 0], axis=1)[:, None])
    if kind == "pose" and count == 3:
        rotations = np.array([_frame(*of_time) for of_time in points])
        return np.concatenate([points.mean(axis=1), _quaternions(rotations)], axis=1)
    raise ValueError(f"a feature {kind!r} of {count} points cannot be scored")


def _frame(p1: Floats, p2: Floats, p3: Floats) -> Floats:
    """Axes as columns: x from p1 towards p2, z along the normal."""
    x = (p2 - p1) / np.linalg.norm(p2 - p1)
    normal = np.cross(p2 - p1, p3 - p1)
    z = normal / np.linalg.norm(normal)
    return np.column_stack([x, np.cross(z, x), z])


def _quaternions(rotations: Floats) -> Floats:
    """w, x, y, z with w >= 0, from the best conditioned eigenvector."""
    result = np.empty((len(rotations), 4))
    for index, r in enumerate(rotations):
        q = np.array(
            [
                [r[0, 0] + r[1, 1] + r[2, 2], r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]],
                [0, r[0, 0] - r[1, 1] - r[2, 2], r[1, 0] + r[0, 1], r[2, 0] + r[0, 2]],
                [0, 0, r[1, 1] - r[0, 0] - r[2, 2], r[2, 1] + r[1, 2]],
                [0, 0, 0, r[2, 2] - r[0, 0] - r[1, 1]],
            ]
        )  # fmt: skip
        vector = np.linalg.eigh(q, UPLO="U")[1][:, -1]
        result[index] = vector if vector[0] >= 0 else -vector
    return result


def _errors(kind: str, value: Floats, target: Floats) -> tuple[Floats, Floats]:
    if kind == "pose":
        distance = np.linalg.norm(value[:, :3] - target[:3], axis=1)
        cosine = np.abs(value[:, 3:] @ (target[3:] / np.linalg.norm(target[3:])))
        return distance, 2 * np.arccos(np.minimum(1, cosine))
    squares = np.square(value - target).sum(axis=1)
    if kind == "points":
        squares = 3 * squares / value.shape[1]
    return np.sqrt(squares), np.zeros(len(value))


def _places(kind: str, value: Floats) -> Floats:
    """Position of the feature, (m, 3): the centroid of a set."""
    if kind == "points":
        return np.asarray(value.reshape(len(value), -1, 3).mean(axis=1))
    if kind == "distance":
        return np.column_stack([value, np.zeros((len(value), 2))])
    return value[:, :3]
