"""Parameters of a wrist: values, increments, and what is believed of them before the recording."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from typing import Any

import numpy as np

from palpate_common.rotations import Array, exp_rotation


@dataclass(frozen=True)
class Block:
    """A group of parameters. `deviation` is the prior standard deviation of each entry, in its unit."""

    name: str
    labels: tuple[str, ...]
    unit: str
    deviation: float

    @property
    def size(self) -> int:
        return len(self.labels)

    def concerns(self, group: str) -> bool:
        """Whether the readings of this group depend on the parameters."""
        is_inertial = group in ("acceleration", "angular_velocity")
        return self.name == "gravity_tilt" or is_inertial == (self.name in INERTIAL)


def _xyz(name: str) -> tuple[str, ...]:
    return tuple(f"{name}_{axis}" for axis in "xyz")


# Drifts are those from the first to the last sample; biases refer to the middle of the recording.
BLOCKS = (
    Block("mass", ("mass",), "kg", 50),
    Block("moment", _xyz("moment"), "kg m", 20),
    Block("inertia", tuple(f"inertia_{pair}" for pair in ("xx", "xy", "xz", "yy", "yz", "zz")), "kg m^2", 1),
    Block("force_bias", _xyz("force_bias"), "N", 300),
    Block("torque_bias", _xyz("torque_bias"), "N m", 30),
    Block("force_drift", _xyz("force_drift"), "N", 10),
    Block("torque_drift", _xyz("torque_drift"), "N m", 1),
    Block("force_hysteresis", _xyz("force_hysteresis"), "N", 0.1),
    Block("torque_hysteresis", _xyz("torque_hysteresis"), "N m", 5e-3),
    Block("cable_stiffness", ("cable_stiffness",), "N/m", 20),
    Block("cable_torsion", ("cable_torsion",), "N m/rad", 0.5),
    Block("sensor_rotation", _xyz("sensor_rotation"), "rad", 0.5),
    Block("sensor_position", _xyz("sensor_position"), "m", 0),
    Block("gravity_tilt", ("gravity_tilt_x", "gravity_tilt_y"), "rad", 1),
    Block("wrench_delay", ("wrench_delay",), "s", 0.1),
    Block("imu_rotation", _xyz("imu_rotation"), "rad", 0.5),
    Block("imu_position", _xyz("imu_position"), "m", 0),
    Block("acceleration_bias", _xyz("acceleration_bias"), "m/s^2", 1),
    Block("rate_bias", _xyz("rate_bias"), "rad/s", 0.2),
    Block("imu_delay", ("imu_delay",), "s", 0.1),
)
INERTIAL = {"imu_rotation", "imu_position", "acceleration_bias", "rate_bias", "imu_delay"}
ROTATIONS = {"sensor_rotation": "R_ES", "imu_rotation": "R_EI"}


def _zeros(size: int) -> Any:
    return field(default_factory=lambda: np.zeros(size))


@dataclass(frozen=True)
class WristParameters:
    """Values. S: force-torque sensor, E: flange, I: inertial unit, W: base."""

    mass: float = 0.0  # kg
    moment: Array = _zeros(3)  # mass * p_S_com, kg m
    inertia: Array = _zeros(6)  # xx, xy, xz, yy, yz, zz about the origin of S, in S, kg m^2
    force_bias: Array = _zeros(3)  # reading without load, in S, N
    torque_bias: Array = _zeros(3)  # N m
    force_drift: Array = _zeros(3)  # change of the bias over the recording, N
    torque_drift: Array = _zeros(3)  # N m
    force_hysteresis: Array = _zeros(3)  # by which a rising reading is too low, and a falling one too high, N
    torque_hysteresis: Array = _zeros(3)  # N m
    cable_stiffness: float = 0.0  # N/m, of a spring from the first place of the flange, alike in all directions
    cable_torsion: float = 0.0  # N m/rad, of a spring from its first orientation, alike about all axes
    R_ES: Array = field(default_factory=lambda: np.eye(3))
    sensor_position: Array = _zeros(3)  # p_ES, m
    gravity_tilt: Array = _zeros(2)  # rotation of gravity about two horizontal axes of W, rad
    wrench_delay: float = 0.0  # s, of the wrench's times relative to those of the pose
    R_EI: Array = field(default_factory=lambda: np.eye(3))
    imu_position: Array = _zeros(3)  # p_EI, m
    acceleration_bias: Array = _zeros(3)  # in I, m/s^2
    rate_bias: Array = _zeros(3)  # in I, rad/s
    imu_delay: float = 0.0  # s

    def plus(self, blocks: list[Block], increment: Array) -> WristParameters:
        """With an increment of the named blocks, (sum of their sizes,); a rotation is R_ES exp(increment), so that
        its increment is in the sensor's own axes."""
        changed, first = {}, 0
        for block in blocks:
            step = increment[first : first + block.size]
            first += block.size
            if block.name in ROTATIONS:
                name = ROTATIONS[block.name]
                changed[name] = getattr(self, name) @ exp_rotation(step)
            else:
                before = getattr(self, block.name)
                changed[block.name] = before + (step[0] if np.isscalar(before) else step)
        return replace(self, **changed)

    @property
    def center_of_mass(self) -> Array:
        """p_S_com, m; zero without mass."""
        return self.moment / self.mass if self.mass > 0 else np.zeros(3)


def point_inertia(mass: float, moment: Array) -> Array:
    """Inertia about S of a point mass at the centre of mass, the default of `payload.inertia`; as WristParameters."""
    if mass <= 0:
        return np.zeros(6)
    m = (moment @ moment * np.eye(3) - np.outer(moment, moment)) / mass
    return np.array([m[0, 0], m[0, 1], m[0, 2], m[1, 1], m[1, 2], m[2, 2]])
