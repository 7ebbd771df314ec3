"""A topic of an MCAP file or a ROS 2 bag as a table: one row a message, one column a number in it."""

from __future__ import annotations

from itertools import islice
from typing import Any, Iterator, NamedTuple, Optional, Protocol

import numpy as np
from numpy.typing import NDArray

from palpate_common.input_error import InputError
from palpate_import.message_paths import ABSENT, MOST_LISTED, getter, is_time, leaves, number_of

Floats = NDArray[np.float64]


class Stored(NamedTuple):
    """A decoded message, and when it was received, ns."""

    topic: str
    nanoseconds: int
    message: Any


class Source(Protocol):
    """A file with topics. messages() may be called several times; raises InputError."""

    path: str

    @property
    def topics(self) -> list[str]: ...

    def messages(self, topics: set[str]) -> Iterator[Stored]: ...


class TopicTable:
    """As CsvTable. The times of a table whose time column is "" are those in the file."""

    def __init__(self, source: Source, topic: str) -> None:
        """Raises InputError for a topic that the file lacks or that has no message."""
        self.path, self._source, self.topic = f"{source.path}:{topic}", source, topic
        if topic not in source.topics:
            raise InputError(f"{source.path}: no topic '{topic}'; the topics are {', '.join(sorted(source.topics))}")
        first = next(source.messages({topic}), None)
        if first is None:
            raise InputError(f"{self.path}: the topic has no message")
        self._first = first.message
        self.count = 0
        self._numbers: dict[str, Floats] = {}
        self.received: NDArray[np.int64] = np.zeros(0, np.int64)  # ns
        self.stamps: dict[str, NDArray[np.int64]] = {}  # ns, of columns that are times

    @property
    def names(self) -> list[str]:
        """At most MOST_LISTED of the numbers of the first message."""
        found = list(islice(leaves(self._first), MOST_LISTED + 1))
        return found[:MOST_LISTED] + (["..."] if len(found) > MOST_LISTED else [])

    def has(self, column: str) -> bool:
        try:
            return number_of(getter(column)(self._first)) is not None
        except ValueError:
            return False

    def has_text(self, column: str) -> bool:
        """As of CsvTable: a text is enough."""
        try:
            return getter(column)(self._first) is not ABSENT
        except ValueError:
            return False

    def unit(self, column: str) -> Optional[str]:
        """Of ROS and JSON messages none is known."""
        return None

    def load(self, columns: set[str], where: dict[str, str], gaps: set[str]) -> None:
        """As CsvTable.load()."""
        getters = {name: getter(name) for name in sorted(columns)}
        conditions = [(getter(name), text) for name, text in where.items()]
        values: dict[str, list[float]] = {name: [] for name in getters}
        stamps: dict[str, list[int]] = {name: [] for name in getters}
        received: list[int] = []
        for stored in self._source.messages({self.topic}):
            if not all(str(get(stored.message)) == text for get, text in conditions):
                continue
            received.append(stored.nanoseconds)
            for name, get in getters.items():
                value = get(stored.message)
                if is_time(value):
                    stamps[name].append(int(number_of(value) or 0))
                    continue
                number = None if value is ABSENT else number_of(value)
                if name in gaps and (number is None or number != number):
                    number = np.nan
                elif number is None or not np.isfinite(number):
                    what = "is absent" if value is ABSENT else "is not a number" if number is None else "is not finite"
                    raise InputError(
                        f"{self.path}: message {len(received)}: {name}"
                        + ("" if value is ABSENT else f": {value!r}")
                        + f" {what}"
                    )
                values[name].append(number)
        self.received, self.count = np.array(received, np.int64), len(received)
        self._numbers = {name: np.array(list_, float) for name, list_ in values.items()}
        self.stamps = {name: np.array(list_, np.int64) for name, list_ in stamps.items() if list_}

    def of(self, column: str) -> Floats:
        if column in self.stamps:
            return self.stamps[column] * 1e-9
        return self._numbers[column]

    def place(self, row: int) -> str:
        return f"{self.path}: message {row + 1}"
