"""A file of delimited values as a table."""

from __future__ import annotations

import gzip
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Iterator, Optional

import numpy as np
from numpy.typing import NDArray

from palpate_common.input_error import InputError
from palpate_import.csv_head import COMMENTS, DELIMITERS, Head, Lines, is_number, read_head

Floats = NDArray[np.float64]
CHUNK = 20000  # rows whose text is in memory at one time


@dataclass(frozen=True)
class CsvOptions:
    """delimiter: auto, comma, semicolon, tab, space. comment: what begins a comment; None: any of COMMENTS, "": nothing.
    header: names of the columns of a file without them."""

    delimiter: str = "auto"
    comment: Optional[str] = None
    header: Optional[list[str]] = None


class CsvTable:
    """Names and units are known at once; load() reads the rows of some columns. Raises InputError with file, line and column."""

    def __init__(self, path: Path, options: CsvOptions) -> None:
        self.path, self._options = str(path), options
        self.count = 0
        self._numbers: dict[str, Floats] = {}
        self._lines: NDArray[np.int64] = np.zeros(0, np.int64)
        with self._open() as file:
            head = self._head(file)
        self.names, self._units = head.names, head.units

    def _open(self) -> IO[str]:
        try:
            with open(self.path, "rb") as file:
                is_compressed = file.read(2) == b"\x1f\x8b"
            if is_compressed:
                return gzip.open(self.path, "rt", encoding="utf-8-sig", newline="")
            return open(self.path, encoding="utf-8-sig", newline="")
        except OSError as error:
            raise InputError(f"{self.path}: {error.strerror}") from error

    def _head(self, file: IO[str]) -> Head:
        def guarded() -> Iterator[str]:
            try:
                yield from file
            except UnicodeDecodeError as error:
                raise InputError(f"{self.path}: is not text in UTF-8") from error
            except (OSError, EOFError) as error:
                raise InputError(f"{self.path}: {error}") from error

        comment = self._options.comment
        starts = COMMENTS if comment is None else (comment,) if comment else ()
        return read_head(Lines(guarded(), starts), DELIMITERS.get(self._options.delimiter), self._options.header, self.path)

    def has(self, column: str) -> bool:
        return column in self.names

    def has_text(self, column: str) -> bool:
        """Whether a condition may name it."""
        return self.has(column)

    def unit(self, column: str) -> Optional[str]:
        return self._units.get(column)

    def load(self, columns: set[str], where: dict[str, str], gaps: set[str]) -> None:
        """Of the rows whose columns read as `where` says. gaps: columns in which an empty cell or nan is allowed."""
        indices = {name: self.names.index(name) for name in sorted(columns)}
        conditions = [(self.names.index(name), text) for name, text in where.items()]
        texts: dict[str, list[str]] = {name: [] for name in indices}
        parts: dict[str, list[Floats]] = {name: [] for name in indices}
        lines: list[int] = []
        width = len(self.names)

        def convert() -> None:
            for name, cells in texts.items():
                parts[name].append(self._converted(name, cells, lines[-len(cells) :] if cells else [], name in gaps))
                cells.clear()

        with self._open() as file:
            for row in self._head(file).rows:
                if len(row.cells) != width:
                    raise InputError(f"{self.path}:{row.line}: has {len(row.cells)} cells, the header {width}")
                if all(row.cells[i] == text for i, text in conditions):
                    lines.append(row.line)
                    for name, i in indices.items():
                        texts[name].append(row.cells[i])
                    if len(lines) % CHUNK == 0:
                        convert()
        convert()
        self._numbers = {name: np.concatenate(arrays) for name, arrays in parts.items()}
        self._lines, self.count = np.array(lines, np.int64), len(lines)

    def _converted(self, name: str, cells: list[str], lines: list[int], may_be_absent: bool) -> Floats:
        try:
            values = np.array([float(cell) for cell in cells]) if not any("_" in cell for cell in cells) else None
        except ValueError:
            values = None
        if values is not None and np.isfinite(values).all():
            return values
        values = np.empty(len(cells))
        for i, cell in enumerate(cells):
            if may_be_absent and cell.lower() in ("", "nan"):
                values[i] = np.nan
                continue
            values[i] = float(cell) if is_number(cell) else np.nan
            if not np.isfinite(values[i]):
                what = "is not finite" if is_number(cell) else "is not a number"
                raise InputError(
                    f"{self.path}:{lines[i]}:{name}: '{cell}' {what}" + ("; decimals have a point" if "," in cell else "")
                )
        return values

    def of(self, column: str) -> Floats:
        """(n,) as they are in the file."""
        return self._numbers[column]

    def place(self, row: int) -> str:
        return f"{self.path}:{self._lines[row]}"
