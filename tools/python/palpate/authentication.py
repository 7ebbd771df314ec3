"""Counters and authentication codes of command messages, as in tools/command/README.md."""

from __future__ import annotations

import hmac
import os
import stat
import time
from pathlib import Path
from typing import Any, Optional, Union

KEY_SIZE = CODE_SIZE = 32


def read_key_file(path: Union[str, "os.PathLike[str]"]) -> bytes:
    """A key of 32 bytes or 64 hexadecimal digits in a file that only its owner can access.
    Raises ValueError with file and remedy, OSError if the file cannot be read."""
    file = Path(path)
    with open(file, "rb") as opened:
        mode = os.fstat(opened.fileno()).st_mode
        if not stat.S_ISREG(mode):
            raise ValueError(f"key file {file}: is not a file")
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
    """Fills `authentication` with the code of everything else in the message and of the
    channel: the first 32 bytes of HMAC-SHA-512."""
    message.authentication = bytes(CODE_SIZE)
    code = hmac.new(key, channel.encode("ascii") + b"\0" + message.encode(), "sha512")
    message.authentication = code.digest()[:CODE_SIZE]


def verify(key: bytes, channel: str, message: Any) -> bool:
    """Whether the message was signed with the key for this channel. Leaves it unchanged."""
    given = bytes(message.authentication)
    seal(key, channel, message)
    expected, message.authentication = message.authentication, given
    return hmac.compare_digest(given, expected)


class Sealer:
    """Counts and, with a key, signs the messages of one outgoing channel. Counters are
    wall-clock microseconds, strictly increasing, so that they increase across sessions."""

    def __init__(self, channel: str, key: Optional[bytes] = None) -> None:
        self._channel, self._key, self._counter = channel, key, 0

    def put(self, message: Any) -> int:
        """Call after everything else in the message is final; returns the counter."""
        self._counter = max(self._counter + 1, wall_clock_us())
        message.counter = self._counter
        message.authentication = bytes(CODE_SIZE)
        if self._key is not None:
            seal(self._key, self._channel, message)
        return self._counter
