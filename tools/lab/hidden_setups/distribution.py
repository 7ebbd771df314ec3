"""Distributions of what a user does not know of a set-up, as setup.yaml states them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from palpate_common.section import Section, read_section

Floats = NDArray[np.float64]
Range = tuple[float, float]
FOLDER = Path(__file__).resolve().parent


@dataclass(frozen=True, eq=False)
class SensorErrors:
    """bias: largest of the axes of the first and of the second three signals. angle: largest, rad. stamp_delay: range, s."""

    bias: Range
    angle: float
    stamp_delay: Range


@dataclass(frozen=True, eq=False)
class Distribution:
    """Lengths in m, masses in kg, angles in rad, times in s; see setup.yaml."""

    name: str
    hand_mass_factor: Range
    load_mass: Range
    load_center: tuple[Floats, Floats]
    load_radius: Range
    force_torque: SensorErrors
    imu: SensorErrors
    object_position: float
    object_angle: float
    modulus_factor: float
    camera_distance: float
    camera_angle: float
    camera_stamp_delay: Range


def _range(section: Section, key: str, lower: float, upper: float) -> Range:
    low, high = section.numbers(key, 2, lower, upper)
    if low > high:
        section.fail(key, f"[{low:g}, {high:g}]; allowed: the smaller number first")
    return low, high


def _angle(section: Section) -> float:
    return float(np.radians(section.number("angle_deg", 0, 180)))


def _sensor(section: Section) -> SensorErrors:
    first, second = section.numbers("bias", 2, 0, 1000)
    made = SensorErrors((first, second), _angle(section), _range(section, "stamp_delay", 0, 1))
    section.check_unused()
    return made


def read_distribution(name: str) -> Distribution:
    """Of a file, or of `NAME.yaml` of this folder. Raises InputError."""
    named = FOLDER / f"{name}.yaml"
    path = named if named.is_file() else Path(name)
    top = read_section(path)
    payload, center = top.section("payload"), top.section("payload").section("center")
    of_object, camera = top.section("object"), top.section("camera")
    top.text("about", "")
    made = Distribution(
        path.stem,
        _range(payload, "hand_mass_factor", 0.05, 20),
        _range(payload, "mass", 1e-3, 50),
        (np.array(center.numbers("lower", 3, -1, 1)), np.array(center.numbers("upper", 3, -1, 1))),
        _range(payload, "radius", 1e-3, 1),
        _sensor(top.section("force_torque")),
        _sensor(top.section("imu")),
        of_object.number("position", 0, 10),
        _angle(of_object),
        of_object.number("modulus_factor", 1, 1000),
        camera.number("distance", 0, 10),
        _angle(camera),
        _range(camera, "stamp_delay", 0, 1),
    )
    if (made.load_center[0] > made.load_center[1]).any():
        center.fail("lower", f"{made.load_center[0].tolist()}; allowed: up to upper, {made.load_center[1].tolist()}")
    payload.section("center")  # is a known key
    for section in (top, payload, center, of_object, camera):
        section.check_unused()
    return made
