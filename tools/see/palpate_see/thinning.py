"""At most 256 of a cloud's points, well spread over the surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate_common.section import Section
from palpate_see.cloud import Floats

MOST = 256  # points of a message
GROWTH = 1.1  # of the voxel's side from one trial to the next, at least
HALVINGS = 5  # of the interval of sides that contains the smallest which fits
Indices = NDArray[np.int64]


@dataclass(frozen=True)
class Thinning:
    """method: `voxel`, of each cell of a grid the point nearest to the mean of its points; or `farthest`, each next point is
    the farthest from those taken.

    points: at most so many. voxel: smallest side of a cell, m; the grid is made coarser until its points fit.
    """

    method: str = "voxel"
    points: int = MOST
    voxel: float = 0.005

    def chosen(self, points: Floats) -> Indices:
        """Indices, (m,), ascending, of points, (n, 3), m. The same points give the same result."""
        if self.method == "farthest":
            return farthest(points, self.points)
        return voxels(points, self.voxel, self.points)


def voxels(points: Floats, side: float, most: int) -> Indices:
    """Indices, (m,), of one point per cell of a grid through the origin, at least of that side, m."""
    if len(points) == 0:
        return np.zeros(0, np.int64)
    cells = _fitting_cells(points, side, most)
    count = np.bincount(cells)
    means = np.stack([np.bincount(cells, points[:, axis]) for axis in range(3)], axis=1) / count[:, None]
    away = np.linalg.norm(points - means[cells], axis=1)
    # By coordinates where two are equally near, so that the order of the points does not matter.
    order = np.lexsort((*points.T, np.round(away, 9), cells))
    first = np.searchsorted(cells[order], np.arange(len(count)))
    return np.sort(order[first])


def _fitting_cells(points: Floats, side: float, most: int) -> Indices:
    """(n,): number of the cell of each point, of a grid of about the smallest sides, at least `side`, m, that give at most
    `most` cells."""
    cells, too_small = _cells(points, side), side
    if cells.max() < most:
        return cells
    while cells.max() >= most:
        too_small = side
        # On a surface the cells are as many as squares of their side fit on its area.
        side *= max(GROWTH, float(np.sqrt((cells.max() + 1) / most)))
        cells = _cells(points, side)
    for _ in range(HALVINGS):
        middle = 0.5 * (too_small + side)
        others = _cells(points, middle)
        if others.max() >= most:
            too_small = middle
        else:
            side = middle
            cells = others if others.max() > cells.max() else cells
    return cells


def _cells(points: Floats, side: float) -> Indices:
    """(n,): number of the occupied cell of each point."""
    places = np.floor(points / side).astype(np.int64)
    places -= places.min(axis=0)
    extent = places.max(axis=0) + 1
    _, cells = np.unique((places[:, 0] * extent[1] + places[:, 1]) * extent[2] + places[:, 2], return_inverse=True)
    return np.asarray(cells, np.int64)


def farthest(points: Floats, most: int) -> Indices:
    """Indices, (m,): from the point nearest to the mean, each next one is the farthest from all before (Gonzalez 1985)."""
    if len(points) <= most:
        return np.arange(len(points))
    taken = [int(np.linalg.norm(points - points.mean(axis=0), axis=1).argmin())]
    away = np.full(len(points), np.inf)
    while len(taken) < most:
        away = np.minimum(away, ((points - points[taken[-1]]) ** 2).sum(axis=1))
        taken.append(int(away.argmax()))
    return np.sort(np.array(taken, np.int64))


def read_thinning(section: Section) -> Thinning:
    """Of section `thinning`. Raises InputError."""
    usual = Thinning()
    made = Thinning(
        section.choice("method", ["voxel", "farthest"], usual.method),
        section.whole("points", 1, MOST, usual.points),
        section.number("voxel", 1e-4, 1, usual.voxel),
    )
    section.check_unused()
    return made
