"""Robust least squares with estimated variances of groups of measurements.

Each group (depths, pixels, errors of the arm's poses) has a stated deviation per measurement, and a factor on all of them
that is estimated together with the parameters: Foerstner 1979, Ein Verfahren zur Schaetzung von Varianz- und
Kovarianzkomponenten, whose iteration ends at the restricted maximum likelihood. The intervals are those of Student's
distribution with the degrees of freedom of Satterthwaite 1946, since the factors are uncertain, too.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as student

from palpate_common import levenberg_marquardt, robust

Floats = NDArray[np.float64]
WIDENINGS = (10.0, 3.0, 1.0)  # of the robust loss, so that gross errors of the start are followed
ROUNDS = 6  # of the factors after the first fit
PRIOR_FREEDOM = 4.0  # measurements that a stated deviation counts as
WEAK = 1.0  # 1/m, 1/rad: its square is information without which undetermined directions are not finite
FEW = 20  # residuals of which a median says nothing
# Expectations of w r^2 over that of w, of a normally distributed residual r with the robust weight w.
CONSISTENT = 0.961


@dataclass(frozen=True, eq=False)
class Group:
    """Residuals of one kind."""

    name: str
    r: Floats  # (n,), divided by the stated deviations
    J: Floats  # (n, p), derivatives by the step of the parameters
    deviation: Floats  # (n,), as stated, in `unit`
    unit: str
    is_robust: bool  # may be gross errors
    is_estimated: bool  # whether the factor on the deviations is estimated
    each: int = 1  # residuals of one measurement, one after the other


State = TypeVar("State")


class Problem(Protocol):
    """Measurements and their model."""

    count: int  # p, of all parameters
    leading: int  # of those that are fitted first, alone: the others stay where they start

    def groups(self, state: Any) -> list[Group]:
        """At a state, always the same groups in the same order."""

    def stepped(self, state: Any, step: Floats) -> Any:
        """The state after a step, (p,)."""


@dataclass(frozen=True, eq=False)
class Estimate:
    """Result: state with the covariance, (p, p), of its step and the degrees of freedom, (p,), of each variance."""

    state: Any
    covariance: Floats
    freedom: Floats
    groups: list[Group]
    factors: dict[str, float]  # on the stated deviations
    weights: dict[str, Floats] = field(default_factory=dict)  # (n,) of each group, 0 to 1

    @property
    def half_widths(self) -> Floats:
        """(p,), of the 95 % intervals."""
        result: Floats = student.ppf(0.975, self.freedom) * np.sqrt(np.diag(self.covariance))
        return result


def _weights(group: Group, factor: float, widening: float) -> Floats:
    return robust.weights(group.r / (factor * widening)) if group.is_robust else np.ones(len(group.r))


def _cost(groups: list[Group], factors: dict[str, float], widening: float) -> float:
    total = 0.0
    for group in groups:
        r = group.r / factors[group.name]
        total += float(robust.loss(r / widening).sum() * widening**2) if group.is_robust else float(0.5 * r @ r)
    return total


def _normal(groups: list[Group], factors: dict[str, float], widening: float) -> tuple[Floats, Floats]:
    """Matrix and right-hand side."""
    p = groups[0].J.shape[1]
    H, g = np.zeros((p, p)), np.zeros(p)
    for group in groups:
        w = _weights(group, factors[group.name], widening) / factors[group.name] ** 2
        weighted = w[:, None] * group.J
        H += group.J.T @ weighted
        g += weighted.T @ group.r
    return H, g


def minimised(problem: Problem, state: State, factors: dict[str, float], widening: float, free: int | None = None) -> State:
    """The state of the least loss within the start's basin. factors: on the stated deviations, by the group's name.
    widening: of the robust loss. free: number of leading parameters that change; default: all."""
    n = problem.count if free is None else free

    def normal_of(groups: list[Group]) -> tuple[Floats, Floats]:
        H, g = _normal(groups, factors, widening)
        return H[:n, :n], g[:n]

    def stepped(at: State, step: Floats) -> State:
        result: State = problem.stepped(at, np.concatenate([step, np.zeros(problem.count - n)]))
        return result

    return levenberg_marquardt.minimised(state, problem.groups, lambda groups: _cost(groups, factors, widening), normal_of,
                                         stepped, WEAK)[0]  # fmt: skip


def _by_median(groups: list[Group], factors: dict[str, float]) -> dict[str, float]:
    """First factors, of groups with gross errors: median of the residuals' sizes."""
    found = dict(factors)
    for group in groups:
        if group.is_robust and group.is_estimated and len(group.r) >= FEW:
            found[group.name] = max(1.4826 * float(np.median(np.abs(group.r))), 0.05)
    return found


def _components(groups: list[Group], factors: dict[str, float]) -> tuple[Floats, list[Floats], dict[str, float]]:
    """Covariance, (p, p), each group's part of the information, and its redundancy: measurements less parameters."""
    parts, sizes = [], []
    for group in groups:
        w = _weights(group, factors[group.name], 1.0)
        parts.append(group.J.T @ ((w / factors[group.name] ** 2)[:, None] * group.J))
        sizes.append(float(w.sum()))
    total: Floats = np.sum(parts, axis=0) + WEAK**2 * np.eye(parts[0].shape[0])
    scale = 1 / np.sqrt(np.diag(total))
    covariance = np.linalg.inv(total * np.outer(scale, scale)) * np.outer(scale, scale)
    redundancy = {group.name: max(size - float(np.trace(covariance @ part)), 0.0)
                  for group, part, size in zip(groups, parts, sizes)}  # fmt: skip
    return covariance, parts, redundancy


def _by_components(groups: list[Group], factors: dict[str, float]) -> dict[str, float]:
    """The next factors: those that the residuals and the stated deviations together say."""
    _, _, redundancy = _components(groups, factors)
    found = dict(factors)
    for group in groups:
        if group.is_estimated:
            w = _weights(group, factors[group.name], 1.0)
            squares = float(w @ group.r**2) / (CONSISTENT if group.is_robust else 1.0)
            found[group.name] = float(np.sqrt((PRIOR_FREEDOM + squares) / (PRIOR_FREEDOM + redundancy[group.name])))
    return found


def _uncertainty(groups: list[Group], factors: dict[str, float]) -> tuple[Floats, Floats]:
    """Covariance, (p, p), and the degrees of freedom, (p,), of each variance."""
    covariance, parts, redundancy = _components(groups, factors)
    variance = np.diag(covariance)
    spread = np.zeros(len(variance))
    for group, part in zip(groups, parts):
        if group.is_estimated:
            spread += np.diag(covariance @ part @ covariance) ** 2 / (PRIOR_FREEDOM + redundancy[group.name])
    return covariance, np.clip(variance**2 / np.maximum(spread, 1e-300), 3.0, 1e6)


def estimate(problem: Problem, start: Any, widenings: tuple[float, ...] = WIDENINGS) -> Estimate:
    """From a start within the basin to the least robust loss, with the factors on the stated deviations. widenings: of the
    loss, one after the other."""
    state = start
    factors = {group.name: 1.0 for group in problem.groups(state)}
    for widening in widenings:
        if problem.leading < problem.count:
            state = minimised(problem, state, factors, widening, problem.leading)
        state = minimised(problem, state, factors, widening)
        groups = problem.groups(state)
        if widening > 1:
            factors = _by_median(groups, factors)
    for _ in range(ROUNDS):
        old, factors = factors, _by_components(groups, factors)
        state = minimised(problem, state, factors, 1.0)
        groups = problem.groups(state)
        if all(abs(factors[name] / old[name] - 1) < 0.01 for name in factors):
            break
    covariance, freedom = _uncertainty(groups, factors)
    weights = {group.name: _weights(group, factors[group.name], 1.0) for group in groups}
    return Estimate(state, covariance, freedom, groups, factors, weights)
