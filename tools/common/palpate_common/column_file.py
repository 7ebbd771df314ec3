"""CSV files whose first line names their columns; what is wrong is reported by file, line, column, value and what is allowed."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from palpate_common.input_error import InputError

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Layout:
    """Columns of a file: of each number its range, of those with text none."""

    required: tuple[str, ...]
    optional: tuple[tuple[str, ...], ...]  # groups, of each of which all columns or none are there
    ranges: dict[str, tuple[float, float]]  # lowest and highest value; columns that are not listed hold text

    @property
    def names(self) -> list[str]:
        return [*self.required, *(name for group in self.optional for name in group)]

    @property
    def text(self) -> str:
        return ",".join(self.required) + "".join(f"[,{','.join(group)}]" for group in self.optional)


@dataclass(frozen=True)
class ColumnFile:
    """Content of a file."""

    path: Path
    lines: list[int]  # of each row
    columns: dict[str, list[float]]
    texts: dict[str, list[str]]

    def has(self, name: str) -> bool:
        return name in self.columns or name in self.texts

    def numbers(self, *names: str) -> Floats:
        """(rows, names)."""
        return np.array([self.columns[name] for name in names], float).reshape(len(names), -1).T

    def fail(self, row: int, text: str) -> NoReturn:
        """Raises InputError with file and line."""
        raise InputError(f"{self.path}:{self.lines[row]}: {text}")


def read_columns(path: Path, layout: Layout) -> ColumnFile:
    """Of a file whose first line names its columns in any order; # begins a comment. Raises InputError."""
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: is not text") from error
    rows = [(number, line.split("#")[0]) for number, line in enumerate(lines, 1) if line.split("#")[0].strip()]
    if not rows:
        raise InputError(f"{path}: is empty; its first line names the columns: {layout.text}")
    names = [name.strip() for name in next(csv.reader([rows[0][1]]))]
    _check_names(path, rows[0][0], names, layout)
    columns: dict[str, list[float]] = {name: [] for name in names if name in layout.ranges}
    texts: dict[str, list[str]] = {name: [] for name in names if name not in layout.ranges}
    for number, line in rows[1:]:
        words = next(csv.reader([line]))
        if len(words) != len(names):
            raise InputError(f"{path}:{number}: {len(words)} values for {len(names)} columns")
        for name, word in zip(names, words):
            if name in texts:
                texts[name].append(word.strip())
            else:
                columns[name].append(_number(path, number, name, word, layout.ranges[name]))
    return ColumnFile(path, [number for number, _ in rows[1:]], columns, texts)


def _check_names(path: Path, number: int, names: list[str], layout: Layout) -> None:
    unknown = [name for name in names if name not in layout.names]
    missing = [name for name in layout.required if name not in names]
    missing += [name for group in layout.optional for name in group
                if name not in names and any(other in names for other in group)]  # fmt: skip
    if unknown or missing or len(set(names)) != len(names):
        what = f"column {missing[0]!r} is missing" if missing else "a column twice"
        what = f"unknown column {unknown[0]!r}" if unknown else what
        raise InputError(f"{path}:{number}: {what}; allowed: {layout.text} in any order")


def _number(path: Path, line: int, name: str, word: str, allowed: tuple[float, float]) -> float:
    low, high = allowed
    try:
        value = float(word)
    except ValueError:
        value = np.nan
    if not low <= value <= high:
        raise InputError(f"{path}:{line}: {name}: {word.strip()!r}; allowed: a number, {low:g} to {high:g}")
    return value
