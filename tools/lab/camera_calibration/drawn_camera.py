"""A camera in front of a robot, what is believed of it, and the noise of its depths. Shares no code with the calibration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Floats = NDArray[np.float64]
MIDDLE = np.array([0.6, 0.0, 0.3])  # m, in W, of the workspace
DISTANCE = (0.8, 1.2)  # m, of the camera from it
OFF_POSITION, OFF_ANGLE = 0.02, 2.0  # m, degrees: of the guess from the truth, in random directions
ARM_POSITION, ARM_ANGLE = 3e-4, 0.05  # m, degrees: each axis of the flange's reported pose
# A camera of the Kinect's class: image, baseline of the projector, steps of the disparity.
WIDTH, HEIGHT, FOCAL = 640, 480, 580.0  # px
BASE, STEP = 0.075, 0.125  # m, px
LATERAL = 0.8  # px, of the place at which a pixel's depth is taken
FLYING, FLYING_DEPTH = 0.02, 0.05  # share of gross errors, m


@dataclass(frozen=True)
class Frame:
    """Pose of a frame: rotation and position, m, in another one."""

    R: Rotation
    p: Floats

    def of(self, points: Floats) -> Floats:
        """(n, 3) of this frame in the other one."""
        return self.R.apply(points) + self.p

    def back(self, points: Floats) -> Floats:
        """(n, 3) of the other frame in this one."""
        return self.R.inv().apply(points - self.p)


def unit(random: np.random.Generator) -> Floats:
    """A random direction, (3,)."""
    v = random.normal(size=3)
    return v / np.linalg.norm(v)


def looking(eye: Floats, target: Floats, roll: float) -> Frame:
    """Camera at `eye` with z towards `target`, x about horizontal; roll in rad."""
    z = (target - eye) / np.linalg.norm(target - eye)
    x = np.cross(z, [0, 0, 1])
    x /= np.linalg.norm(x)
    return Frame(Rotation.from_matrix(np.column_stack([x, np.cross(z, x), z])) * Rotation.from_rotvec([0, 0, roll]), eye)


def draw_camera(random: np.random.Generator) -> tuple[Frame, Frame]:
    """The camera's pose in W and the guess."""
    forwards, side = random.uniform(-0.2, 0.8), random.choice([-1, 1]) * random.uniform(0.5, 1)
    direction = np.array([forwards, side, random.uniform(0.4, 0.9)])
    eye = MIDDLE + random.uniform(*DISTANCE) * direction / np.linalg.norm(direction)
    camera = looking(eye, MIDDLE + random.uniform(-0.05, 0.05, 3), random.uniform(-0.2, 0.2))
    off = Rotation.from_rotvec(np.radians(OFF_ANGLE) * unit(random))
    return camera, Frame(off * camera.R, camera.p + OFF_POSITION * unit(random))


def reported(flange: Frame, random: np.random.Generator) -> Frame:
    """What the arm reports of its flange."""
    turn = Rotation.from_rotvec(np.radians(ARM_ANGLE) * random.normal(size=3))
    return Frame(turn * flange.R, flange.p + ARM_POSITION * random.normal(size=3))


def pixel_rays(columns: Floats, rows: Floats) -> Floats:
    """(n, 3), of length 1 along z."""
    return np.column_stack([(columns - WIDTH / 2) / FOCAL, (rows - HEIGHT / 2) / FOCAL, np.ones(len(columns))])


def noisy(depths: Floats, random: np.random.Generator) -> Floats:
    """Depths, m, with noise along the axis (Nguyen, Izadi and Lovell 2012), steps of the disparity, and gross errors."""
    z = depths + (0.0012 + 0.0019 * (depths - 0.4) ** 2) * random.normal(size=len(depths))
    disparity = np.round(FOCAL * BASE / z / STEP) * STEP
    z = FOCAL * BASE / disparity
    flying = random.uniform(size=len(z)) < FLYING
    return z + flying * random.uniform(-FLYING_DEPTH, FLYING_DEPTH, len(z))


def lateral(count: int, random: np.random.Generator) -> tuple[Floats, Floats]:
    """Shifts of columns and rows, px, of the places at which depths are taken."""
    return LATERAL * random.normal(size=count), LATERAL * random.normal(size=count)
