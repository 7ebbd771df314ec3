"""Messages as rows of a numpy array whose bytes are those that LCM sends."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate_common import palpate_package

# After fingerprint, utime, seq and session; big-endian. As lcmtypes/*.lcm; a test compares each with the generated encoder.
_FIELDS: dict[str, list[Any]] = {
    "ft_wrench_t": [("wrench", ">f8", 6)],
    "imu_t": [("acceleration", ">f8", 3), ("angular_velocity", ">f8", 3)],
    "robot_state_t": [("joint_count", ">i4"), ("q", ">f8", 16), ("dq", ">f8", 16), ("tau", ">f8", 16), ("position", ">f8", 3),
                      ("quaternion", ">f8", 4), ("twist", ">f8", 6)],
    "biotac_t": [("valid", ">i4"), ("electrodes", ">i2", 19), ("pac_count", ">i2"), ("pac", ">i2", 22), ("pdc", ">i2"),
                 ("tac", ">i2"), ("tdc", ">i2")],
    "hand_state_t": [("grasp", ">i4"), ("fingertip_count", ">i4"), ("fingertip_position", ">f8", (5, 3)),
                     ("fingertip_quaternion", ">f8", (5, 4)), ("joint_count", ">i4"), ("q", ">f8", 32)],
    "shape_observation_t": [("count", ">i4"), ("deviation", ">f8"), ("points", ">f4", (256, 3))],
}  # fmt: skip
TYPES = {"force_torque": "ft_wrench_t", "imu": "imu_t", "robot_state": "robot_state_t", "biotac": "biotac_t",
         "hand_state": "hand_state_t", "shape_observation": "shape_observation_t"}  # fmt: skip


def empty_messages(format_name: str, count: int) -> NDArray[Any]:
    """(count,) structured, zero but for the fingerprint. Raises InputError without the package palpate."""
    name = TYPES[format_name]
    kind = getattr(palpate_package.load().messages, name)
    dtype = np.dtype([("fingerprint", "V8"), ("utime", ">i8"), ("seq", ">i4"), ("session", ">i8"), *_FIELDS[name]])
    if len(kind().encode()) != dtype.itemsize:
        raise RuntimeError(f"{name}: {dtype.itemsize} bytes, but the type has {len(kind().encode())}")
    made = np.zeros(count, dtype)
    made["fingerprint"] = np.void(kind._get_packed_fingerprint())
    return made


def encoded(messages: NDArray[Any]) -> list[bytes]:
    """Of each message."""
    data, size = messages.tobytes(), messages.dtype.itemsize
    return [data[at : at + size] for at in range(0, len(data), size)]
