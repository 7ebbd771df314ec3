"""Depth images of a hand on the flange, by casting rays. Shares no code with the calibration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from drawn_camera import HEIGHT, MIDDLE, WIDTH, FOCAL, Frame, lateral, noisy, pixel_rays, reported, unit

Floats = NDArray[np.float64]
VIEWS = 14
ROOM = np.array([0.18, 0.18, 0.14])  # m, half sides of the box of the hand's places
TURN = 60.0  # degrees, largest, from a hand that points downwards
STRIDE = 2  # px between rays
STEEPEST = 80.0  # degrees between normal and viewing ray, beyond which nothing is seen
# Boxes of the hand in E, m: lower and upper corner; flange adapter, palm, two fingers, bracket.
BOXES = np.array([[[-0.035, -0.035, 0.0], [0.035, 0.035, 0.04]], [[-0.06, -0.045, 0.04], [0.06, 0.045, 0.13]],
                  [[-0.055, -0.015, 0.13], [-0.03, 0.015, 0.21]], [[0.03, -0.015, 0.13], [0.055, 0.015, 0.19]],
                  [[0.06, -0.03, 0.06], [0.1, 0.02, 0.08]]])  # fmt: skip
CORNERS = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)])
QUADS = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))  # outward


def hand_mesh() -> tuple[Floats, NDArray[np.int64]]:
    """Nodes, (n, 3), m, in E, and triangles, (k, 3), outward."""
    nodes = np.concatenate([lower + CORNERS * (upper - lower) for lower, upper in BOXES])
    triangles = [(8 * b + q[0], 8 * b + q[i], 8 * b + q[i + 1]) for b in range(len(BOXES)) for q in QUADS for i in (1, 2)]
    return nodes, np.array(triangles, np.int64)


@dataclass(frozen=True)
class Recording:
    """What the user has."""

    flanges: list[Frame]  # in W, as reported
    clouds: list[Floats]  # (n, 3), m, in C


def cast(origins: Floats, ways: Floats) -> tuple[Floats, Floats]:
    """Lengths along rays in E, (n,), inf where they miss, and cosines between normal and ray, of the nearest box (slabs)."""
    nearest, cosine = np.full(len(ways), np.inf), np.ones(len(ways))
    with np.errstate(divide="ignore", invalid="ignore"):
        for lower, upper in BOXES:
            a, b = (lower - origins) / ways, (upper - origins) / ways
            enter, leave = np.minimum(a, b), np.maximum(a, b)
            start, end = enter.max(axis=1), leave.min(axis=1)
            hit = (start < end) & (start > 0) & (start < nearest)
            axis = enter.argmax(axis=1)
            nearest = np.where(hit, start, nearest)
            size = np.abs(ways[np.arange(len(ways)), axis]) / np.linalg.norm(ways, axis=1)
            cosine = np.where(hit, size, cosine)
    return nearest, cosine


def seen(camera: Frame, flange: Frame, random: np.random.Generator) -> Floats:
    """Cloud, (n, 3), m, in C, of the hand."""
    in_C = camera.back(flange.of(hand_mesh()[0]))
    pixels = FOCAL * in_C[:, :2] / in_C[:, 2:] + [WIDTH / 2, HEIGHT / 2]
    low = np.maximum(np.floor(pixels.min(axis=0)) - 4, 0)
    high = np.minimum(np.ceil(pixels.max(axis=0)) + 4, [WIDTH - 1, HEIGHT - 1])
    grids = np.meshgrid(np.arange(low[0], high[0], STRIDE), np.arange(low[1], high[1], STRIDE))
    columns, rows = (grid.ravel() for grid in grids)
    shift = lateral(len(columns), random)
    taken = camera.R.apply(pixel_rays(columns + shift[0], rows + shift[1]))
    ways = flange.R.inv().apply(taken)
    origins = np.repeat(flange.back(camera.p[None]), len(ways), axis=0)
    depths, cosine = cast(origins, ways)  # rays have length 1 along z, so that lengths are depths
    visible = np.isfinite(depths) & (cosine > np.cos(np.radians(STEEPEST)))
    return noisy(depths[visible], random)[:, None] * pixel_rays(columns[visible], rows[visible])


def record(camera: Frame, random: np.random.Generator) -> Recording:
    """The hand in various places and directions."""
    flanges, clouds = [], []
    down = Rotation.from_euler("y", 180, degrees=True)
    while len(flanges) < VIEWS:
        R = Rotation.from_rotvec(np.radians(TURN) * random.uniform() ** (1 / 3) * unit(random)) * down
        R = R * Rotation.from_euler("z", random.uniform(-np.pi, np.pi))
        flange = Frame(R, MIDDLE + random.uniform(-ROOM, ROOM) - R.apply([0, 0, 0.1]))
        cloud = seen(camera, flange, random)
        if len(cloud) < 200:  # mostly outside of the image
            continue
        flanges.append(reported(flange, random))
        clouds.append(cloud)
    return Recording(flanges, clouds)
