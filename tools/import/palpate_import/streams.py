"""One channel of the log: from which columns its messages are made."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Optional, Protocol

import numpy as np

from palpate_common.input_error import WRONG_CONFIGURATION, InputError
from palpate_import.fields import MOST_POINTS, Format, format_of
from palpate_import.input_values import Floats, Names, Rows, Value, column_of, value_of
from palpate_import.pose_forms import PoseForm

POSE_FIELDS = ("px", "py", "pz", "qw", "qx", "qy", "qz")


@dataclass
class StreamDescription:
    """columns: by field. optional_columns: those whose absence is no error. poses: the first one whose columns exist is used.
    optional: the channel is left out where the recording lacks a column. topic: of MCAP files and bags."""

    channel: str
    format: str
    columns: dict[str, str] = field(default_factory=dict)
    optional_columns: dict[str, str] = field(default_factory=dict)
    poses: list[PoseForm] = field(default_factory=list)
    fingertips: list[PoseForm] = field(default_factory=list)
    optional: bool = False
    topic: str = ""
    time_column: Optional[str] = None


class Table(Names, Rows, Protocol):
    """A recording, or a topic of one; load() before of()."""

    @property
    def names(self) -> list[str]: ...

    def load(self, columns: set[str], where: dict[str, str], gaps: set[str]) -> None: ...

    def place(self, row: int) -> str: ...


def check_channel(channel: str) -> None:
    """Raises InputError."""
    if not 1 <= len(channel) <= 63 or not all(c in "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_" for c in channel):
        raise InputError(f"channel '{channel}' must be 1 to 63 of A-Z, 0-9 and _", WRONG_CONFIGURATION)


class Stream:
    """A description bound to a table. missing: columns that the table lacks; nothing else may be asked for then."""

    def __init__(self, description: StreamDescription, table: Table) -> None:
        """Raises InputError for unknown fields and units."""
        check_channel(description.channel)
        self.description, self.table = description, table
        self.format: Format = format_of(description.format)
        self.missing: list[str] = []
        self.pose = self._first_possible(description.poses)
        described = {**description.columns}
        for name, text in description.optional_columns.items():
            column = column_of(text)
            if column is None or table.has(column):
                described[name] = text
        self._check_names({**described, **description.optional_columns})
        self.values = {one.name: value for one in self.format.fields
                       if (value := self._value(one.name, one.required, described)) is not None}  # fmt: skip
        for form in description.fingertips:
            self.missing += [column for column in form.columns if not table.has(column)]
        if description.format == "shape_observation":
            self._need_points()

    def _need_points(self) -> None:
        given = [axis for axis in "xyz" if axis in self.values]
        if not self.markers() and len(given) < 3:
            self.missing += [axis for axis in "xyz" if axis not in given]

    def _check_names(self, described: dict[str, str]) -> None:
        unknown = [name for name in described if name not in self.format.names]
        if unknown:
            names = self.format.names
            shown = names[:40] + (["..."] if len(names) > 40 else [])
            raise InputError(f"{self.description.channel}: format {self.description.format} has no field '{unknown[0]}'; its fields: "
                             + ", ".join(shown), WRONG_CONFIGURATION)  # fmt: skip
        covered = [name for name in POSE_FIELDS if name in described] if self._pose_sets_fields() else []
        if covered:
            raise InputError(f"{self.description.channel}: field {covered[0]} is given in addition to the key pose; allowed: one of them",
                             WRONG_CONFIGURATION)  # fmt: skip

    def _pose_sets_fields(self) -> bool:
        return bool(self.description.poses) and self.description.format == "robot_state"

    def _first_possible(self, forms: list[PoseForm]) -> Optional[PoseForm]:
        for form in forms:
            if all(self.table.has(column) for column in form.columns):
                return form
        if forms:
            self.missing += [column for column in forms[0].columns if not self.table.has(column)]
        return None

    def _value(self, name: str, required: bool, described: dict[str, str]) -> Optional[Value]:
        if name in POSE_FIELDS and self._pose_sets_fields():
            return None
        text = described.get(name)
        if text is None:
            if not self.table.has(name):
                self.missing += [name] if required else []
                return None
            text = name
        column = column_of(text)
        if column is not None and not self.table.has(column):
            self.missing.append(column)
            return None
        try:
            return value_of(text, self.format.field(name).dimension, self.table)
        except InputError as error:
            raise InputError(f"{self.description.channel}: field {name}: {error}", error.exit_code) from error

    def has(self, name: str) -> bool:
        return name in self.values

    def number(self, name: str) -> Floats:
        """(rows,), SI; zero where there is no column."""
        return self.values.get(name, Value(None, 0.0)).of(self.table)

    def numbers(self, *names: str) -> Floats:
        """(rows, names)."""
        made = np.zeros((self.table.count, len(names)))
        for i, name in enumerate(names):
            if name in self.values:
                made[:, i] = self.number(name)
        return made

    def markers(self) -> list[int]:
        """Numbers of the points that a row has, from 1. Raises InputError for one without all of its coordinates."""
        found = [i for i in range(1, MOST_POINTS + 1) if any(self.has(f"{axis}{i}") for axis in "xyz")]
        for i in found:
            lacking = [f"{axis}{i}" for axis in "xyz" if not self.has(f"{axis}{i}")]
            if lacking:
                raise InputError(f"{self.description.channel}: point {i} has no {lacking[0]}; allowed: all of x{i}, y{i}, z{i}",
                                 WRONG_CONFIGURATION)  # fmt: skip
        return found

    @property
    def columns(self) -> set[str]:
        """That the messages are made of."""
        found = {value.column for value in self.values.values() if value.column is not None}
        for form in [*([self.pose] if self.pose else []), *self.description.fingertips]:
            found.update(form.columns)
        return found

    @property
    def gaps(self) -> set[str]:
        """Columns in which a value may be absent."""
        if self.description.format != "shape_observation":
            return set()
        names = [f"{axis}{i}" for i in self.markers() for axis in "xyz"]
        return {str(self.values[name].column) for name in names if self.values[name].column}
