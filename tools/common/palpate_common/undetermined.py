"""Directions of a pose that measurements do not determine."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
UNDETERMINED = (0.02, np.radians(10))  # m, rad: deviations from which on nothing is said about a direction


def undetermined_directions(covariance: Floats) -> list[str]:
    """In words, of a covariance, (6, 6), of (position, m; rotation, rad), in its axes."""
    found = []
    for part, limit, words in ((slice(0, 3), UNDETERMINED[0], "position along"),
                               (slice(3, 6), UNDETERMINED[1], "rotation about")):  # fmt: skip
        for variance, axis in zip(*_principal(covariance[part, part])):
            if variance > limit**2:
                found.append(f"{words} ({axis[0]:.2f} {axis[1]:.2f} {axis[2]:.2f})")
    return found


def _principal(covariance: Floats) -> tuple[Floats, Floats]:
    """Variances, (3,), and directions, (3, 3), one a row, unit vectors rounded to 0.01, each with its largest part positive."""
    variances, axes = np.linalg.eigh(covariance)
    axes = axes.T
    largest = axes[np.arange(3), np.abs(axes).argmax(axis=1)]
    return variances, np.round(axes * np.sign(largest)[:, None], 2) + 0.0
