"""The next touch that says most about the pose."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Optional

import numpy as np
from numpy.typing import NDArray
from scipy.special import erf

from palpate_common.pose import Pose
from palpate_common.surface import Surface, closest_on_segments
from palpate_register.information import touch_information

Floats = NDArray[np.float64]
CANDIDATES = 160  # places, and as many again at the margin from edges and in corners
MARGIN = 0.0025  # m, from sharp edges, besides the uncertainty of the pose
APART = 0.2  # of the largest side, between proposals on one face
SUFFICES = (4e-4, np.radians(0.05))  # m, rad: deviations below which more accuracy hardly counts


@dataclass(frozen=True, eq=False)
class Reach:
    """Where a probe can go: above a table, and not from below."""

    table: Optional[float] = None  # m, height of the table in W; None: from everywhere
    clearance: float = 0.005  # m, of the touched point above the table
    steepest_up: float = 0.5  # largest upward part of the unit vector of the approach
    # Boxes in O, lower and upper corner, m, that a clamp hides.
    hidden: list[tuple[Floats, Floats]] = field(default_factory=list)

    def allows(self, points_O: Floats, points_W: Floats, normals_W: Floats) -> NDArray[np.bool_]:
        """(n,), of places on the surface with their outward normals, each (n, 3)."""
        possible = np.ones(len(points_O), bool)
        if self.table is not None:
            possible &= (points_W[:, 2] > self.table + self.clearance) & (-normals_W[:, 2] < self.steepest_up)
        for lower, upper in self.hidden:
            inside = (points_O >= lower - self.clearance) & (points_O <= upper + self.clearance)
            possible &= ~inside.all(axis=1)
        return possible


@dataclass(frozen=True, eq=False)
class Touch:
    """A proposed guarded motion: from before the surface along the approach until contact."""

    point: Floats  # (3,), W, m, expected place
    approach: Floats  # (3,), unit, in W: against the outward normal
    gain: float  # nats, expected fall of half the log determinant of the covariance
    chance: float  # that the motion meets the expected face

    def shifted(self, spacing: float, most: int = 24) -> list["Touch"]:
        """The same motion at neighbouring places, nearest first, for when it meets nothing."""
        across = np.linalg.svd(self.approach[None])[2][1:]
        steps = [(i, j) for i in range(-3, 4) for j in range(-3, 4) if (i, j) != (0, 0)]
        steps.sort(key=lambda step: (step[0] ** 2 + step[1] ** 2, step))
        return [Touch(self.point + spacing * (i * across[0] + j * across[1]), self.approach, self.gain, self.chance)
                for i, j in steps[:most]]  # fmt: skip


def next_touches(surface: Surface, pose: Pose, covariance: Floats, deviation: float, normal_deviation: float,
                 reach: Reach, of_position: bool = False, count: int = 1, seed: int = 0) -> list[Touch]:  # fmt: skip
    """The best touches, the best first; empty where none is within reach.

    covariance: (6, 6) of (centre's position, rotation) in W. deviation: m, of a touch.
    normal_deviation: rad, inf without normals. of_position: counts the position alone. The gain is
    1/2 log det(C + S) before less after the touch, times the chance that the motion meets the face
    although the pose is uncertain. With S = 0 that is the mutual information of measurement and pose
    (Lindley 1956); S, of the deviations that suffice, keeps touches from directions that are known.
    """
    points, of = _candidates(surface, seed)
    normals = surface.normals[of]
    feet = closest_on_segments(points, surface.sharp_edges)
    to_edge = np.linalg.norm(feet - points[:, None], axis=2).min(axis=1, initial=np.inf)
    points_W, normals_W = pose.of(points), normals @ pose.R.T
    possible = to_edge > 0.9 * _margin(surface)
    possible &= reach.allows(points, points_W, normals_W)
    if not possible.any():
        return []
    points_W, normals_W, feet = points_W[possible], normals_W[possible], feet[possible]
    information = touch_information(surface, pose, points_W, normals_W, np.full(len(points_W), deviation), normal_deviation)
    after = np.linalg.inv(np.linalg.inv(covariance)[None] + information)
    part = slice(0, 3) if of_position else slice(0, 6)
    S = np.diag(np.repeat(SUFFICES, 3) ** 2)[part, part]
    before = np.linalg.slogdet(covariance[part, part] + S)[1]
    gain = 0.5 * (before - np.linalg.slogdet(after[:, part, part] + S)[1])
    arms = points_W - pose.of(surface.center[None])
    chance = _chance(points_W, arms, feet @ pose.R.T + pose.p, covariance)
    chosen: list[int] = []
    for i in np.argsort(-gain * chance, kind="stable"):
        near = np.linalg.norm(points_W[chosen] - points_W[i], axis=1) < APART * surface.largest_side
        if len(chosen) < count and not (near & (normals_W[chosen] @ normals_W[i] > 0.9)).any():
            chosen.append(int(i))
    return [Touch(points_W[i], -normals_W[i], float(gain[i]), float(chance[i])) for i in chosen]


def _margin(surface: Surface) -> float:
    return min(MARGIN, 0.2 * float(surface.sides.min()))


def _candidates(surface: Surface, seed: int) -> tuple[Floats, NDArray[np.int64]]:
    """Places on the surface, (n, 3) in O, and their triangles: spread evenly, and the same moved to
    the margin from the nearest edge, and from there to the next one, where levers are longest."""
    points, of = surface.samples(CANDIDATES, seed)
    edges, margin = surface.sharp_edges, _margin(surface)
    if len(edges) == 0:
        return points, of
    everything, now = [points], points
    for _ in range(2):
        feet = closest_on_segments(now, edges)
        size = np.linalg.norm(feet - now[:, None], axis=2)
        size[size < 1.5 * margin] = np.inf  # those at which the point is already
        nearest = size.argmin(axis=1)
        foot, way = feet[np.arange(len(now)), nearest], size[np.arange(len(now)), nearest]
        moves = np.isfinite(way)
        now = np.where(moves[:, None], foot + (now - foot) * (margin / np.where(moves, way, 1))[:, None], now)
        everything.append(now)
    on, chosen = surface.closest(np.concatenate(everything))
    return on, chosen


def _chance(points: Floats, arms: Floats, feet: Floats, covariance: Floats) -> Floats:
    """(n,): chance that the place stays on its face, by the sharp edge that limits it most.

    points, arms: (n, 3), W, m; the latter from the object's centre. feet: (n, e, 3), the closest
    points of the edges. For each edge the uncertainty of the place towards it counts.
    """
    if feet.shape[1] == 0:
        return np.ones(len(points))
    x, y, z = arms.T
    zero = np.zeros_like(x)
    J = np.tile(np.eye(3, 6), (len(arms), 1, 1))
    J[:, :, 3:] = np.array([[zero, z, -y], [-z, zero, x], [y, -x, zero]]).transpose(2, 0, 1)
    C = J @ covariance @ J.transpose(0, 2, 1)
    way = feet - points[:, None]
    size = np.linalg.norm(way, axis=2)
    u = way / np.maximum(size, 1e-9)[..., None]
    deviation = np.sqrt(np.einsum("nei,nij,nej->ne", u, C, u))
    result: Floats = erf((size / np.maximum(deviation, 1e-9)).min(axis=1) / np.sqrt(2))
    return result
