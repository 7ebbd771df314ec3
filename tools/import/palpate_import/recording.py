"""Recordings that are read: each channel's messages with their times."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Optional, Union

import numpy as np
from numpy.typing import NDArray

from palpate_common.input_error import WRONG_CONFIGURATION, InputError
from palpate_import.csv_table import CsvTable
from palpate_import.description import FileDescription
from palpate_import.fill import messages_of
from palpate_import.mcap_source import McapSource
from palpate_import.rosbag_source import RosbagSource
from palpate_import.streams import Stream, StreamDescription
from palpate_import.topic_table import Source, TopicTable
from palpate_import.units import TIMES

Integers = NDArray[np.int64]
Table = Union[CsvTable, TopicTable]
MCAP, SQLITE = b"\x89MCAP0\r\n", b"SQLite format 3\0"
DEFAULT_TIME_COLUMN = "t"


@dataclass
class Channel:
    """utimes: (messages,), us. rows: of the table in which each message begins. file: index of its file."""

    name: str
    format: str
    path: str
    file: int
    utimes: Integers
    messages: NDArray[Any]
    rows: Integers


@dataclass
class Recording:
    """A file's channels. rows: that were taken. absent: optional channels that the file has no columns for, and which it lacks."""

    path: str
    channels: list[Channel]
    rows: int
    absent: dict[str, list[str]]


def source_of(path: Path) -> Optional[Source]:
    """Of a file with topics, by its content; None for a file of delimited values. Raises InputError."""
    if path.is_dir():
        return RosbagSource(path)
    try:
        with open(path, "rb") as file:
            begin = file.read(16)
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from error
    if begin.startswith(MCAP):
        return McapSource(path)
    return RosbagSource(path) if begin == SQLITE else None


class _Opened:
    """The tables of a file."""

    def __init__(self, path: Path, of: FileDescription) -> None:
        self._path, self._of, self._source = path, of, source_of(path)
        self.tables: dict[str, Table] = {}

    def table(self, stream: StreamDescription) -> Table:
        if self._source is None and stream.topic:
            raise InputError(
                f"{self._path}: {stream.channel}: topic '{stream.topic}'; allowed of a CSV file: no topic", WRONG_CONFIGURATION
            )
        if self._source is not None and not stream.topic:
            raise InputError(f"{self._path}: {stream.channel}: has no topic; allowed: {', '.join(sorted(self._source.topics))}",
                             WRONG_CONFIGURATION)  # fmt: skip
        if stream.topic not in self.tables:
            self.tables[stream.topic] = (
                CsvTable(self._path, self._of.csv) if self._source is None else TopicTable(self._source, stream.topic)
            )
        return self.tables[stream.topic]

    def has_topic(self, topic: str) -> bool:
        return self._source is None or topic in self._source.topics


def _time_column(of: FileDescription, stream: StreamDescription, table: Table) -> str:
    """ "": the times in the file, or a rate."""
    if of.rate > 0:
        return ""
    default = DEFAULT_TIME_COLUMN if isinstance(table, CsvTable) else ""
    given = stream.time_column if stream.time_column is not None else of.time_column
    return default if given is None else given


def _rounded(values: NDArray[np.float64]) -> Integers:
    """To the nearest whole number, halves away from zero."""
    return np.asarray(np.sign(values) * np.floor(np.abs(values) + 0.5), np.int64)


def _utimes(of: FileDescription, table: Table, column: str) -> Integers:
    """(rows,), us. Raises InputError where they go back or begin before 1970."""
    if of.rate > 0:
        utimes = _rounded((np.arange(table.count) / of.rate + of.start) * 1e6)
    elif isinstance(table, TopicTable) and (column == "" or column in table.stamps):
        nanoseconds = table.received if column == "" else table.stamps[column]
        utimes = (nanoseconds + 500) // 1000 + int(_rounded(np.array([of.start * 1e6]))[0])
    else:
        unit = TIMES[of.time_unit or _time_unit(table, column)]
        utimes = _rounded((unit * table.of(column) + of.start) * 1e6)
    where = f":{column}" if column else ""
    back = np.flatnonzero(np.diff(utimes) < 0)
    if back.size:
        raise InputError(f"{table.place(back[0] + 1)}{where}: time goes back by {utimes[back[0]] - utimes[back[0] + 1]} us")
    if utimes.size and utimes[0] < 0:
        raise InputError(
            f"{table.place(0)}{where}: time {utimes[0] * 1e-6:g} s; allowed: 0 or later; remedy: --start or the key start"
        )
    return utimes


def _time_unit(table: Table, column: str) -> str:
    unit = table.unit(column) or "s"
    if unit not in TIMES:
        raise InputError(f"{table.path}:{column}: unit '{unit}' in the head; allowed: {', '.join(TIMES)}, or --time-unit")
    return unit


def _require(table: Table, columns: list[str]) -> None:
    """All that a table lacks is one error, so that it is corrected once."""
    missing = list(dict.fromkeys(column for column in columns if not table.has(column)))
    if missing:
        listed = "', '".join(missing)
        raise InputError(f"{table.path}: no column{'s' if len(missing) > 1 else ''} '{listed}'; the columns are "
                         f"{', '.join(table.names)}; palpate-import --formats lists the fields of each format")  # fmt: skip


def read_recording(path: Path, of: FileDescription, index: int, taken: dict[str, str]) -> Recording:
    """taken: channels and the files that they are from, to which this one's are added. Raises InputError."""
    opened = _Opened(path, of)
    streams: list[Stream] = []
    absent: dict[str, list[str]] = {}
    for description in of.streams:
        if description.optional and not opened.has_topic(description.topic):
            absent[description.channel] = [description.topic]
            continue
        stream = Stream(description, opened.table(description))
        if stream.missing and description.optional:
            absent[description.channel] = stream.missing
            continue
        streams.append(stream)
    times = {id(stream): _time_column(of, stream.description, stream.table) for stream in streams}  # type: ignore[arg-type]
    for table in opened.tables.values():
        own = [stream for stream in streams if stream.table is table]
        clocks = [times[id(stream)] for stream in own if times[id(stream)]]
        conditions = [column for column in of.where if not table.has_text(column)] if own else []
        _require(table, [*clocks, *conditions, *(column for stream in own for column in stream.missing)])
        if own:
            table.load({*clocks, *(column for stream in own for column in stream.columns)}, of.where,
                       {column for stream in own for column in stream.gaps})  # fmt: skip
            if table.count == 0:
                raise InputError(f"{table.path}: no row to import")
    channels = [_channel(stream, of, times[id(stream)], index, taken) for stream in streams]
    if not channels:
        raise InputError(f"{path}: has none of the channels {', '.join(absent)}")
    return Recording(str(path), channels, sum(table.count for table in opened.tables.values()), absent)


def _channel(stream: Stream, of: FileDescription, time_column: str, index: int, taken: dict[str, str]) -> Channel:
    table, name = stream.table, stream.description.channel
    if name in taken:
        raise InputError(
            f"{table.path}: channel {name} is given twice"
            + (f"; it is from {taken[name]}" if taken[name] != table.path else "")
        )
    taken[name] = table.path
    utimes = _utimes(of, table, time_column)  # type: ignore[arg-type]
    messages, rows = messages_of(stream, utimes)
    return Channel(name, stream.description.format, table.path, index, utimes[rows], messages, rows)
