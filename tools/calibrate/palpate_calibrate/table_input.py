"""Recordings from CSV files, which a YAML description explains; see tools/calibrate/README.md."""

from __future__ import annotations

import csv
import gzip
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Optional

import numpy as np

from palpate_calibrate.recording import Mounting, Recording, Stream
from palpate_common.input_error import InputError
from palpate_common.rotations import Array, exp_rotation, from_rpy, from_wxyz
from palpate_common.section import Section

TIME_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
ACCELERATION_UNITS = {"m/s^2": 1.0, "g": 9.80665}
ANGLE_UNITS = {"rad": 1.0, "deg": np.pi / 180}


@dataclass
class Described:
    """A recording and what its description says about the set-up."""

    recording: Recording
    mounting: Mounting
    gravity_is_unknown: bool


class Table:
    """Columns of a CSV file (.csv or .csv.gz) with a header. Raises InputError with file, line and column."""

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            with (gzip.open(path, "rt") if path.suffix == ".gz" else open(path)) as file:
                rows = [row for row in csv.reader(file) if row]
        except (OSError, UnicodeDecodeError) as error:
            raise InputError(f"{path}: {error}") from error
        if len(rows) < 2:
            raise InputError(f"{path}: no rows below the header")
        self.names = [name.strip() for name in rows[0]]
        self.rows = rows[1:]

    def columns(self, names: list[str]) -> Array:
        """(rows, len(names))."""
        indices = []
        for name in names:
            if name not in self.names:
                raise InputError(f"{self.path}: no column {name}; it has: {', '.join(self.names)}")
            indices.append(self.names.index(name))
        out = np.empty((len(self.rows), len(names)))
        for i, row in enumerate(self.rows):
            for k, index in enumerate(indices):
                try:
                    out[i, k] = float(row[index])
                except (ValueError, IndexError) as error:
                    value = row[index] if index < len(row) else "nothing"
                    place = f"{self.path}, line {i + 2}, column {names[k]}"
                    raise InputError(f"{place}: {value}; allowed: a number") from error
        return out


def _joint_rotations(angles: Array, joints: list[Section]) -> Array:
    """Orientation of the last frame of a chain in modified Denavit-Hartenberg parameters (Craig), (n, 3, 3)."""
    x, _, z = np.eye(3)
    out = []
    for row in angles:
        rotation = np.eye(3)
        for angle, joint in zip(row, joints):
            turn = angle + joint.number("theta", -7, 7, 0.0)
            rotation = rotation @ exp_rotation(joint.number("alpha", -7, 7, 0.0) * x) @ exp_rotation(turn * z)
        out.append(rotation)
    return np.array(out)


def _rotations(table: Table, pose: Section) -> Array:
    """R_WE, (n, 3, 3), from one of the keys quaternion, rotation, joints."""
    given = [key for key in ("quaternion", "rotation", "joints") if pose.has(key)]
    if len(given) != 1:
        pose.fail("quaternion", f"{', '.join(given) or 'nothing'} is given; allowed: one of quaternion, rotation, joints")
    if given[0] == "quaternion":
        q = table.columns(pose.names("quaternion", 4))
        wrong = np.flatnonzero(np.abs(np.linalg.norm(q, axis=1) - 1) > 1e-2)
        if wrong.size:
            length = np.linalg.norm(q[wrong[0]])
            raise InputError(f"{table.path}, line {wrong[0] + 2}: a quaternion of length {length:.4g}; allowed: 1")
        return from_wxyz(q)
    if given[0] == "rotation":
        return table.columns(pose.names("rotation", 9)).reshape(-1, 3, 3)
    joints = pose.sections("joints")
    unit = ANGLE_UNITS[pose.choice("angle_unit", list(ANGLE_UNITS), "rad")]
    return _joint_rotations(unit * table.columns([joint.text("column") for joint in joints]), joints)


def _times(table: Table, section: Section) -> Optional[Array]:
    if not section.has("time"):
        return None
    unit = TIME_UNITS[section.choice("time_unit", list(TIME_UNITS), "s")]
    return np.asarray(unit * table.columns([section.text("time")])[:, 0])


def _vector(section: Section, key: str, default: Any) -> Array:
    return np.array(section.numbers(key, 3, -100, 100, default))


def read_description(section: Section, folder: Path) -> Described:
    """The recording that a description explains, files relative to `folder`. Raises InputError."""
    name = section.text("name", folder.name)
    gravity = _vector(section, "gravity", [0, 0, -9.81])
    pose, wrench = section.section("pose"), section.section("wrench")
    table = Table(folder / pose.text("file"))
    rotations = _rotations(table, pose)
    positions = table.columns(pose.names("position", 3)) if pose.has("position") else np.zeros((len(rotations), 3))
    times = _times(table, pose)
    at_rest = times is None
    if not at_rest and not pose.has("position"):
        pose.fail("position", "is absent; required for poses in motion, whose acceleration is a part of the wrench")
    if times is None:
        times = np.arange(len(rotations), dtype=float)
    origin = times[0]
    recording_pose = Stream("pose", times - origin, np.hstack([positions, rotations.reshape(-1, 9)]))

    def stream(of: Section, names: list[str], what: str) -> Stream:
        source = Table(folder / of.text("file")) if of.has("file") else table
        own = _times(source, of) if of.has("time") else times if source is table else None
        values = source.columns(names)
        if at_rest:
            own = np.arange(len(values), dtype=float)
            if len(values) != len(rotations):
                of.fail("file", f"{len(values)} rows for {len(rotations)} poses; allowed: as many")
        elif own is None:
            of.fail("time", "is absent; required, as the poses have a time")
        return Stream(what, own - (0.0 if at_rest else origin), values)

    readings = stream(wrench, wrench.names("force", 3) + wrench.names("torque", 3), "wrench")
    if wrench.choice("axes", ["sensor", "base"], "sensor") == "base":
        if not at_rest:
            wrench.fail("axes", "base; allowed for poses in motion: sensor")
        parts = readings.values.reshape(-1, 2, 3)
        readings = Stream("wrench", readings.time, np.einsum("nji,nkj->nki", rotations, parts).reshape(-1, 6))
    recording = Recording(name, recording_pose, readings, gravity=gravity, at_rest=at_rest)
    if section.has("acceleration"):
        of = section.section("acceleration")
        unit = ACCELERATION_UNITS[of.choice("unit", list(ACCELERATION_UNITS), "m/s^2")]
        recording.acceleration = stream(of, of.names("columns", 3), "acceleration")
        recording.acceleration.values *= unit
        if of.flag("gravity_removed", False):
            near = np.clip(np.searchsorted(recording_pose.time, recording.acceleration.time), 0, len(rotations) - 1)
            recording.acceleration.values -= np.einsum("nji,j->ni", rotations[near], gravity)
    if section.has("angular_velocity"):
        of = section.section("angular_velocity")
        recording.angular_velocity = stream(of, of.names("columns", 3), "angular velocity")
        recording.angular_velocity.values *= ANGLE_UNITS[of.choice("unit", list(ANGLE_UNITS), "rad")]
    # Places that no drawing states.
    mounting = Mounting(sensor_position_deviation=0.1, imu_position_deviation=0.1)
    if section.has("sensor_in_flange"):
        of = section.section("sensor_in_flange")
        mounting.sensor_rotation = from_rpy(np.radians(of.numbers("rpy_deg", 3, -360, 360, [0, 0, 0])))
        mounting.sensor_position = _vector(of, "position", [0, 0, 0])
        if of.has("position"):
            mounting.sensor_position_deviation = Mounting.sensor_position_deviation
        mounting.sensor_rotation_is_exact = of.flag("exact", False)
        of.check_unused()
    described = Described(recording, mounting, section.flag("gravity_direction_is_unknown", False))
    for part in (section, pose, wrench):
        part.check_unused()
    return described
