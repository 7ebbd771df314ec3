"""Recorded LCM logs as numpy arrays."""

from __future__ import annotations

import os
from typing import Any, Iterator, Union

import numpy as np
from numpy.typing import NDArray

from palpate import messages
from palpate.channel_table import CHANNELS
from palpate.channels import decode, text_of, type_of
from palpate.event_log import Damage, Event, EventLog
from palpate.mesh import Mesh, MeshBuilder, ShapeBuilder

Path = Union[str, "os.PathLike[str]"]

# Channels of operators' commands, which are not in lock-step and use the wall clock.
_OF_USERS = tuple(name for name, entry in CHANNELS.items() if entry.sender == "user")


class Series:
    """All messages of one channel in the order of their times.

    A field of the message is an attribute: an array whose first axis is the message, in the units
    of lcmtypes/ (SI). `log["FT_WRENCH"].wrench` is (m, 6); texts are arrays of str. A field whose
    length changes between messages raises ValueError; use `messages` for those.
    """

    def __init__(self, channel: str, messages: list[Any], utimes: list[int], start: int) -> None:
        self.channel = channel
        self.messages = messages
        self.utime: NDArray[np.int64] = np.array(utimes, np.int64)  # us, by the log's clock
        self._start = start
        self._arrays: dict[str, NDArray[Any]] = {}

    def __len__(self) -> int:
        return len(self.messages)

    def __iter__(self) -> Iterator[Any]:
        return iter(self.messages)

    @property
    def time(self) -> NDArray[np.float64]:
        """s since the start of the log, (m,)."""
        return np.asarray((self.utime - self._start) * 1e-6)

    @property
    def sent_utime(self) -> NDArray[np.int64]:
        """us by the sender's clock, (m,)."""
        return self.array("utime")

    @property
    def positions(self) -> NDArray[np.float64]:
        """SHAPE, TRUTH_SHAPE: nodal positions in O, (m, nodes, 3), m. Raises ValueError if
        the mesh changes in the recording: then use of_mesh()."""
        if not self.messages or not hasattr(self.messages[0], "xyz"):
            raise AttributeError(f"{self.channel} has no positions")
        if len(set(self.array("mesh_hash").tolist())) > 1:
            raise ValueError(f"{self.channel}: the mesh changes; take of_mesh(hash).positions")
        return self.array("xyz").astype(np.float64).reshape(len(self), -1, 3)

    def of_mesh(self, mesh_hash: int) -> "Series":
        """The messages that refer to one mesh."""
        return self.where(self.array("mesh_hash") == mesh_hash)

    def where(self, mask: Any) -> "Series":
        """The messages selected by a mask, (m,)."""
        kept = np.flatnonzero(np.asarray(mask))
        picked = [self.messages[i] for i in kept]
        return Series(self.channel, picked, [int(self.utime[i]) for i in kept], self._start)

    def array(self, field: str) -> NDArray[Any]:
        """A field of every message; see the class."""
        if field not in self._arrays:
            kind = type_of(self.channel)
            known = () if kind is None else kind.__slots__
            if field not in known:
                raise AttributeError(f"{self.channel} has no field {field}; it has: "
                                     + ", ".join(known))  # fmt: skip
            self._arrays[field] = self._read(field)
        return self._arrays[field]

    def _read(self, field: str) -> NDArray[Any]:
        values = [getattr(message, field) for message in self.messages]
        if not values:
            return np.zeros(0)
        if isinstance(values[0], bytes):
            if field == "authentication":
                return np.array([np.frombuffer(value, np.uint8) for value in values])
            return np.array([text_of(value) for value in values])
        if isinstance(values[0], (list, tuple)) and values[0] and isinstance(values[0][0], bytes):
            return np.array([[text_of(item) for item in value] for value in values])
        lengths = {len(value) for value in values} if isinstance(values[0], (list, tuple)) else {0}
        if len(lengths) > 1:
            raise ValueError(f"{self.channel}.{field}: its length changes between messages")
        return np.array(values)

    def __getattr__(self, field: str) -> NDArray[Any]:
        if field.startswith("_"):
            raise AttributeError(field)
        return self.array(field)

    def __repr__(self) -> str:
        span = f", {self.time[0]:.3f} to {self.time[-1]:.3f} s" if len(self) else ""
        return f"<{self.channel}: {len(self)} messages{span}>"


class Log:
    """The contents of one or more files; made by read_log(). `log["SHAPE"]` is a Series."""

    def __init__(self, events: list[Event], damages: dict[str, Damage], clock: str) -> None:
        if clock not in ("received", "sent"):
            raise ValueError(f'clock "{clock}" is unknown; allowed: received, sent')
        self.clock = clock
        self.damages = damages  # by file, of those that have any
        self.undecodable: dict[str, int] = {}  # messages of another type than their channel's
        self.unknown: dict[str, int] = {}  # messages of channels that are not palpate's
        self._series: dict[str, tuple[list[Any], list[int]]] = {}
        self._shapes: dict[str, ShapeBuilder] = {}
        for event in events:
            self._add(event)
        starts = [
            min(utimes)
            for name, (_, utimes) in self._series.items()
            if clock == "received" or name not in _OF_USERS
        ]
        self.start_utime = min(starts, default=0)  # us, where time is 0
        self._made: dict[str, Series] = {}

    def _add(self, event: Event) -> None:
        if type_of(event.channel) is None:
            self.unknown[event.channel] = self.unknown.get(event.channel, 0) + 1
            return
        try:
            message = decode(event.channel, event.data)
            if isinstance(message, messages.shape_t):
                message = self._shapes.setdefault(event.channel, ShapeBuilder()).add(message)
                if message is None:
                    return
        except ValueError:
            self.undecodable[event.channel] = self.undecodable.get(event.channel, 0) + 1
            return
        of_channel, utimes = self._series.setdefault(event.channel, ([], []))
        of_channel.append(message)
        utimes.append(event.utime if self.clock == "received" else message.utime)

    @property
    def channels(self) -> list[str]:
        """Channels with messages in the log."""
        return sorted(self._series)

    def __contains__(self, channel: object) -> bool:
        return channel in self._series

    def __getitem__(self, channel: str) -> Series:
        """Raises KeyError, listing the channels, for a channel without messages."""
        if channel not in self._series:
            raise KeyError(f"no {channel} in the log; it has: {', '.join(self.channels)}")
        if channel not in self._made:
            of_channel, utimes = self._series[channel]
            order = np.argsort(np.array(utimes, np.int64), kind="stable")
            self._made[channel] = Series(
                channel, [of_channel[i] for i in order], [utimes[i] for i in order], self.start_utime
            )
        return self._made[channel]

    @property
    def duration(self) -> float:
        """s from the first message to the last one."""
        ends = [self[name].time[-1] for name in self.channels
                if self.clock == "received" or name not in _OF_USERS]  # fmt: skip
        return float(max(ends, default=0.0))

    def meshes(self, channel: str = "SHAPE_MESH") -> dict[int, Mesh]:
        """All complete meshes of the log, by hash. Channel TRUTH_MESH: the plant's."""
        builder = MeshBuilder()
        for chunk in self[channel].messages if channel in self else []:
            builder.add(chunk)
        return builder.meshes

    @property
    def mesh(self) -> Mesh:
        """The first mesh of the estimate. Raises ValueError if the log holds none."""
        return self._first_mesh("SHAPE_MESH")

    @property
    def truth_mesh(self) -> Mesh:
        """The simulator's mesh. Raises ValueError if the log holds none."""
        return self._first_mesh("TRUTH_MESH")

    def _first_mesh(self, channel: str) -> Mesh:
        for mesh in self.meshes(channel).values():
            return mesh
        raise ValueError(f"the log holds no complete {channel}")

    def __repr__(self) -> str:
        counts = ", ".join(f"{name}: {len(self._series[name][0])}" for name in self.channels)
        return f"<Log of {self.duration:.3f} s; {counts}>"


def read_log(*paths: Path, clock: str = "received") -> Log:
    """Reads LCM logs, those of the control and of the housekeeping URL together, e.g.
    read_log("control.log", "housekeeping.log").

    clock: time of the messages: "received", the log's time of reception, independent of the
    senders' clocks; or "sent", the sender's time: for lock-step runs, where all use the simulator's
    clock. Messages that cannot be decoded and damaged parts are skipped and counted
    (Log.undecodable, Log.unknown, Log.damages). Raises OSError if a file cannot be read and
    ValueError if it is not a log.
    """
    if not paths:
        raise ValueError("read_log: which file?")
    events: list[Event] = []
    damages: dict[str, Damage] = {}
    for path in paths:
        log = EventLog(path)
        events += log
        if log.damage != Damage(0, 0, False):
            damages[os.fspath(path)] = log.damage
    return Log(events, damages, clock)
