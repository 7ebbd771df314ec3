"""Closest points of triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Triangles:
    """Triangles, corners (k, 3 corners, 3), m, none of them flat, with what distances need."""

    def __init__(self, corners: Floats) -> None:
        self.corners = corners
        self._edges = np.roll(corners, -1, axis=1) - corners
        self._shares = self._edges / np.einsum("kci,kci->kc", self._edges, self._edges)[..., None]
        normals = np.cross(self._edges[:, 0], self._edges[:, 1])
        self.normals: Floats = normals / np.linalg.norm(normals, axis=1, keepdims=True)
        self._inward = np.cross(self.normals[:, None], self._edges)

    def closest(self, points: Floats, chosen: NDArray[np.int64]) -> Floats:
        """(m, 3): the closest point of one triangle, (m,), to each point, (m, 3), exactly.

        It is the foot on the triangle's plane where that lies inside of all three edges, otherwise
        the nearest of the closest points of the edges (cf. Ericson 2005, Real-Time Collision
        Detection, 5.1.5).
        """
        corners, normals = self.corners[chosen], self.normals[chosen]
        way = points[:, None] - corners
        share = np.einsum("mci,mci->mc", way, self._shares[chosen])
        feet = corners + np.minimum(np.maximum(share, 0), 1)[..., None] * self._edges[chosen]
        away = points[:, None] - feet
        nearest = np.einsum("mci,mci->mc", away, away).argmin(axis=1)
        on_edge = feet[np.arange(len(points)), nearest]
        inside = (np.einsum("mci,mci->mc", way, self._inward[chosen]) >= 0).all(axis=1)
        height = np.einsum("mi,mi->m", way[:, 0], normals)
        result: Floats = np.where(inside[:, None], points - height[:, None] * normals, on_edge)
        return result
