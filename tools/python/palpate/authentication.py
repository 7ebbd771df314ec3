"""Counters and authentication codes of messages that command, as in tools/command/README.md."""

from __future__ import annotations

import hmac
import os
import stat
import time
from pathlib import Path
from typing import Any, Optional, Union

KEY_SIZE = CODE_SIZE = 32


def read_key_file(path: Union[str, "os.PathLike[str]"]) -> bytes:
    """A key of 32 bytes or 64 hexadecimal digits, that nobody but its owner has access to. Raises
    ValueError with file and remedy, OSError where the file cannot be read."""
    file = Path(path)
    with open(file, "rb") as opened:
        mode = os.fstat(opened.fileno()).st_mode
        if not stat.S_ISREG(mode):
            raise ValueError(f"key file {file}: is no file")
        if mode & 0o077:
            raise ValueError(
                f"key file {file}: others than its owner have access to it; chmod 600 {file}"
            )
        data = opened.read(2 * KEY_SIZE + 3)
    if len(data) == KEY_SIZE:
        return data
    try:
        key = bytes.fromhex(data.decode("ascii").rstrip())
    except ValueError:
        key = b""
    if len(key) != KEY_SIZE or len(data.rstrip()) != 2 * KEY_SIZE:
        raise ValueError(
            f"key file {file}: must hold 32 bytes or 64 hexadecimal digits; "
            "palpate-command --make-key makes one"
        )
    return key


def wall_clock_us() -> int:
    """us since the epoch."""
    return time.time_ns() // 1000


def seal(key: bytes, channel: str, message: Any) -> None:
    """Fills `authentication` with the code of everything else in the message and of the channel:
    HMAC-SHA-512, its first 32 bytes."""
    message.authentication = bytes(CODE_SIZE)
    code = hmac.new(key, channel.encode("ascii") + b"\0" + message.encode(), "sha512")
    message.authentication = code.digest()[:CODE_SIZE]


def verify(key: bytes, channel: str, message: Any) -> bool:
    """Whether somebody who knows the key sealed this message for this channel. Leaves it as it
    is."""
    given = bytes(message.authentication)
    seal(key, channel, message)
    expected, message.authentication = message.authentication, given
    return hmac.compare_digest(given, expected)


class Sealer:
    """Counts and, where there is a key, seals the messages of one outgoing channel. Counters are
    wall-clock microseconds that never stand still, so that they count up over sessions."""

    def __init__(self, channel: str, key: Optional[bytes] = None) -> None:
        self._channel, self._key, self._counter = channel, key, 0

    def put(self, message: Any) -> int:
        """After everything else in the message is as it will be sent; returns the counter."""
        self._counter = max(self._counter + 1, wall_clock_us())
        message.counter = self._counter
        message.authentication = bytes(CODE_SIZE)
        if self._key is not None:
            seal(self._key, self._channel, message)
        return self._counter
