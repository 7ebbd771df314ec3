"""Covariance of what a rigid payload does not explain, estimated from the residuals of each group of three axes.

Residuals of neighbouring samples and of neighbouring poses are alike: cables pull by pose, hysteresis and temperature last.
The covariance between samples i and j is the sum of three parts (as in Gaussian process regression, Rasmussen and
Williams 2006), the deviations of which maximise the restricted likelihood (Patterson and Thompson 1971):

  white  independent from sample to sample
  slow   exp(-|ti - tj| / time)
  pose   exp(-d^2 / 2 reach^2) between axes of W, d the distance of two poses, in units of LENGTH and ANGLE
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cholesky, solve_triangular
from scipy.optimize import minimize

from palpate_calibrate.motion import Motion
from palpate_common.rotations import Array

LENGTH = 0.8  # m
ANGLE = 2.0  # rad
SHORTEST_REACH, LONGEST_REACH = 0.5, 10.0  # between which the distance of the pose part is estimated
FLOOR = 1e-3  # smallest deviation of slow and pose, as a share of the white one at the start
OUTLIER = 3.5  # deviations beyond which the weight of a sample falls (Huber)


@dataclass
class Deviations:
    """Standard deviations of one group, in its unit, the time over which the slow part is alike, s, and the distance over
    which the pose part is, in units of LENGTH and ANGLE."""

    white: float
    slow: float
    pose: float
    time: float
    reach: float = 1.0


class Kernels:
    """Matrices between the samples of a motion, each of three axes in a frame of its own: R_W, (n, 3, 3), maps to W."""

    def __init__(self, motion: Motion, R_W: Array) -> None:
        turns = motion.rotation_WE.reshape(len(motion.time), 9)
        self.apart = np.abs(motion.time[:, None] - motion.time[None, :])
        square = ((turns[:, None] - turns[None]) ** 2).sum(axis=2) / (2 * ANGLE**2)
        square += ((motion.position[:, None] - motion.position[None]) ** 2).sum(axis=2) / LENGTH**2
        self._square = square
        n = len(motion.time)
        self._frames = np.einsum("ika,jkb->iajb", R_W, R_W).reshape(3 * n, 3 * n)
        steps = np.diff(motion.time)
        self.shortest = 2.0 * float(np.median(steps)) if steps.size else 1.0
        self.longest = max(2.0 * self.shortest, 0.5 * float(self.apart.max()))

    def covariance(self, d: Deviations, weights: Array) -> Array:
        """Of the axes of all samples, (3 n, 3 n), sample by sample."""
        alike = d.pose**2 * np.exp(-0.5 * self._square / d.reach**2)
        c = self._frames * np.repeat(np.repeat(alike, 3, axis=0), 3, axis=1)
        slow = d.slow**2 * np.exp(-self.apart / d.time)
        for axis in range(3):
            c[axis::3, axis::3] += slow
        c[np.diag_indices_from(c)] += np.repeat(d.white**2 / weights, 3)
        return c


@dataclass
class Information:
    """Normal equations matrix @ increment = vector of some observations."""

    matrix: Array
    vector: Array


class Group:
    """Residuals (n, 3) and their derivatives (n, 3, parameters) of one group, with the model of their covariance."""

    def __init__(self, kernels: Kernels, deviations: Deviations, parts: int) -> None:
        """`parts`: 1: white alone, 2: slow, too, 3: pose, too."""
        self.kernels, self.deviations, self.parts = kernels, deviations, parts
        self.weights = np.ones(len(kernels.apart))

    def set_residuals(self, residuals: Array, derivatives: Array) -> None:
        n, _, count = derivatives.shape
        self.used = np.flatnonzero(np.abs(derivatives).max(axis=(0, 1)) > 0)
        self.count = count
        self._columns = np.hstack([residuals.reshape(3 * n, 1), derivatives[:, :, self.used].reshape(3 * n, -1)])

    def _whitened(self, d: Deviations) -> tuple[Array, Array, float]:
        factor = cholesky(self.kernels.covariance(d, self.weights), lower=True, check_finite=False)
        white = solve_triangular(factor, self._columns, lower=True, check_finite=False)
        return white[:, 0], white[:, 1:], 2.0 * float(np.log(np.diag(factor)).sum())

    def information(self, d: Deviations | None = None) -> Information:
        """Of all parameters, about the current values."""
        residuals, derivatives, _ = self._whitened(d or self.deviations)
        matrix, vector = np.zeros((self.count, self.count)), np.zeros(self.count)
        matrix[np.ix_(self.used, self.used)] = derivatives.T @ derivatives
        vector[self.used] = derivatives.T @ residuals
        return Information(matrix, vector)

    def plain_information(self) -> tuple[Information, Array]:
        """The same for samples weighted as if they were independent, with the covariance of the vector, which allows
        for their correlation: the two parts of the sandwich (White 1980)."""
        d = self.deviations
        residuals, derivatives = self._columns[:, 0], self._columns[:, 1:]
        weighted = np.repeat(self.weights / (d.white**2 + d.slow**2 + d.pose**2), 3)[:, None] * derivatives
        matrix, spread = np.zeros((2, self.count, self.count))
        vector = np.zeros(self.count)
        some = np.ix_(self.used, self.used)
        matrix[some] = weighted.T @ derivatives
        vector[self.used] = weighted.T @ residuals
        spread[some] = weighted.T @ self.kernels.covariance(d, self.weights) @ weighted
        return Information(matrix, vector), spread

    def likelihood(self, others: Information, d: Deviations) -> float:
        """-2 times the logarithm of the restricted likelihood but for a constant, given what the other groups and the
        prior say."""
        residuals, derivatives, log_determinant = self._whitened(d)
        matrix, vector = others.matrix.copy(), others.vector.copy()
        matrix[np.ix_(self.used, self.used)] += derivatives.T @ derivatives
        vector[self.used] += derivatives.T @ residuals
        scale = 1 / np.sqrt(np.diag(matrix))
        factor = cho_factor(matrix * np.outer(scale, scale), lower=True, check_finite=False)[0]
        solved = solve_triangular(factor, scale * vector, lower=True, check_finite=False)
        of_parameters = 2 * np.log(np.diag(factor)).sum() - 2 * np.log(scale).sum()
        return float(log_determinant + residuals @ residuals - solved @ solved + of_parameters)

    def estimate(self, others: Information) -> None:
        """Deviations of the largest restricted likelihood, given what the other groups and the prior say."""
        first = self.deviations
        floor, ceiling = FLOOR * first.white, 30 * (first.white + first.slow + first.pose)
        # White, slow, its time, pose, its reach.
        lower = np.log([1e-2 * first.white, floor, self.kernels.shortest, floor, SHORTEST_REACH])
        upper = np.log([ceiling, ceiling, self.kernels.longest, ceiling, LONGEST_REACH])
        start = [first.white, first.slow, first.time, first.pose, first.reach]
        at = np.clip(np.log(np.maximum(start, 1e-300)), lower, upper)
        free = (1, 3, 5)[self.parts - 1]

        def deviations(some: Array) -> Deviations:
            white, slow, time, pose, reach = np.exp(np.concatenate([some, at[free:]]))
            return Deviations(white, slow if self.parts > 1 else 0.0, pose if self.parts > 2 else 0.0, time, reach)

        done = minimize(lambda some: self.likelihood(others, deviations(some)), at[:free], method="L-BFGS-B",
                        bounds=list(zip(lower, upper))[:free], options={"maxiter": 15, "eps": 1e-3})  # fmt: skip
        self.deviations = deviations(done.x)

    def update_weights(self) -> None:
        """Reduces the weight of samples whose residual, given all others, is larger than OUTLIER deviations."""
        inverse = np.linalg.inv(self.kernels.covariance(self.deviations, np.ones(len(self.weights))))
        size = (np.abs(inverse @ self._columns[:, 0]) / np.sqrt(np.diag(inverse))).reshape(-1, 3).max(axis=1)
        self.weights = np.minimum(1.0, (OUTLIER / np.maximum(size, 1e-12)) ** 2)
