"""Corners of a dark square on a bright ground as intersections of its edges.

A corner that is searched for in its own surroundings moves inwards with the blur of the image, by a fifth of a pixel and
more, and the marker seems smaller and farther away. A straight edge keeps its place.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from palpate_common import robust

Floats = NDArray[np.float64]
FROM, TO = 0.12, 0.88  # share of a side whose edge is used: blur rounds its ends
REACH, LEAST_REACH = 3.0, 1.2  # px, of the profiles across an edge
OF_SIDE = 0.07  # reach relative to the side: less than the black border, a sixth to a ninth of it
STEP = 0.25  # px, along the profiles
ROUNDS = 3
FARTHEST = 2.0  # px, of a corner from where the search began


def square_corners(image: NDArray[np.uint8], corners: Floats) -> Floats:
    """(4, 2), px (column, row; pixel centres at whole numbers), of a square whose rough corners, (4, 2), are given in turn.

    An edge's place on a profile is the middle of its change of grey, weighted by the change. Corners that would move by more
    than FARTHEST stay where they are.
    """
    grey = np.asarray(image, float)
    found = np.asarray(corners, float)
    for _ in range(ROUNDS):
        lines = [_line(grey, found[i], found[(i + 1) % 4], found.mean(axis=0)) for i in range(4)]
        meeting = np.array([_meeting(lines[i - 1], lines[i]) for i in range(4)])
        if not np.isfinite(meeting).all():
            return np.asarray(corners, float)
        found = meeting
    is_near = np.linalg.norm(found - corners, axis=1) <= FARTHEST
    return np.where(is_near[:, None], found, corners)


def _line(grey: Floats, start: Floats, end: Floats, middle: Floats) -> tuple[Floats, float]:
    """Unit normal, (2,), and offset, px, of the line normal . x = offset along an edge."""
    side = float(np.linalg.norm(end - start))
    along = (end - start) / side
    normal = np.array([along[1], -along[0]])
    normal = normal if normal @ (start - middle) > 0 else -normal
    reach = float(np.clip(OF_SIDE * side, LEAST_REACH, REACH))
    count = max(8, int(side * (TO - FROM)))
    places = start + np.linspace(FROM, TO, count)[:, None] * (end - start)
    offsets = np.arange(-reach, reach + STEP / 2, STEP)
    at = places[:, None] + offsets[None, :, None] * normal
    profiles = map_coordinates(grey, [at[..., 1], at[..., 0]], order=1, mode="nearest")
    change = np.clip(np.diff(profiles, axis=1), 0, None)  # brighter outwards
    size = change.sum(axis=1)
    between = 0.5 * (offsets[1:] + offsets[:-1])
    is_edge = size > 0.3 * np.median(size) + 1e-9
    if is_edge.sum() < 4:
        return normal, np.nan
    shift = (change[is_edge] @ between) / size[is_edge]
    t = (places[is_edge] - start) @ along
    A = np.column_stack([np.ones(len(t)), t - t.mean()])
    w, solution = np.ones(len(t)), np.zeros(2)
    for _ in range(3):
        solution = np.linalg.lstsq(A * w[:, None], w * shift, rcond=None)[0]
        r = shift - A @ solution
        w = np.sqrt(robust.weights(r / max(1.4826 * float(np.median(np.abs(r))), 0.01)))
    point = start + t.mean() * along + solution[0] * normal
    turned = normal - solution[1] * along
    turned /= np.linalg.norm(turned)
    return turned, float(turned @ point)


def _meeting(a: tuple[Floats, float], b: tuple[Floats, float]) -> Floats:
    matrix = np.array([a[0], b[0]])
    if abs(np.linalg.det(matrix)) < 0.1:
        return np.full(2, np.nan)
    result: Floats = np.linalg.solve(matrix, [a[1], b[1]])
    return result
