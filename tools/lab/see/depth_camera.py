"""Depth images of bodies with the errors of a structured-light camera, independent of tools/see and sim/camera."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from rays import Body, Floats, cast

WIDTH, HEIGHT, FOCAL = 640, 480, 585.0  # px
BASE = 0.075  # m, between projector and camera
MIXED = 100  # label of a pixel whose depth is a mixture of two bodies'
NOTHING = -1


@dataclass(frozen=True, eq=False)
class Picture:
    """depth: (h, w), m, 0: none. label: (h, w), of the body that was measured. truth: (h, w), label without errors."""

    depth: Floats
    label: NDArray[np.int64]
    truth: NDArray[np.int64]


def directions() -> Floats:
    """(h w, 3): rays of the pixels in C, not of unit length: z is 1."""
    rows, columns = np.mgrid[0:HEIGHT, 0:WIDTH]
    x, y = (columns - (WIDTH - 1) / 2) / FOCAL, (rows - (HEIGHT - 1) / 2) / FOCAL
    return np.stack([x, y, np.ones((HEIGHT, WIDTH))], axis=-1).reshape(-1, 3)


def picture(R: Floats, p: Floats, bodies: list[Body], random: np.random.Generator) -> Picture:
    """Of a camera at pose R, p in W, z forwards.

    Noise along the axis and of edges in the image: Nguyen, Izadi and Lovell 2012; steps of an eighth of a pixel of
    disparity: Khoshelham and Elberink 2012. Of the pixels next to a jump of the depth half are lost and a fifth lies
    anywhere between both sides.
    """
    rays = directions()
    length = np.linalg.norm(rays, axis=1)
    hits = cast(p, rays @ R.T / length[:, None], bodies)
    z = np.where(hits.label >= 0, hits.distance / length, 0.0)
    cosine = np.clip(np.abs(np.einsum("ij,ij->i", rays @ R.T, hits.normal)) / length, 1e-3, 1)
    angle = np.arccos(cosine).reshape(HEIGHT, WIDTH)
    z, truth = z.reshape(HEIGHT, WIDTH), hits.label.reshape(HEIGHT, WIDTH)
    steep = angle / np.maximum(np.pi / 2 - angle, 1e-3)

    rows, columns = np.mgrid[0:HEIGHT, 0:WIDTH]
    shift = (0.8 + 0.035 * np.minimum(steep, 20)) * random.normal(size=(2, HEIGHT, WIDTH))
    source = (np.clip(rows + np.rint(shift[0]), 0, HEIGHT - 1).astype(int),
              np.clip(columns + np.rint(shift[1]), 0, WIDTH - 1).astype(int))  # fmt: skip
    # A displaced pixel has the depth of its neighbour's body; on one surface lateral errors are in the axial noise already.
    other = truth[source] != truth
    depth, label = np.where(other, z[source], z), np.where(other, truth[source], truth)

    at_jump, far = _jumps(depth)
    share = random.uniform(size=depth.shape)
    blended = at_jump & (random.uniform(size=depth.shape) < 0.2)
    depth = np.where(blended, depth + share * (far - depth), depth)
    label = np.where(blended, MIXED, label)
    lost = at_jump & ~blended & (random.uniform(size=depth.shape) < 0.5)
    seen = (depth > 0.4) & (depth < 5) & ~lost & (angle < 1.4)

    at = np.where(seen, depth, 1.0)
    axial = 0.0012 + 0.0019 * (at - 0.4) ** 2
    axial = axial + np.where(angle > np.pi / 3, 1e-4 / np.sqrt(at) * np.minimum(steep, 20) ** 2, 0)
    at = at + axial * random.normal(size=depth.shape)
    disparity = np.maximum(np.rint(8 * FOCAL * BASE / np.maximum(at, 0.1)), 1) / 8
    measured = FOCAL * BASE / disparity
    return Picture(np.where(seen, measured, 0.0), np.where(seen, label, NOTHING), truth)


def _jumps(depth: Floats) -> tuple[NDArray[np.bool_], Floats]:
    """Whether a pixel has a neighbour whose depth differs by more than 2 %, and the depth of that which differs most, m."""
    most, far = np.zeros_like(depth), depth.copy()
    for axis in (0, 1):
        for step in (-1, 1):
            neighbour = np.roll(depth, step, axis)
            gap = np.where((neighbour > 0) & (depth > 0), np.abs(neighbour - depth), 0)
            larger = gap > most
            most, far = np.where(larger, gap, most), np.where(larger, neighbour, far)
    return most > 0.02 * np.maximum(depth, 1e-9), far
