"""The head of a file of delimited values: comments, delimiter, names, units."""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass
from itertools import chain
from typing import Callable, Iterator, NoReturn, Optional

from palpate_common.input_error import InputError
from palpate_import.units import name_and_unit, unit_of

COMMENTS = ("#", "%", "//")
DELIMITERS = {"comma": ",", "semicolon": ";", "tab": "\t", "space": " "}
LONGEST_CELL = 1 << 20  # characters: a quote that is not closed ends here


@dataclass
class Row:
    """Cells without blanks around them, and the line where the row begins, 1-based."""

    line: int
    cells: list[str]


@dataclass
class Head:
    """units: by name, of those that the head states. rows: of data, to be read once."""

    names: list[str]
    units: dict[str, str]
    delimiter: str
    rows: Iterator[Row]


class Lines:
    """Physical lines without comments, except within quotes. started: line of the first one since `started` was set to 0."""

    def __init__(self, lines: Iterator[str], comment: tuple[str, ...]) -> None:
        self._lines, self._comment = lines, comment
        self.number, self.started = 0, 0
        self.comments: list[str] = []
        self._is_quoted = False
        self._pushed: Optional[str] = None

    def __iter__(self) -> Iterator[str]:
        return self

    def __next__(self) -> str:
        while True:
            if self._pushed is not None:
                line, self._pushed = self._pushed, None
            else:
                line = next(self._lines)
                self.number += 1
            if not self._is_quoted and line.lstrip().startswith(self._comment):
                self.comments.append(line.strip())
                continue
            if line.count('"') % 2:
                self._is_quoted = not self._is_quoted
            self.started = self.started or self.number
            return line

    def push_back(self, line: str) -> None:
        """The last line will come again."""
        if line.count('"') % 2:
            self._is_quoted = not self._is_quoted
        self._pushed = line


def rows(lines: Lines, delimiter: str, fail: Callable[[int, str], NoReturn]) -> Iterator[Row]:
    """Rows that are not empty. fail(line, what) raises."""
    behind_quote = re.compile(f'" +(?={re.escape(delimiter)}|\r?\n?$)')

    def prepared() -> Iterator[str]:
        for line in lines:
            if '"' in line:
                yield behind_quote.sub('"', line) if delimiter != " " else line
            else:
                yield " ".join(line.split()) + "\n" if delimiter == " " else line

    csv.field_size_limit(LONGEST_CELL)
    reader = csv.reader(prepared(), delimiter=delimiter, skipinitialspace=True, strict=True)
    while True:
        lines.started = 0
        try:
            cells = next(reader)
        except StopIteration:
            return
        except csv.Error as error:
            text = str(error)
            what = "a quote is not closed" if "unexpected end" in text or "field larger" in text else text
            fail(lines.started or lines.number, what)
        cells = [cell.strip() for cell in cells]
        if len(cells) > 1 or (cells and cells[0]):
            yield Row(lines.started, cells)


def is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return "_" not in cell


def _delimiter_of(line: str) -> str:
    """The one that stands most often outside of quotes; without any, blanks where they separate words, else a comma."""
    unquoted = "".join(part for i, part in enumerate(line.split('"')) if i % 2 == 0)
    counts = {delimiter: unquoted.count(delimiter) for delimiter in ",;\t"}
    most = max(counts, key=lambda delimiter: counts[delimiter])
    if counts[most]:
        return most
    return " " if len(unquoted.split()) > 1 and unquoted == line else ","


def _uncommented(comment: str) -> str:
    return comment.lstrip("#%/ ").strip()


def _names_in(comments: list[str], delimiter: str, count: int) -> Optional[list[str]]:
    """Of the last comment that has as many cells, as numpy.savetxt writes it."""
    for comment in reversed(comments):
        text = _uncommented(comment)
        for cells in (text.split(delimiter), text.split()):
            if (
                len(cells) == count
                and not all(is_number(cell) for cell in cells)
                and _units_in([cell.strip() for cell in cells]) is None
            ):
                return [cell.strip() for cell in cells]
    return None


def _units_in(cells: list[str]) -> Optional[list[Optional[str]]]:
    """Of a row of units: of which none is a number, and one at least is a known unit."""
    if any(is_number(cell) and unit_of(cell) is None for cell in cells):
        return None
    units = [unit_of(cell) or (cell or None) for cell in cells]
    known = [unit_of(cell) for cell in cells if cell]
    return units if any(unit is not None and unit != "1" for unit in known) else None


def read_head(lines: Lines, delimiter: Optional[str], names: Optional[list[str]], path: str) -> Head:
    """names: of a file without a line of names. Raises InputError for a file without rows, or with a name twice."""

    def fail(line: int, what: str) -> NoReturn:
        raise InputError(f"{path}:{line}: {what}")

    first = next((line for line in lines if line.strip()), None)
    if first is None:
        raise InputError(f"{path}: the file is empty")
    lines.push_back(first)
    delimiter = delimiter or _delimiter_of(first)
    source = rows(lines, delimiter, fail)
    top = next(source)
    texts, data = top.cells, source
    if names is not None or all(is_number(cell) for cell in top.cells):
        found = names if names is not None else _names_in(lines.comments, delimiter, len(top.cells))
        if found is None:
            fail(top.line, "the first line has numbers only; allowed: names of the columns there or in a comment above, or the key "
                           "`header` of a description")  # fmt: skip
        if len(found) != len(top.cells):
            fail(top.line, f"has {len(top.cells)} cells, the header {len(found)}")
        texts, data = found, chain([top], source)
    pairs = [name_and_unit(cell) for cell in texts]
    names = [name for name, _ in pairs]
    if len(set(names)) < len(names):
        names = texts
    twice = next((name for i, name in enumerate(names) if name in names[:i]), None)
    if twice is not None:
        fail(top.line, f"two columns are named '{twice}'")
    units = [unit for _, unit in pairs]
    below = next(data, None)
    if below is not None:
        row_of_units = _units_in(below.cells) if len(below.cells) == len(names) else None
        units = units if row_of_units is None else row_of_units
        data = data if row_of_units is not None else chain([below], data)
    for comment in lines.comments if not any(units) else []:
        cells = [cell.strip() for cell in _uncommented(comment).split(delimiter)]
        units = (_units_in(cells) if len(cells) == len(names) else None) or units
    return Head(names, {name: unit for name, unit in zip(names, units) if unit}, delimiter, data)
