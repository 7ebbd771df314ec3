"""Message type of each channel, and conversion of bytes to messages and texts."""

from __future__ import annotations

import re
import struct
from typing import Any, Dict, Mapping, Protocol, Type

from palpate.channel_table import CHANNELS


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


def channel_names() -> list[str]:
    """Every channel without its number: BIOTAC stands for BIOTAC_0 to BIOTAC_4."""
    return sorted(CHANNELS)


def check_renamed(names: Mapping[str, str]) -> Dict[str, str]:
    """A copy of palpate's own names of channels and their names on a bus, as the key
    bus.channels of a configuration. Raises ValueError for an unknown channel, an impossible name
    and one that is not unique."""
    for own, name in names.items():
        if type_of(own) is None:
            raise ValueError(f"{own}: is not a channel of palpate; see palpate.channel_names()")
        if not re.fullmatch(r"[A-Z0-9_]{1,63}", name):
            raise ValueError(f"{own}: {name}; allowed: 1 to 63 of the characters A-Z, 0-9 and _")
        others = [other for other in names if other != own and names[other] == name]
        if others or (name != own and name not in names and type_of(name) is not None):
            raise ValueError(f"{own}: {name} is the name of {(others or [name])[0]} as well")
    return dict(names)


def type_of(channel: str) -> Type[Any] | None:
    """The message type of a channel, also of a second arm ("_1"); None if it is unknown."""
    entry = CHANNELS.get(channel)
    if entry is None:
        entry = CHANNELS.get(re.sub(r"_\d+$", "", channel))
        if entry is not None and not entry.number:
            entry = None
    return entry.type if entry is not None else None


def decode(channel: str, data: bytes) -> Any:
    """The message in `data`; one of a former type of the channel is converted. Raises DecodeError
    if it is not of the channel's type."""
    kind = type_of(channel)
    if kind is None:
        raise DecodeError(f"{channel}: is not a channel of palpate")
    try:
        for former in _former_types(channel):
            if data[:8] == former._get_packed_fingerprint():
                return _converted(former.decode(data), kind)
        return kind.decode(data)
    except (ValueError, struct.error) as error:
        raise DecodeError(f"{channel}: {len(data)} bytes are not a {kind.__name__}") from error


# Names of fields in former types.
_FORMER_NAMES = {
    ("health_v1_t", "gate_rejected"): "gate_refused",
    ("health_v1_t", "commands_rejected"): "commands_refused",
    ("shape_mesh_v1_t", "node_count"): "corner_count",
}


def _former_types(channel: str) -> tuple[Type[Any], ...]:
    entry = CHANNELS.get(channel) or CHANNELS.get(re.sub(r"_\d+$", "", channel))
    return entry.former if entry is not None else ()


def _converted(former: Any, kind: Type[Any]) -> Any:
    """Former shapes and meshes hold corner nodes only; a former shape is one chunk."""
    message, version = kind(), type(former).__name__
    for name in kind.__slots__:
        source = _FORMER_NAMES.get((version, name), name)
        if hasattr(former, source):
            setattr(message, name, getattr(former, source))
    if version == "shape_v1_t":
        message.chunks = 1
    return message


def text_of(field: bytes) -> str:
    """The text of a byte field, which ends at its first zero."""
    return bytes(field).split(b"\0", 1)[0].decode(errors="replace")


def field_of(text: str, size: int, name: str = "text") -> bytes:
    """A byte field of `size` that holds `text` and at least one zero. Raises ValueError."""
    data = text.encode()
    if len(data) >= size:
        raise ValueError(f"{name} has {len(data)} bytes; at most {size - 1} fit a message")
    return data.ljust(size, b"\0")
