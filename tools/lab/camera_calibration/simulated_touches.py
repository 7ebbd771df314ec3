"""Touched points and the same points picked in a noisy cloud. Shares no code with the calibration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from drawn_camera import MIDDLE, Frame, lateral, noisy, pixel_rays, unit, FOCAL, HEIGHT, WIDTH

Floats = NDArray[np.float64]
TOUCHES = 30
ROOM = np.array([0.3, 0.3, 0.2])  # m, half sides of the box of the touched points
TOUCH = 3e-4  # m, each axis of a touched point
PICK = 0.7  # px, each axis of a picked place
HALF = 8  # px, of the square of the cloud around a pick
TILT = 55.0  # degrees: largest angle between a touched face's normal and the viewing ray
WRONG, WRONG_BY = 0.03, 20.0  # share of picks of another place, px


@dataclass(frozen=True)
class Recording:
    """What the user has."""

    touched: Floats  # (n, 3), m, in W
    picked: Floats  # (n, 3), m, in C
    cloud: Floats  # (m, 3), m, in C


def record(camera: Frame, random: np.random.Generator) -> Recording:
    """Each point lies on a flat face of its own."""
    touched, picked, cloud = [], [], []
    while len(touched) < TOUCHES:
        point = MIDDLE + random.uniform(-ROOM, ROOM)
        in_C = camera.back(point[None])[0]
        at = FOCAL * in_C[:2] / in_C[2] + [WIDTH / 2, HEIGHT / 2]
        if not ((at > HALF) & (at < [WIDTH - HALF, HEIGHT - HALF])).all():
            continue
        ray = in_C / np.linalg.norm(in_C)
        normal = Rotation.from_rotvec(np.radians(TILT) * random.uniform() * unit(random)).apply(-ray)
        columns, rows = (np.round(at)[:, None] + np.mgrid[-HALF : HALF + 1, -HALF : HALF + 1].reshape(2, -1)).astype(float)
        shift = lateral(len(columns), random)
        taken = pixel_rays(columns + shift[0], rows + shift[1])
        depths = noisy((in_C @ normal) / (taken @ normal), random)
        cloud.append(depths[:, None] * pixel_rays(columns, rows))
        pick = at + PICK * random.normal(size=2)
        if random.uniform() < WRONG:
            pick = at + WRONG_BY * unit(random)[:2]
        nearest = np.argmin((columns - pick[0]) ** 2 + (rows - pick[1]) ** 2)
        picked.append(depths[nearest] * pixel_rays(pick[:1], pick[1:])[0])
        touched.append(point + TOUCH * random.normal(size=3))
    return Recording(np.array(touched), np.array(picked), np.concatenate(cloud))
