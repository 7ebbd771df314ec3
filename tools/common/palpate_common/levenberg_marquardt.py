"""Levenberg and Marquardt's method (Marquardt 1963) for losses whose weights change with the residuals."""

from __future__ import annotations

from typing import Callable, TypeVar

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
State = TypeVar("State")
At = TypeVar("At")
FIRST, LEAST, LARGEST = 1e-4, 1e-9, 1e6  # damping relative to the diagonal of the normal equations
GAINED = 1e-6  # relative decrease of the loss below which the iteration ends


def minimised(start: State, residuals_at: Callable[[State], At], loss_of: Callable[[At], float],
              normal_of: Callable[[At], tuple[Floats, Floats]], stepped: Callable[[State, Floats], State],
              weak: float, steps: int = 30) -> tuple[State, At]:  # fmt: skip
    """The state of the least loss within the start's basin, and the residuals there.

    normal_of: the weighted normal equations at residuals: matrix, (p, p), and gradient, (p,), of the loss by the step.
    stepped: the state after a step, (p,). weak: in inverse units of the step; its square is added to the diagonal, so that
    directions without information stay where they are.
    """
    state, at = start, residuals_at(start)
    loss, damping = loss_of(at), FIRST
    for _ in range(steps):
        H, g = normal_of(at)
        tried = stepped(state, -np.linalg.solve(H + np.diag(damping * np.diag(H) + weak**2), g))
        there = residuals_at(tried)
        new = loss_of(there)
        if new < loss:
            gained, state, at, loss, damping = loss - new, tried, there, new, max(LEAST, 0.2 * damping)
            if gained < GAINED * (1 + loss):
                break
        else:
            damping *= 8
            if damping > LARGEST:
                break
    return state, at
