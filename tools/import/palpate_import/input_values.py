"""From what a field takes its value: a column, with sign and unit, or a constant."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Optional, Protocol

import numpy as np
from numpy.typing import NDArray

from palpate_common.input_error import WRONG_CONFIGURATION, InputError
from palpate_import.units import Dimension

Floats = NDArray[np.float64]
_RANGE = re.compile(r"\{(\d+)\.\.(\d+)\}")


class Names(Protocol):
    """What is known of a table before its rows are read."""

    path: str

    def has(self, column: str) -> bool: ...

    def unit(self, column: str) -> Optional[str]:
        """That its head states, None if it states none."""


class Rows(Protocol):
    """The rows of a table. of: (n,) numbers of a column."""

    count: int

    def of(self, column: str) -> Floats: ...


@dataclass(frozen=True)
class Value:
    """A column times a factor to SI, or a constant."""

    column: Optional[str]
    factor: float = 1.0

    def of(self, rows: Rows) -> Floats:
        """(n,), SI."""
        if self.column is None:
            return np.full(rows.count, self.factor)
        numbers = rows.of(self.column)
        return numbers if self.factor == 1 else self.factor * numbers


def column_of(text: str) -> Optional[str]:
    """The column of "[-]column[:unit]"; None for "=constant"."""
    if text.startswith("="):
        return None
    return (text[1:] if text.startswith("-") else text).split(":")[0]


def value_of(text: str, dimension: Dimension, names: Names) -> Value:
    """What "[-]column[:unit]" or "=constant" says. Raises InputError for a unit or a constant that is none; a column that the
    table lacks is no error here."""
    column = column_of(text)
    if column is None:
        try:
            constant = float(text[1:])
        except ValueError:
            constant = math.nan
        if not math.isfinite(constant):
            raise InputError(f"'{text}'; allowed: =NUMBER, for example =0.5", WRONG_CONFIGURATION)
        return Value(None, constant)
    sign = -1.0 if text.startswith("-") else 1.0
    given = text.split(":", 1)[1] if ":" in text else None
    unit = given
    if unit is None and names.has(column):
        unit = names.unit(column)
        if dimension is Dimension.NONE and dimension.factor(unit or "") is None:
            unit = None  # of counts there are no units
    if unit is None:
        return Value(column, sign)
    factor = dimension.factor(unit)
    if factor is None:
        where = f"unknown unit '{unit}'" if given else f"unit '{unit}' in the head of {names.path}, column {column}"
        raise InputError(f"'{text}': {where}; allowed: {dimension.listed}", WRONG_CONFIGURATION)
    return Value(column, sign * factor)


def expanded(text: str) -> list[str]:
    """ "q[{0..6}]": q[0] to q[6]."""
    found = _RANGE.search(text)
    if found is None:
        return [text]
    first, last = int(found[1]), int(found[2])
    return [text[: found.start()] + str(i) + text[found.end() :] for i in range(first, last + 1)]
