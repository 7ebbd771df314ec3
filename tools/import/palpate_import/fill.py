"""The messages of a stream from the rows of its table."""

from __future__ import annotations

from typing import Any, Callable

import numpy as np
from numpy.typing import NDArray

from palpate_common.input_error import InputError
from palpate_import.fields import FINGERTIPS, MOST_POINTS
from palpate_import.layouts import empty_messages
from palpate_import.pose_forms import check_quaternions
from palpate_import.streams import POSE_FIELDS, Stream

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
ELECTRODES, PAC_SLOTS = 19, 22
VALID_ELECTRODES, VALID_PAC, VALID_PDC, VALID_TEMPERATURE = 1, 2, 4, 8


def _joint_count(stream: Stream, prefix: str, most: int) -> int:
    return max((i for i in range(1, most + 1) if stream.has(f"{prefix}{i}")), default=0)


def _numbered(stream: Stream, prefix: str, first: int, count: int) -> Floats:
    return stream.numbers(*(f"{prefix}{i}" for i in range(first, first + count)))


def _force_torque(stream: Stream, to: NDArray[Any]) -> None:
    wrench = stream.numbers("fx", "fy", "fz", "tx", "ty", "tz")
    if stream.pose is not None:
        R = stream.pose.poses(stream.table, stream.table, stream.table.place).R()
        wrench = np.einsum("nji,nkj->nki", R, wrench.reshape(-1, 2, 3)).reshape(-1, 6)
    to["wrench"] = wrench


def _imu(stream: Stream, to: NDArray[Any]) -> None:
    to["acceleration"] = stream.numbers("ax", "ay", "az")
    to["angular_velocity"] = stream.numbers("wx", "wy", "wz")


def _robot_state(stream: Stream, to: NDArray[Any]) -> None:
    count = max(1, _joint_count(stream, "q", 16))
    to["joint_count"] = count
    for name in ("q", "dq", "tau"):
        to[name] = _numbered(stream, name, 1, 16)
    twist = stream.numbers("vx", "vy", "vz", "wx", "wy", "wz")
    if stream.pose is None:
        pose = stream.numbers(*POSE_FIELDS)
        check_quaternions(pose[:, 3:], stream.table.place)
        to["position"], to["quaternion"] = pose[:, :3], pose[:, 3:]
    else:
        poses = stream.pose.poses(stream.table, stream.table, stream.table.place)
        to["position"], to["quaternion"] = poses.position, poses.wxyz()
        if not any(stream.has(name) for name in ("vx", "vy", "vz", "wx", "wy", "wz")):
            twist = twist if poses.velocity is None else poses.velocity
        elif poses.offset is not None:  # from what is recorded to the flange's origin
            twist[:, :3] += np.cross(twist[:, 3:], poses.offset)
    to["twist"] = twist


def _counts(stream: Stream, name: str) -> Floats:
    values = stream.number(name)
    values = np.sign(values) * np.floor(np.abs(values) + 0.5)
    wrong = np.flatnonzero((values < -(1 << 15)) | (values >= 1 << 15))
    if wrong.size:
        raise InputError(
            f"{stream.table.place(wrong[0])}:{stream.values[name].column}: {values[wrong[0]]:g} does not fit 16 bits"
        )
    return values


def _biotac(stream: Stream, to: NDArray[Any]) -> None:
    electrodes = [f"e{i}" for i in range(1, ELECTRODES + 1)]
    if len({stream.has(name) for name in electrodes}) > 1:
        raise InputError(f"{stream.description.channel}: a biotac needs all of e1 to e19, or none")
    if not stream.values:
        raise InputError(f"{stream.description.channel}: none of the columns is a biotac's (e1 to e19, pac0, pdc, ...)")
    to["valid"] = (VALID_ELECTRODES * stream.has("e1") + VALID_PAC * stream.has("pac0") + VALID_PDC * stream.has("pdc")
                   + VALID_TEMPERATURE * (stream.has("tac") and stream.has("tdc")))  # fmt: skip
    for i, name in enumerate(electrodes):
        to["electrodes"][:, i] = _counts(stream, name)
    slots = next((i for i in range(PAC_SLOTS) if not stream.has(f"pac{i}")), PAC_SLOTS)
    to["pac_count"] = slots
    for i in range(slots):
        to["pac"][:, i] = _counts(stream, f"pac{i}")
    for name in ("pdc", "tac", "tdc"):
        to[name] = _counts(stream, name)


def _hand_state(stream: Stream, to: NDArray[Any]) -> None:
    table = stream.table
    grasp = stream.number("grasp")
    wrong = np.flatnonzero(~np.isin(grasp, (0, 1, 2)))
    if wrong.size:
        raise InputError(f"{table.place(wrong[0])}: grasp: {grasp[wrong[0]]:g}; allowed: 0, 1, 2")
    to["grasp"] = grasp
    to["joint_count"] = _joint_count(stream, "q", 32)
    to["q"] = _numbered(stream, "q", 1, 32)
    to["fingertip_quaternion"][:, :, 0] = 1
    forms = stream.description.fingertips
    count = len(forms)
    for i, form in enumerate(forms):
        poses = form.poses(table, table, table.place)
        to["fingertip_position"][:, i], to["fingertip_quaternion"][:, i] = poses.position, poses.wxyz()
    for i in range(FINGERTIPS):
        names = [f"f{i}{name}" for name in POSE_FIELDS]
        given = [name for name in names if stream.has(name)]
        if not given:
            continue
        lacking = next((name for name in names if name not in given), None)
        if lacking is not None or i != count or forms:
            what = f"fingertip {i} has no {lacking}" if lacking else f"fingertip {i} is given, but {count} not" if not forms else \
                f"{given[0]} is given in addition to the key fingertips"  # fmt: skip
            raise InputError(f"{stream.description.channel}: {what}; allowed: position and quaternion of each in turn, from 0")
        pose = stream.numbers(*names)
        check_quaternions(pose[:, 3:], table.place)
        to["fingertip_position"][:, i], to["fingertip_quaternion"][:, i] = pose[:, :3], pose[:, 3:]
        count += 1
    to["fingertip_count"] = count


FILL: dict[str, Callable[[Stream, NDArray[Any]], None]] = {
    "force_torque": _force_torque, "imu": _imu, "robot_state": _robot_state, "biotac": _biotac, "hand_state": _hand_state,
}  # fmt: skip


def messages_of(stream: Stream, utimes: Integers) -> tuple[NDArray[Any], Integers]:
    """Messages without head, and the row that each begins in. utimes: (rows,), us. Raises InputError."""
    if stream.description.format == "shape_observation":
        return _observations(stream, utimes)
    made = empty_messages(stream.description.format, len(utimes))
    FILL[stream.description.format](stream, made)
    return made, np.arange(len(utimes))


def _observations(stream: Stream, utimes: Integers) -> tuple[NDArray[Any], Integers]:
    numbers = stream.markers()
    if numbers:
        points = np.stack([stream.numbers(*(f"{axis}{i}" for i in numbers)) for axis in "xyz"], axis=2)
        begins = np.arange(len(utimes))
        seen = [row[np.isfinite(row).all(axis=1)] for row in points]
    else:
        begins = np.flatnonzero(np.diff(utimes, prepend=utimes[:1] - 1) != 0)
        seen = np.split(stream.numbers("x", "y", "z"), begins[1:])
    made = empty_messages("shape_observation", len(begins))
    deviation = stream.number("deviation")[begins]
    wrong = np.flatnonzero(deviation <= 0)
    if wrong.size:
        raise InputError(f"{stream.table.place(begins[wrong[0]])}: deviation: {deviation[wrong[0]]:g} m; allowed: above 0")
    made["deviation"] = deviation
    for i, points_of_one in enumerate(seen):
        if len(points_of_one) > MOST_POINTS:
            raise InputError(f"{stream.table.place(begins[i])}: {len(points_of_one)} points of one time; allowed: at most {MOST_POINTS}; "
                             "palpate-see thins clouds")  # fmt: skip
        made["count"][i] = len(points_of_one)
        made["points"][i, : len(points_of_one)] = points_of_one
    return made, begins
