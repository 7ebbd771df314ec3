"""Images of an ArUco marker on the flange, by a small renderer of its own. Shares no code with the calibration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter
from scipy.spatial.transform import Rotation

from drawn_camera import HEIGHT, MIDDLE, WIDTH, FOCAL, Frame, pixel_rays, reported, unit

Floats = NDArray[np.float64]
VIEWS = 20
ROOM = np.array([0.2, 0.2, 0.15])  # m, half sides of the box of the marker's places
TURN = 45.0  # degrees, largest, from a marker that faces the camera
SIDE, SIDE_ERROR = 0.08, 0.003  # m; relative standard deviation of the printed side
MARGIN = 0.2  # of the side, white around the marker
# Marker 0 of the dictionary 4x4_50 (1: white), inside of a black border one square wide.
PATTERN = np.array([[1, 0, 1, 1], [0, 1, 0, 1], [0, 0, 1, 1], [0, 0, 1, 0]])
BLACK, WHITE = (20, 50), (170, 230)  # grey values
SAMPLES = 5  # per pixel and axis
BLUR, NOISE = (0.4, 0.9), 3.0  # px, grey values


@dataclass(frozen=True)
class Recording:
    """What the user has."""

    flanges: list[Frame]  # in W, as reported
    images: list[NDArray[np.uint8]]
    marker: Frame  # in E, unknown to the user


def brightness(x: Floats, y: Floats) -> Floats:
    """0 black, 1 white, -1 outside of the sheet, of places on the marker's plane, in sides from the middle; x right, y up."""
    squares = len(PATTERN) + 2
    grid = np.zeros((squares, squares))
    grid[1:-1, 1:-1] = PATTERN
    column, row = (np.floor((v + 0.5) * squares).astype(int) for v in (x, -y))
    on = (column >= 0) & (column < squares) & (row >= 0) & (row < squares)
    value = np.where(on, grid[np.clip(row, 0, squares - 1), np.clip(column, 0, squares - 1)], 1.0)
    return np.where(np.maximum(np.abs(x), np.abs(y)) > 0.5 + MARGIN, -1.0, value)


def render(marker: Frame, side: float, random: np.random.Generator) -> NDArray[np.uint8]:
    """Image, (HEIGHT, WIDTH), of a marker whose pose in C is given."""
    black, white = random.uniform(*BLACK), random.uniform(*WHITE)
    light = random.uniform(-0.15, 0.15, 2)  # change of the brightness over the image
    row, column = np.mgrid[:HEIGHT, :WIDTH]
    wall = 110 + 40 * np.sin(column / random.uniform(5, 40) + random.uniform(0, 6)) * np.sin(row / random.uniform(5, 40))
    image = wall.astype(float)
    sheet = marker.of((1 + 2 * MARGIN) * side * np.array([[-0.5, 0.5, 0], [0.5, 0.5, 0], [0.5, -0.5, 0], [-0.5, -0.5, 0]]))
    pixels = FOCAL * sheet[:, :2] / sheet[:, 2:] + [WIDTH / 2, HEIGHT / 2]
    low = np.maximum(np.floor(pixels.min(axis=0)).astype(int) - 2, 0)
    high = np.minimum(np.ceil(pixels.max(axis=0)).astype(int) + 3, [WIDTH, HEIGHT])
    fine = (np.arange(SAMPLES) + 0.5) / SAMPLES - 0.5  # pixel centres lie at whole numbers
    columns = (np.arange(low[0], high[0])[:, None] + fine).ravel()
    rows = (np.arange(low[1], high[1])[:, None] + fine).ravel()
    grid_columns, grid_rows = np.meshgrid(columns, rows)
    rays = pixel_rays(grid_columns.ravel(), grid_rows.ravel())
    normal = marker.R.apply([0, 0, 1])
    on_plane = marker.back(rays * ((marker.p @ normal) / (rays @ normal))[:, None]) / side
    value = brightness(on_plane[:, 0], on_plane[:, 1]).reshape(grid_rows.shape)
    nearest = [np.clip(np.round(grid).astype(int), 0, n - 1) for grid, n in ((grid_rows, HEIGHT), (grid_columns, WIDTH))]
    behind = image[nearest[0], nearest[1]]
    grey = np.where(value < 0, behind, black + value * (white - black))
    height, width = high[1] - low[1], high[0] - low[0]
    image[low[1] : high[1], low[0] : high[0]] = grey.reshape(height, SAMPLES, width, SAMPLES).mean(axis=(1, 3))
    image *= 1 + light[0] * (column / WIDTH - 0.5) + light[1] * (row / HEIGHT - 0.5)
    image = gaussian_filter(image, random.uniform(*BLUR)) + NOISE * random.normal(size=image.shape)
    return np.clip(np.round(image), 0, 255).astype(np.uint8)


def record(camera: Frame, random: np.random.Generator) -> Recording:
    """The marker in various places and directions, facing the camera more or less."""
    side = SIDE * (1 + SIDE_ERROR * random.normal())
    on_flange = Frame(Rotation.random(random_state=int(random.integers(2**31))), 0.1 * unit(random))
    flanges, images = [], []
    while len(flanges) < VIEWS:
        place = MIDDLE + random.uniform(-ROOM, ROOM)
        in_C = camera.back(place[None])[0]
        pixel = FOCAL * in_C[:2] / in_C[2] + [WIDTH / 2, HEIGHT / 2]
        if not ((pixel > 50) & (pixel < [WIDTH - 50, HEIGHT - 50])).all():
            continue
        tilt = Rotation.from_rotvec(np.radians(TURN) * random.uniform() ** 0.5 * unit(random))
        facing = Rotation.from_euler("x", 180, degrees=True) * Rotation.from_euler("z", random.uniform(-np.pi, np.pi))
        marker = Frame(tilt * facing, in_C)
        R_WM = camera.R * marker.R
        R_WE = R_WM * on_flange.R.inv()
        flange = Frame(R_WE, place - R_WE.apply(on_flange.p))
        flanges.append(reported(flange, random))
        images.append(render(marker, side, random))
    return Recording(flanges, images, on_flange)
