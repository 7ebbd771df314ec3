"""A box that is touched and seen by rays. Shares no code with the registration's geometry."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Optional

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Box:
    """Edges `sides`, (3,), m, a corner in O; pose X_WO: rotation R, (3, 3), and position p, (3,), m."""

    sides: Floats
    R: Floats
    p: Floats

    def hits(self, starts: Floats, directions: Floats) -> tuple[Floats, NDArray[np.int64]]:
        """Way to the first hit, (n,), m, inf without one, and the entered face's axis, (n,).

        Rays in W, (n, 3); the slab method (Kay and Kajiya 1986).
        """
        origin, way = (starts - self.p) @ self.R, directions @ self.R
        with np.errstate(divide="ignore", invalid="ignore"):
            a, b = (0 - origin) / way, (self.sides - origin) / way
        near, far = np.fmin(a, b), np.fmax(a, b)
        enters, leaves = near.max(axis=1), far.min(axis=1)
        return np.where((enters < leaves) & (enters > 0), enters, np.inf), near.argmax(axis=1)

    def touched(self, start: Floats, direction: Floats, farthest: float) -> Optional[tuple[Floats, Floats]]:
        """Place and outward normal, (3,) each, in W, where a guarded motion meets the box."""
        way, axis = self.hits(start[None], direction[None])
        if not way[0] < farthest:
            return None
        normal = self.R[:, axis[0]] * -np.sign(direction @ self.R[:, axis[0]])
        return start + way[0] * direction, normal

    def seen(self, camera: Floats, towards: Floats, random: np.random.Generator, pitch: float = 0.009,
             deviation: float = 1e-3, outliers: float = 0.02) -> Floats:  # fmt: skip
        """(n, 3), m, in W: cloud by a camera at a place that looks towards a point.

        pitch: of the rays at the object's distance, m. deviation: along the ray, m. outliers: share
        of points that lie up to 30 mm off.
        """
        forward = (towards - camera) / np.linalg.norm(towards - camera)
        right = np.cross(forward, [0, 0, 1.0])
        right /= np.linalg.norm(right)
        down = np.cross(forward, right)
        u, v = np.meshgrid(np.arange(-0.45, 0.45, pitch), np.arange(-0.45, 0.45, pitch))
        rays = towards - camera + u.reshape(-1, 1) * right + v.reshape(-1, 1) * down
        rays /= np.linalg.norm(rays, axis=1, keepdims=True)
        way, _ = self.hits(np.broadcast_to(camera, rays.shape), rays)
        seen = np.isfinite(way)
        way, rays = way[seen], rays[seen]
        error = deviation * random.normal(size=len(way))
        wrong = random.uniform(size=len(way)) < outliers
        error[wrong] = random.uniform(-0.03, 0.03, int(wrong.sum()))
        points: Floats = camera + (way + error)[:, None] * rays
        return points
