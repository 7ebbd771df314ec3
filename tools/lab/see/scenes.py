"""Drawn scenes: a bent bar on a table, clamped at one end, held by the robot's hand at the other, and a camera."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from depth_camera import Picture, picture
from rays import Body, Floats
from robot_bodies import Model
from scipy.spatial.transform import Rotation

BAR, TABLE, CLAMP, ROBOT = 1, 2, 3, 4  # labels
SIDE, LENGTH, PIECES = 0.06, 0.5, 20  # m; number of boxes of the bent bar
TABLE_HEIGHT = 0.28  # m, in W
HELD = 0.47  # m along the bar
FAR_END = np.array([1.36, 0.0, TABLE_HEIGHT + SIDE / 2])  # m, in W, of the bar's axis at the clamp
# Standard deviations of what the configuration states, each axis.
CAMERA_POSITION, CAMERA_ANGLE = 0.002, np.radians(0.1)  # of the calibrated camera: m, rad
JOINT = np.radians(0.1)  # of the arm's and the hand's angles: rad
TABLE_ERROR = 0.001  # m, of the table's configured height


@dataclass(frozen=True, eq=False)
class Scene:
    """R, p: true pose of the camera in W. R_believed, p_believed: as configured. angles: as ROBOT_STATE and HAND_STATE
    report them, rad. table, clamp: as configured. bar: the boxes of the true bar."""

    R: Floats
    p: Floats
    R_believed: Floats
    p_believed: Floats
    angles: dict[str, float]
    table_height: float
    clamp: Body
    bar: list[Body]
    picture: Picture


def _bar(lift: float, sideways: float) -> tuple[list[Body], Floats, Floats]:
    """Boxes along a smooth curve from the clamp to the hand, and the curve's place and direction where it is held."""
    s = np.linspace(0, LENGTH, 20 * PIECES + 1)
    share = np.clip((s - 0.1) / (LENGTH - 0.1), 0, 1)
    slope = np.stack([sideways * 2 * share, lift * 6 * share * (1 - share)]) / (LENGTH - 0.1)
    way = np.stack([-np.sqrt(np.maximum(1 - (slope**2).sum(axis=0), 0.1)), slope[0], slope[1]], axis=1)
    axis = FAR_END + np.concatenate([[[0, 0, 0]], np.cumsum(0.5 * (way[1:] + way[:-1]) * np.diff(s)[:, None], axis=0)])
    boxes = []
    for i in range(PIECES):
        a, b = axis[20 * i], axis[20 * (i + 1)]
        along = (b - a) / np.linalg.norm(b - a)
        up = np.array([0, 0, 1]) - along[2] * along
        up /= np.linalg.norm(up)
        R = np.column_stack([along, np.cross(up, along), up])
        boxes.append(Body("box", (1.02 * float(np.linalg.norm(b - a)), SIDE, SIDE), R, 0.5 * (a + b), BAR))
    held = int(round(HELD / LENGTH * 20 * PIECES))
    return boxes, axis[held], way[held] / np.linalg.norm(way[held])


def looking(eye: Floats, target: Floats) -> Floats:
    """R of a camera, z towards the target, y downwards."""
    z = (target - eye) / np.linalg.norm(target - eye)
    x = np.cross(z, [0, 0, 1])
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])


def draw(urdf: Path, seed: int) -> Scene:
    """The scene of a seed: bend, side of the fingers, camera, errors of what is configured and reported, noise."""
    random = np.random.default_rng([2024, seed])
    model = Model(urdf)
    bar, middle, along = _bar(random.uniform(0.02, 0.08), random.uniform(-0.06, 0.06))
    forwards = -along  # of the hand: from the flange to the fingertips
    side = np.cross([0, 0, 1], forwards) * random.choice([-1, 1])
    side /= np.linalg.norm(side)
    R_WE = np.column_stack([side, np.cross(forwards, side), forwards])
    # The last 6 mm of the bar lie behind the tips' middle; the palm is 70 mm behind it.
    true_angles = model.grasp(R_WE, middle)
    clamp = Body("box", (0.03, 0.1, 0.1), np.eye(3), FAR_END + np.array([0.015, 0, 0.02]), CLAMP)
    table = Body("half_space", (), np.eye(3), np.array([0, 0, TABLE_HEIGHT]), TABLE)
    bodies = [*bar, clamp, table, *model.bodies(true_angles, ROBOT)]

    azimuth, elevation = random.uniform(-np.pi / 2, np.pi / 2), random.uniform(np.radians(30), np.radians(65))
    target = np.array([1.1, 0, 0.32]) + random.uniform(-0.05, 0.05, 3)
    sideways = np.array([np.sin(azimuth), -np.cos(azimuth), 0]) * np.cos(elevation)
    p = target + random.uniform(0.8, 1.2) * (sideways + np.array([0, 0, np.sin(elevation)]))
    R = looking(p, target)
    turn = Rotation.from_rotvec(CAMERA_ANGLE * random.normal(size=3)).as_matrix()
    fingers = [f"{finger}_j{i}" for finger in ("ff", "mf", "rf", "lf") for i in (4, 3, 2, 1)]
    names = [*true_angles, *fingers, "th_j5", "th_j4", "th_j2", "th_j1"]
    angles = {name: true_angles.get(name, 0.0) + JOINT * random.normal() for name in names}
    return Scene(R, p, turn @ R, p + CAMERA_POSITION * random.normal(size=3), angles,
                 TABLE_HEIGHT + TABLE_ERROR * random.normal(), clamp, bar, picture(R, p, bodies, random))  # fmt: skip
