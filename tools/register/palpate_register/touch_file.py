"""Touches from CSV: columns x, y, z, optionally nx, ny, nz and deviation, in W, m."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from palpate_register.errors import InputError
from palpate_register.observations import Touches

PLACE, NORMAL, DEVIATION = ("x", "y", "z"), ("nx", "ny", "nz"), "deviation"
LARGEST = 100.0  # m, of a coordinate
DEVIATIONS = (1e-6, 0.1)  # m


def read_touches(path: Path, deviation: float, normal_deviation: float, radius: float,
                 common_deviation: float) -> Touches:  # fmt: skip
    """Touches of a file whose first line names its columns; # begins a comment.

    deviation: m, of rows that have none. normal_deviation: rad. radius: m, of the probe's tip.
    common_deviation: m. Raises InputError with file, line, column and value.
    """
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: is not text") from error
    rows = [(number, line) for number, line in enumerate(lines, 1) if line.split("#")[0].strip()]
    if not rows:
        raise InputError(f"{path}: is empty; its first line names the columns: x,y,z[,nx,ny,nz][,deviation]")
    names = [name.strip() for name in next(csv.reader([rows[0][1]]))]
    unknown = [name for name in names if name not in (*PLACE, *NORMAL, DEVIATION)]
    missing = [name for name in PLACE if name not in names]
    missing += [name for name in NORMAL if name not in names and any(other in names for other in NORMAL)]
    if unknown or missing or len(set(names)) != len(names):
        what = f"unknown column {unknown[0]!r}" if unknown else f"column {missing[0]!r} is missing" if missing else "a column twice"
        raise InputError(f"{path}:{rows[0][0]}: {what}; allowed: x,y,z[,nx,ny,nz][,deviation] in any order")
    values = np.array([_row(path, number, line, names) for number, line in rows[1:]]).reshape(-1, len(names))
    column = {name: values[:, i] for i, name in enumerate(names)}
    points = np.column_stack([column[name] for name in PLACE])
    normals = np.zeros_like(points)
    if NORMAL[0] in names:
        normals = np.column_stack([column[name] for name in NORMAL])
        size = np.linalg.norm(normals, axis=1)
        normals = np.divide(normals, size[:, None], out=np.zeros_like(normals), where=size[:, None] > 1e-9)
    deviations = column.get(DEVIATION, np.full(len(points), deviation))
    return Touches(points, normals, deviations, normal_deviation, radius, common_deviation)


def _row(path: Path, number: int, line: str, names: list[str]) -> list[float]:
    words = next(csv.reader([line.split("#")[0]]))
    if len(words) != len(names):
        raise InputError(f"{path}:{number}: {len(words)} values for {len(names)} columns")
    values = []
    for name, word in zip(names, words):
        low, high = DEVIATIONS if name == DEVIATION else (-LARGEST, LARGEST)
        try:
            value = float(word)
        except ValueError:
            value = np.nan
        if not low <= value <= high:
            raise InputError(f"{path}:{number}: {name}: {word.strip()!r}; allowed: a number, {low:g} to {high:g}")
        values.append(value)
    return values
