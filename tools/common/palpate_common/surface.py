"""A closed triangle surface: closest points, samples, centre, sharp edges."""

from __future__ import annotations

from functools import cached_property
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from palpate_common.triangles import Triangles

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
SAME_SIDE = 0.5  # cosine between a measured normal and that of a triangle which may have been touched
FEW = 200  # triangles, of which all are tried
SHARP = np.cos(np.radians(30))  # cosine between the normals of two triangles at a sharp edge


class Surface:
    """Triangles in the mesh's frame O, m, with outward normals.

    nodes: (n, 3). triangles: (k, 3), counter-clockwise seen from outside. Raises ValueError for an
    open or flat surface.
    """

    def __init__(self, nodes: Any, triangles: Any) -> None:
        nodes, triangles = np.asarray(nodes, float), np.asarray(triangles, np.int64)
        corners = nodes[triangles]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        double = np.linalg.norm(normals, axis=1)
        keep = double > 1e-12 * max(double.max(initial=0.0), 1e-30)
        volumes = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
        self.volume = float(volumes.sum())
        lower, upper = nodes[triangles].min(axis=(0, 1)), nodes[triangles].max(axis=(0, 1))
        self.sides: Floats = upper - lower  # m, of the box around it
        if not abs(self.volume) > 1e-9 * float(self.sides.max()) ** 3:
            raise ValueError("the surface is open or encloses no volume")
        if self.volume < 0:
            triangles, normals, volumes = triangles[:, ::-1], -normals, -volumes
            corners, self.volume = corners[:, ::-1], -self.volume
        self.nodes, self.triangles = nodes, triangles[keep]
        self.corners, self.areas = corners[keep], 0.5 * double[keep]
        self._of_points = Triangles(self.corners)
        self.normals = self._of_points.normals
        self.center: Floats = volumes @ corners.sum(axis=1) / 4 / self.volume  # of the volume, m
        self.largest_side = float(self.sides.max())
        self._middles = self.corners.mean(axis=1)
        self._reach = float(np.linalg.norm(self.corners - self._middles[:, None], axis=2).max())
        self._tree = cKDTree(self._middles)

    def closest(self, points: Any, normals: Optional[Floats] = None) -> tuple[Floats, Ints]:
        """Closest points, (m, 3), and their triangles, (m,).

        points: (m, 3) in O. With `normals`, (m, 3), outward, measured (rows of zeros: none), only
        triangles on that side count, unless there are none. Among triangles at the same distance
        the one that faces the point most counts.
        """
        points = np.asarray(points, float)
        count = len(self.triangles)
        if count <= FEW:
            rows = np.repeat(np.arange(len(points)), count)
            chosen = np.tile(np.arange(count), len(points))
        else:
            near, _ = self._tree.query(points)
            # The nearest triangle that faces the right way may be farther than the nearest one.
            radius = near + self._reach + (0.0 if normals is None else 0.25 * self.largest_side)
            lists = self._tree.query_ball_point(points, radius)
            rows = np.repeat(np.arange(len(points)), [len(found) for found in lists])
            chosen = np.concatenate([np.asarray(found, np.int64) for found in lists])
        at = self._of_points.closest(points[rows], chosen)
        way = points[rows] - at
        score = np.linalg.norm(way, axis=1)
        facing = np.abs(np.einsum("ij,ij->i", way, self.normals[chosen]))
        score = score + 1e-6 * (score - facing)
        if normals is not None:
            same = np.einsum("ij,ij->i", normals[rows], self.normals[chosen]) >= SAME_SIDE
            has = np.linalg.norm(normals, axis=1)[rows] > 0.5
            score = score + np.where(same | ~has, 0.0, 10 * self.largest_side)
        if count <= FEW:
            first = count * np.arange(len(points)) + score.reshape(-1, count).argmin(axis=1)
        else:
            order = np.lexsort((score, rows))
            first = order[np.searchsorted(rows[order], np.arange(len(points)))]
        return at[first], chosen[first]

    def samples(self, count: int, seed: int = 0) -> tuple[Floats, Ints]:
        """`count` points spread evenly over the area, (count, 3) in O, and their triangles."""
        random = np.random.default_rng(seed)
        # One point per equal share of the area, in the order of the triangles.
        places = (np.arange(count) + random.uniform(size=count)) / count * self.areas.sum()
        chosen = np.minimum(np.searchsorted(np.cumsum(self.areas), places), len(self.areas) - 1)
        u, v = random.uniform(size=(2, count))
        u, v = np.where(u + v > 1, 1 - u, u), np.where(u + v > 1, 1 - v, v)
        a, b, c = (self.corners[chosen, i] for i in range(3))
        return a + u[:, None] * (b - a) + v[:, None] * (c - a), chosen

    @cached_property
    def sharp_edges(self) -> Floats:
        """Edges between triangles whose normals differ by more than 30 degrees, (e, 2 ends, 3), m."""
        places = np.round(self.corners.reshape(-1, 3) / (1e-6 * self.largest_side))
        index = np.unique(places, axis=0, return_inverse=True)[1]
        index = index.reshape(-1, 3)
        of: dict[tuple[int, int], int] = {}
        found = []
        for triangle, corner in enumerate(index):
            for i in range(3):
                a, b = int(corner[i]), int(corner[(i + 1) % 3])
                other = of.pop((min(a, b), max(a, b)), None)
                if other is None:
                    of[min(a, b), max(a, b)] = triangle
                elif self.normals[triangle] @ self.normals[other] < SHARP:
                    found.append(self.corners[triangle, [i, (i + 1) % 3]])
        return np.array(found).reshape(-1, 2, 3)

    def scaled(self, factor: float) -> "Surface":
        """The same shape `factor` times as large about its centre."""
        return Surface(self.center + factor * (self.nodes - self.center), self.triangles)


def gradients(points: Floats, feet: Floats, normals: Floats) -> tuple[Floats, Floats]:
    """Signed distances, (m,), m, positive outside, and their unit gradients by the point, (m, 3).

    All of one frame: points, their closest points, and the normals there, each (m, 3).
    """
    way = points - feet
    size = np.linalg.norm(way, axis=1)
    sign = np.where(np.einsum("ij,ij->i", way, normals) >= 0, 1.0, -1.0)
    on_surface = size < 1e-9
    with np.errstate(invalid="ignore", divide="ignore"):
        direction = np.where(on_surface[:, None], normals, (sign / size)[:, None] * way)
    return sign * size, direction


def box_surface(sides: Any) -> Surface:
    """A box with a corner in O and edges `sides`, (3,), m, along the axes of O."""
    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return Surface(corners * np.asarray(sides, float), triangles)


def closest_on_segments(points: Floats, segments: Floats) -> Floats:
    """(m, e, 3): closest point of each segment, (e, 2 ends, 3), to each point, (m, 3)."""
    a, way = segments[:, 0], segments[:, 1] - segments[:, 0]
    share = np.einsum("mej,ej->me", points[:, None] - a[None], way) / np.einsum("ej,ej->e", way, way)
    result: Floats = a + np.clip(share, 0, 1)[..., None] * way
    return result
