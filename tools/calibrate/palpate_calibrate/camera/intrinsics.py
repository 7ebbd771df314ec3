"""Pinhole model of a camera with lens distortion."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from palpate_common.section import read_section

Floats = NDArray[np.float64]
UNDISTORTING_STEPS = 30


@dataclass(frozen=True)
class Intrinsics:
    """Pixels; column of a point (x, y, z) in C: fx x / z + cx, row: fy y / z + cy, pixel centres at whole numbers."""

    fx: float
    fy: float
    cx: float
    cy: float
    distortion: tuple[float, ...] = (0.0,) * 5  # k1, k2, p1, p2, k3 (Brown 1966), as OpenCV's

    def undistorted(self, pixels: Floats) -> Floats:
        """Places, (n, 2), at which a camera without distortion would see the same, of pixels, (n, 2)."""
        k1, k2, p1, p2, k3 = self.distortion
        seen = (np.asarray(pixels, float) - [self.cx, self.cy]) / [self.fx, self.fy]
        ideal = seen.copy()
        for _ in range(UNDISTORTING_STEPS):
            x, y = ideal.T
            square = x * x + y * y
            radial = 1 + square * (k1 + square * (k2 + square * k3))
            shift = np.column_stack([2 * p1 * x * y + p2 * (square + 2 * x * x), p1 * (square + 2 * y * y) + 2 * p2 * x * y])
            ideal = (seen - shift) / radial[:, None]
        return ideal * [self.fx, self.fy] + [self.cx, self.cy]

    def projected(self, points_C: Floats) -> Floats:
        """(n, 2), without distortion, of points, (n, 3), m, in C."""
        return points_C[:, :2] / points_C[:, 2:] * [self.fx, self.fy] + [self.cx, self.cy]

    def rays(self, pixels: Floats) -> Floats:
        """(n, 3), of length 1 along z, of undistorted pixels, (n, 2)."""
        return np.column_stack([(pixels - [self.cx, self.cy]) / [self.fx, self.fy], np.ones(len(pixels))])


def read_intrinsics(path: Path) -> Intrinsics:
    """Of a YAML file with fx, fy, cx, cy and optionally distortion. Raises InputError."""
    section = read_section(path)
    fx, fy = (section.number(key, 10, 1e5) for key in ("fx", "fy"))
    cx, cy = (section.number(key, -1e5, 1e5) for key in ("cx", "cy"))
    distortion = section.numbers("distortion", 5, -10, 10, [0.0] * 5)
    section.check_unused()
    return Intrinsics(fx, fy, cx, cy, tuple(distortion))
