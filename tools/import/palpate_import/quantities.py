"""Named quantities of a channel over time, which other sensors measure, too."""

from __future__ import annotations

from typing import Optional

import numpy as np
from numpy.typing import NDArray

from palpate_common.input_error import WRONG_CONFIGURATION, InputError
from palpate_common.rotations import from_wxyz
from palpate_import.recording import Channel

Floats = NDArray[np.float64]
# Of each format: magnitudes, which do not depend on frames, and single numbers.
MAGNITUDES: dict[str, dict[str, tuple[str, slice]]] = {
    "force_torque": {"force": ("wrench", slice(0, 3)), "torque": ("wrench", slice(3, 6))},
    "imu": {"acceleration": ("acceleration", slice(0, 3)), "angular_speed": ("angular_velocity", slice(0, 3))},
    "robot_state": {
        "speed": ("twist", slice(0, 3)),
        "angular_speed": ("twist", slice(3, 6)),
        "joint_speed": ("dq", slice(0, 16)),
    },
}
_AXES = "xyz"
NUMBERS: dict[str, dict[str, tuple[str, Optional[int]]]] = {
    "force_torque": {f"{kind}{axis}": ("wrench", 3 * k + i) for k, kind in enumerate("ft") for i, axis in enumerate(_AXES)},
    "imu": {f"{kind}{axis}": (name, i) for kind, name in (("a", "acceleration"), ("w", "angular_velocity"))
            for i, axis in enumerate(_AXES)},
    "robot_state": {**{f"p{axis}": ("position", i) for i, axis in enumerate(_AXES)},
                    **{f"{kind}{axis}": ("twist", 3 * k + i) for k, kind in enumerate("vw") for i, axis in enumerate(_AXES)},
                    **{f"{name}{i + 1}": (name, i) for name in ("q", "dq", "tau") for i in range(16)}},
    "biotac": {**{f"e{i + 1}": ("electrodes", i) for i in range(19)},
               "pdc": ("pdc", None), "tac": ("tac", None), "tdc": ("tdc", None)},
    "hand_state": {f"q{i + 1}": ("q", i) for i in range(32)},
}  # fmt: skip


def _names(of: Channel) -> list[str]:
    return [*MAGNITUDES.get(of.format, {}), *NUMBERS.get(of.format, {})]


def values_of(channel: Channel, name: str) -> Floats:
    """(messages,), SI. The speeds of a robot without a twist are those of its pose. Raises InputError listing the quantities."""
    if name in NUMBERS.get(channel.format, {}):
        field, index = NUMBERS[channel.format][name]
        return np.array(channel.messages[field][:, index] if index is not None else channel.messages[field], float)
    if name not in MAGNITUDES.get(channel.format, {}):
        raise InputError(f"quantity '{channel.name}.{name}'; allowed: {', '.join(_names(channel)) or 'none of this format'}",
                         WRONG_CONFIGURATION)  # fmt: skip
    field, part = MAGNITUDES[channel.format][name]
    vectors = np.array(channel.messages[field][:, part], float)
    if channel.format == "robot_state" and field == "twist" and not np.any(channel.messages["twist"]):
        return _speed_of_pose(channel, name)
    return np.asarray(np.linalg.norm(vectors, axis=1))


def _speed_of_pose(channel: Channel, name: str) -> Floats:
    """Central differences of the pose."""
    time = channel.utimes * 1e-6
    if len(time) < 3:
        return np.zeros(len(time))
    before, after = np.maximum(np.arange(len(time)) - 1, 0), np.minimum(np.arange(len(time)) + 1, len(time) - 1)
    step = np.maximum(time[after] - time[before], 1e-6)
    if name == "speed":
        position = np.array(channel.messages["position"], float)
        return np.asarray(np.linalg.norm(position[after] - position[before], axis=1) / step)
    R = from_wxyz(np.array(channel.messages["quaternion"], float))
    turned = np.einsum("nji,njk->nik", R[before], R[after])
    sine = 0.5 * np.linalg.norm(np.stack([turned[:, 2, 1] - turned[:, 1, 2], turned[:, 0, 2] - turned[:, 2, 0],
                                          turned[:, 1, 0] - turned[:, 0, 1]]), axis=0)  # fmt: skip
    return np.asarray(np.arctan2(sine, 0.5 * (np.trace(turned, axis1=1, axis2=2) - 1)) / step)
