"""Errors of a depth camera's points: along the viewing ray by triangulation, across it by the pixel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class DepthError:
    """Standard deviations of a point 1 m in front of the camera, m.

    A triangulated depth errs with the square of the distance, the place across the ray with the distance (Khoshelham and
    Elberink 2012, Accuracy and resolution of Kinect depth data for indoor mapping applications).
    """

    along_at_1_m: float
    across_at_1_m: float

    def along(self, points_C: Floats) -> Floats:
        """(n,), m, of points, (n, 3), m, in C."""
        result: Floats = self.along_at_1_m * np.abs(points_C[:, 2]) ** 2
        return np.maximum(result, 1e-6)

    def across(self, points_C: Floats) -> Floats:
        """(n,), m, of points, (n, 3), m, in C."""
        result: Floats = self.across_at_1_m * np.abs(points_C[:, 2])
        return np.maximum(result, 1e-6)
