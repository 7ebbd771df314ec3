"""Points of the side that an object stands on, which a scan does not see."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
NEAR = 2.5  # spacings beyond those of the unseen places: points of the rim
FLAT = 1.5  # spacings: standard deviation of the rim from its plane
ALONG = 0.6  # cosine between normals of the rim and of its plane, below which the rim's sides end at the plane


class Added(NamedTuple):
    """points, normals: (n, 3), m and unit, outward; n may be 0."""

    points: Floats
    normals: Floats


def support_points(points: Floats, normals: Floats, unseen: Floats, spacing: float) -> Added:
    """Points on the plane of the rim round the unseen places, if the scan's sides end at it.

    points, normals: (m, 3), of the cloud. unseen: (u, 3), places of a closed surface far from all points, m. A hole within a
    side, whose rim faces as the plane does, is left to the reconstruction. The rim must be seen whole from its centre.
    """
    nothing = Added(np.zeros((0, 3)), np.zeros((0, 3)))
    if len(unseen) < 10:
        return nothing
    # The side with most unseen places: those on one side of the cloud's middle.
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    way = unseen.mean(axis=0) - middle
    if np.linalg.norm(way) < 5 * spacing:
        return nothing
    outward = way / np.linalg.norm(way)
    height = points @ outward
    for _ in range(3):
        rim = _rim(points, outward, height, spacing)
        if len(rim) < 20:
            return nothing
        center = points[rim].mean(axis=0)
        axes = np.linalg.svd(points[rim] - center)[2]
        outward = axes[2] * (1 if axes[2] @ outward > 0 else -1)
        height = points @ outward
    off = (points[rim] - center) @ outward
    if off.std() > FLAT * spacing or np.abs(normals[rim] @ outward).mean() > ALONG:
        return nothing
    level = float(np.quantile(height[rim], 0.9))
    if (height > level + FLAT * 2 * spacing).any():
        return nothing
    flat = (points[rim] - center) @ axes[:2].T
    return _filled(flat, axes[:2], outward, center + outward * (level - float(center @ outward)), points, spacing)


def _rim(points: Floats, outward: Floats, height: Floats, spacing: float) -> NDArray[np.int64]:
    """Points that are outermost in a layer of a few spacings."""
    return np.flatnonzero(height > np.quantile(height, 0.999) - NEAR * spacing)


def _filled(flat: Floats, axes: Floats, outward: Floats, at: Floats, points: Floats, spacing: float) -> Added:
    """A grid within the rim, (r, 2), which is taken as a star round its middle."""
    middle = 0.5 * (flat.min(axis=0) + flat.max(axis=0))
    polar = flat - middle
    sectors = 144  # a rim of wider ones reaches beyond straight sides
    sector = ((np.arctan2(polar[:, 1], polar[:, 0]) + np.pi) / (2 * np.pi) * sectors).astype(int) % sectors
    reach = np.zeros(sectors)
    np.maximum.at(reach, sector, np.linalg.norm(polar, axis=1))
    known = np.flatnonzero(reach > 0)
    reach = np.interp(np.arange(sectors), known, reach[known], period=sectors)
    steps = [np.arange(low, high + spacing, spacing) for low, high in zip(flat.min(axis=0), flat.max(axis=0))]
    grid = np.stack(np.meshgrid(*steps), axis=-1).reshape(-1, 2)
    polar = grid - middle
    sector = ((np.arctan2(polar[:, 1], polar[:, 0]) + np.pi) / (2 * np.pi) * sectors).astype(int) % sectors
    grid = grid[np.linalg.norm(polar, axis=1) < reach[sector] - 0.5 * spacing]
    placed = at + grid @ axes
    return Added(placed, np.tile(outward, (len(placed), 1)))
