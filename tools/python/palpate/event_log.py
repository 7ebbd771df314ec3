"""LCM's event log (.log), as lcm-logger writes it: a sequence of events, each consisting of
the word 0xEDA1DA01 (4 bytes), number (8), time in us (8), lengths of channel and data (4
each), all in network order, then channel and data.
"""

from __future__ import annotations

import mmap
import os
import struct
from pathlib import Path
from typing import BinaryIO, Iterator, NamedTuple, Union

from palpate.closing import Closing

SYNC = b"\xed\xa1\xda\x01"
_HEADER = struct.Struct(">4sqqii")
LONGEST_CHANNEL = 63
LARGEST_DATA = 64 << 20


class Event(NamedTuple):
    """One message of a log, and when it was received: us by the recorder's clock."""

    number: int
    utime: int
    channel: str
    data: bytes


class Damage(NamedTuple):
    """Damaged parts of a log: bytes, number of places, and whether its end is truncated."""

    skipped: int
    places: int
    cut_short: bool


class EventLog:
    """The events of a file in order, from the start at each iteration. Damaged parts are
    skipped and reported by `damage`. Raises OSError if the file cannot be read, ValueError if
    it holds bytes but no event."""

    def __init__(self, path: Union[str, "os.PathLike[str]"]) -> None:
        self.path = Path(path)
        self.damage = Damage(0, 0, False)

    def __iter__(self) -> Iterator[Event]:
        with open(self.path, "rb") as file:
            if os.fstat(file.fileno()).st_size == 0:
                return
            with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
                yield from self._events(data)

    def _events(self, data: mmap.mmap) -> Iterator[Event]:
        size, at, skipped, places, count = len(data), 0, 0, 0, 0
        cut_short = False
        while at < size:
            event, end = self._event_at(data, at)
            if event is not None:
                yield event
                at, count = end, count + 1
                continue
            if end > size and data[at : at + 4] == SYNC[: size - at]:
                cut_short = True  # unless an event begins within
            found = data.find(SYNC, at + 1)
            while found >= 0 and self._event_at(data, found)[0] is None:
                found = data.find(SYNC, found + 1)
            if found < 0:
                if not cut_short:
                    skipped, places = skipped + size - at, places + 1
                break
            cut_short = False
            skipped, places, at = skipped + found - at, places + 1, found
        self.damage = Damage(skipped, places, cut_short)
        if count == 0:
            raise ValueError(f"{self.path}: is no LCM event log: no event in {size} bytes")

    @staticmethod
    def _event_at(data: mmap.mmap, at: int) -> tuple[Event | None, int]:
        """The event that begins there, and its end; beyond the file if it is truncated."""
        if len(data) - at < _HEADER.size:
            return None, len(data) + 1
        sync, number, utime, name_size, data_size = _HEADER.unpack_from(data, at)
        if sync != SYNC or utime < 0 or not 1 <= name_size <= LONGEST_CHANNEL:
            return None, 0
        if not 0 <= data_size <= LARGEST_DATA:
            return None, 0
        name_at = at + _HEADER.size
        end = name_at + name_size + data_size
        # A wrong length is recognised by the absence of an event at its end.
        if end > len(data) or data[end : end + 4] != SYNC[: len(data) - end]:
            return None, end
        try:
            name = data[name_at : name_at + name_size].decode("ascii")
        except UnicodeDecodeError:
            return None, 0
        return Event(number, utime, name, data[name_at + name_size : end]), end


class EventLogWriter(Closing):
    """Writes a log that lcm-logplayer, palpate-replay and read_log can read. A context
    manager.
    """

    def __init__(self, path: Union[str, "os.PathLike[str]"]) -> None:
        self._file: BinaryIO = open(path, "wb")
        self._number = 0

    def write(self, utime: int, channel: str, data: bytes) -> None:
        """Appends an event that was received at `utime`, us. Raises ValueError."""
        name = channel.encode("ascii")
        if not 1 <= len(name) <= LONGEST_CHANNEL or len(data) > LARGEST_DATA:
            raise ValueError(f"channel {channel!r}, {len(data)} bytes: beyond what a log holds")
        header = _HEADER.pack(SYNC, self._number, utime, len(name), len(data))
        self._file.write(header + name + data)
        self._number += 1

    def close(self) -> None:
        self._file.close()
