"""One exposure of a depth camera, and what is left of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Optional

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Cloud:
    """utime: of the exposure, us, clock of the sender. points: (n, 3), m, in the camera's frame C, whose z axis points
    forwards; some may not be finite. colours: (n, 3), red, green and blue from 0 to 1, or None. at_edges: (n,), whether a
    point is at an edge in the camera's view, or None if that is not known."""

    utime: int
    points: Floats
    colours: Optional[Floats] = None
    at_edges: Optional[Mask] = None


@dataclass(frozen=True, eq=False)
class Observation:
    """Points of the object. utime: of the exposure, us. points: (n, 3), m, in W, n <= 256. deviation: standard deviation of
    each coordinate, m."""

    utime: int
    points: Floats
    deviation: float
