"""Touches from CSV: columns x, y, z, optionally nx, ny, nz and deviation, in W, m."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from palpate_common.column_file import Layout, read_columns
from palpate_register.observations import Touches

PLACE, NORMAL, DEVIATION = ("x", "y", "z"), ("nx", "ny", "nz"), "deviation"
LARGEST = 100.0  # m, of a coordinate
DEVIATIONS = (1e-6, 0.1)  # m
LAYOUT = Layout(PLACE, (NORMAL, (DEVIATION,)),
                {**{name: (-LARGEST, LARGEST) for name in (*PLACE, *NORMAL)}, DEVIATION: DEVIATIONS})  # fmt: skip


def read_touches(path: Path, deviation: float, normal_deviation: float, radius: float,
                 common_deviation: float) -> Touches:  # fmt: skip
    """Touches of a file whose first line names its columns; # begins a comment.

    deviation: m, of rows that have none. normal_deviation: rad. radius: m, of the probe's tip.
    common_deviation: m. Raises InputError with file, line, column and value.
    """
    file = read_columns(path, LAYOUT)
    points = file.numbers(*PLACE)
    normals = np.zeros_like(points)
    if file.has(NORMAL[0]):
        normals = file.numbers(*NORMAL)
        size = np.linalg.norm(normals, axis=1)
        normals = np.divide(normals, size[:, None], out=np.zeros_like(normals), where=size[:, None] > 1e-9)
    deviations = file.numbers(DEVIATION)[:, 0] if file.has(DEVIATION) else np.full(len(points), deviation)
    return Touches(points, normals, deviations, normal_deviation, radius, common_deviation)
