"""What an arm with a wrist sensor recorded, in moving poses or at rest, and what is known of its mounting."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Optional

import numpy as np

from palpate_common.input_error import InputError
from palpate_common.rotations import Array


@dataclass
class Stream:
    """One sensor. Raises InputError if its times do not increase or a value is not finite."""

    name: str
    time: Array  # s, (n,); of poses at rest: their number
    values: Array  # (n, channels)

    def __post_init__(self) -> None:
        order = np.argsort(self.time, kind="stable")
        self.time, self.values = np.asarray(self.time, float)[order], np.asarray(self.values, float)[order]
        wrong = np.flatnonzero(~np.isfinite(self.values).all(axis=1) | ~np.isfinite(self.time))
        if wrong.size:
            raise InputError(f"{self.name}: sample {wrong[0]} is not finite; allowed: finite numbers")


@dataclass
class Recording:
    """Poses of the flange E in the base W, and the readings of the sensors that it carries.

    At rest (`at_rest`) row i of every stream belongs to pose i. In motion each stream has its own times, all by the
    clock that the delays refer to.
    """

    name: str
    pose: Stream  # p_WE, m, and R_WE row by row: (n, 12)
    wrench: Stream  # as the sensor reports it, N and N m, (n, 6)
    acceleration: Optional[Stream] = None  # specific force in I (at rest: minus gravity), m/s^2, (n, 3)
    angular_velocity: Optional[Stream] = None  # in I, rad/s, (n, 3)
    gravity: Array = field(default_factory=lambda: np.array([0.0, 0.0, -9.81]))  # in W, m/s^2
    at_rest: bool = False


@dataclass
class Mounting:
    """Frames S (force-torque sensor) and I (inertial unit) in the flange E, from drawings. A rotation of None is
    unknown; positions stay within their deviation."""

    sensor_rotation: Optional[Array] = None  # R_ES, (3, 3)
    sensor_rotation_is_exact: bool = False  # as where the recorded poses are those of the sensor
    sensor_position: Array = field(default_factory=lambda: np.zeros(3))  # p_ES, m
    imu_rotation: Optional[Array] = None  # R_EI
    imu_position: Array = field(default_factory=lambda: np.zeros(3))  # p_EI, m
    sensor_position_deviation: float = 2e-3  # m
    imu_position_deviation: float = 0.02  # m
