"""Message type of each channel, and conversion of bytes to messages and texts."""

from __future__ import annotations

import re
import struct
from typing import Any, Protocol, Type

from palpate import messages


class Message(Protocol):
    """Header of all messages: us by the sender's clock, a sequence number, the sender's
    session.
    """

    utime: int
    seq: int
    session: int

    def encode(self) -> bytes: ...


class DecodeError(ValueError):
    """Bytes that do not decode as the type of their channel."""


_TYPES: dict[str, Type[Any]] = {
    "BIOTAC": messages.biotac_t,
    "COMPONENT_COMMAND": messages.component_command_t,
    "COMPONENT_EVENT": messages.component_event_t,
    "CONFIG": messages.config_t,
    "CONTACTS": messages.contacts_t,
    "ESTIMATE": messages.estimate_t,
    "FEATURE": messages.feature_t,
    "FT_WRENCH": messages.ft_wrench_t,
    "HAND_COMMAND": messages.hand_command_t,
    "HAND_STATE": messages.hand_state_t,
    "HEALTH": messages.health_t,
    "IMU": messages.imu_t,
    "JOINT_VELOCITY_COMMAND": messages.joint_velocity_command_t,
    "MANUAL_FORCE": messages.manual_force_t,
    "PICTURE": messages.picture_t,
    "ROBOT_STATE": messages.robot_state_t,
    "SHAPE": messages.shape_t,
    "SHAPE_MESH": messages.shape_mesh_t,
    "SHAPE_OBSERVATION": messages.shape_observation_t,
    "SHAPE_TARGET": messages.shape_target_t,
    "SIM_TICK": messages.sim_tick_t,
    "TICK_DONE": messages.tick_done_t,
    "TRUTH_CONTACT": messages.truth_contact_t,
    "TRUTH_MESH": messages.shape_mesh_t,
    "TRUTH_SHAPE": messages.shape_t,
    "TRUTH_TOUCH": messages.truth_touch_t,
    "TWIST_COMMAND": messages.twist_command_t,
    "UNKNOWN_CONTACT": messages.unknown_contact_t,
}


def channel_names() -> list[str]:
    """Every channel without its number: BIOTAC stands for BIOTAC_0 to BIOTAC_4."""
    return sorted(_TYPES)


def type_of(channel: str) -> Type[Any] | None:
    """The message type of a channel, also of a second arm ("_1"); None if it is unknown."""
    if channel in _TYPES:
        return _TYPES[channel]
    return _TYPES.get(re.sub(r"_\d+$", "", channel))


def decode(channel: str, data: bytes) -> Any:
    """The message in `data`. Raises DecodeError if it is not of the channel's type."""
    kind = type_of(channel)
    if kind is None:
        raise DecodeError(f"{channel}: is not a channel of palpate")
    try:
        return kind.decode(data)
    except (ValueError, struct.error) as error:
        raise DecodeError(f"{channel}: {len(data)} bytes are not a {kind.__name__}") from error


def text_of(field: bytes) -> str:
    """The text of a byte field, which ends at its first zero."""
    return bytes(field).split(b"\0", 1)[0].decode(errors="replace")


def field_of(text: str, size: int, name: str = "text") -> bytes:
    """A byte field of `size` that holds `text` and at least one zero. Raises ValueError."""
    data = text.encode()
    if len(data) >= size:
        raise ValueError(f"{name} has {len(data)} bytes; at most {size - 1} fit a message")
    return data.ljust(size, b"\0")
