"""Closest points of triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def closest_points(points: Floats, corners: Floats) -> Floats:
    """Closest point of each triangle to its point, exactly.

    points: (m, 3). corners: (m, 3 corners, 3), one triangle per point. Returns (m, 3). Source:
    Ericson 2005, Real-Time Collision Detection, 5.1.5 (regions of Voronoi), for many at once.
    """
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    ab, ac = b - a, c - a

    def products(origin: Floats) -> tuple[Floats, Floats]:
        way = points - origin
        return np.einsum("ij,ij->i", ab, way), np.einsum("ij,ij->i", ac, way)

    d1, d2 = products(a)
    d3, d4 = products(b)
    d5, d6 = products(c)
    va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    with np.errstate(divide="ignore", invalid="ignore"):
        along_ab, along_ac = d1 / (d1 - d3), d2 / (d2 - d6)
        along_bc = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        total = 1 / (va + vb + vc)
    zero, one = np.zeros_like(d1), np.ones_like(d1)
    # (condition, weight of b, weight of c), the first that holds: corners, edges, the inside.
    regions = (
        ((d1 <= 0) & (d2 <= 0), zero, zero),
        ((d3 >= 0) & (d4 <= d3), one, zero),
        ((d6 >= 0) & (d5 <= d6), zero, one),
        ((vc <= 0) & (d1 >= 0) & (d3 <= 0), along_ab, zero),
        ((vb <= 0) & (d2 >= 0) & (d6 <= 0), zero, along_ac),
        ((va <= 0) & (d4 >= d3) & (d5 >= d6), 1 - along_bc, along_bc),
    )
    conditions = [region[0] for region in regions]
    v = np.select(conditions, [region[1] for region in regions], vb * total)
    w = np.select(conditions, [region[2] for region in regions], vc * total)
    result: Floats = a + v[:, None] * ab + w[:, None] * ac
    return result
