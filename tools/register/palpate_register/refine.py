"""Robust refinement of a pose."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate_common import robust
from palpate_common.levenberg_marquardt import minimised
from palpate_common.pose import Pose
from palpate_common.surface import Surface
from palpate_register.observations import Observations
from palpate_register.residuals import Residuals, State, residuals, start_at

Floats = NDArray[np.float64]
WIDENINGS = (10.0, 3.0, 1.0)  # of the robust loss, so that gross errors of the start are followed
WEAK = 1e-3  # 1/m or 1/rad: information without which undetermined directions are not finite


@dataclass(frozen=True, eq=False)
class Refined:
    """Where the refinement ended."""

    state: State
    at: Residuals
    cost: float  # robust loss of all residuals
    information: Floats  # (6 or 12, 6 or 12), inverse covariance of the step of `State`

    @property
    def covariance(self) -> Floats:
        """(6, 6), of (position of the centre, m; rotation, rad), in W."""
        result: Floats = np.linalg.inv(self.information)[:6, :6]
        return result


def cost_of(at: Residuals, widening: float = 1.0) -> float:
    """Robust loss of distances and normals, and half the squares of the priors."""
    hard = at.r[~at.is_robust]
    of_distances = robust.loss(at.r[at.is_robust] / widening).sum() * widening**2
    return float(of_distances + 0.5 * hard @ hard)


def _normal_of(at: Residuals, widening: float) -> tuple[Floats, Floats]:
    w = np.where(at.is_robust, robust.weights(at.r / widening), 1.0)
    return at.J.T @ (w[:, None] * at.J), at.J.T @ (w * at.r)


def refine(surface: Surface, start: Pose | State, observed: Observations, steps: int = 30,
           widenings: tuple[float, ...] = WIDENINGS) -> Refined:  # fmt: skip
    """From a start within the pose's basin to the least robust loss.

    widenings: of the robust loss, one after the other, at least one.
    Reweighted least squares; closest points and weights are found again in each step, as in the
    iterative closest point method (Besl and McKay 1992), with distances along the gradient (Chen and
    Medioni 1992).
    """
    state = start_at(start) if isinstance(start, Pose) else start
    for widening in widenings:
        state, at = minimised(state, lambda one: residuals(surface, one, observed), lambda at: cost_of(at, widening),
                              lambda at: _normal_of(at, widening), lambda one, step: one.stepped(step, surface.center),
                              WEAK, steps)  # fmt: skip
    w = np.where(at.is_robust, robust.weights(at.r), 1.0)
    J = at.J.copy()
    J[: len(at.J_inside), :6] = at.J_inside
    information = J.T @ (w[:, None] * J) + WEAK**2 * np.eye(J.shape[1])
    return Refined(state, at, cost_of(at), information)
