"""Loss of normalised residuals: quadratic up to 2 deviations, constant beyond 8.

Three-part redescending function: Hampel 1974, The influence curve and its role in robust
estimation, J. Amer. Stat. Assoc. 69. At normally distributed residuals nearly all have full weight;
a gross error has none.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
A, B, C = 2.0, 4.0, 8.0  # standard deviations


def weights(r: Any) -> Floats:
    """(n,) of normalised residuals, 1 to 0: derivative of the loss over the residual."""
    size = np.maximum(np.abs(r), 1e-12)
    falling = A / size * np.clip((C - size) / (C - B), 0, 1)
    return np.where(size <= A, 1.0, np.where(size <= B, A / size, falling))


def loss(r: Any) -> Floats:
    """(n,), half the square of small normalised residuals."""
    size = np.abs(np.asarray(r, float))
    rest = 1 - np.clip((C - size) / (C - B), 0, 1) ** 2
    beyond = A * B - 0.5 * A**2 + 0.5 * (C - B) * A * rest
    return np.where(size <= A, 0.5 * size**2, np.where(size <= B, A * size - 0.5 * A**2, beyond))
