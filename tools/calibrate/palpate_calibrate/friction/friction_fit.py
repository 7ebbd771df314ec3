"""Friction of each joint by least squares on the balance of momentum, without accelerations.

With a smooth weight w of time, the integral of w times the friction is that of w (tau + C^T dq - g) plus that of w' M dq, which
holds without contact. Coulomb friction is that of core/sensing/joint_friction.hpp: it builds up over the rotation `presliding`,
as the mean of elasto-plastic elements.
Each joint also has an offset of its torque sensor and an error of the modelled weight, so that neither is taken for friction.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import stats

from palpate_calibrate.friction.arm_dynamics import ArmDynamics
from palpate_common.input_error import InputError
from palpate_common.rotations import Array

WEIGHT_TIME = 0.08  # s, standard deviation of the weights, and distance between them
REACH = 4.0  # of the weights, standard deviations
LONGEST_GAP = 0.1  # s, between two readings
BLOCK_TIME = 2.0  # s: errors further apart count as independent
PRESLIDING = np.geomspace(3e-5, 5e-3, 12)  # rad, that are tried
YIELD = np.array([0.28, 0.66, 1.04, 1.95])  # of the elements, as palpated has them
MET = 0.05  # width of bounds of the friction that count as one value
COULOMB, VISCOUS, OFFSET, WEIGHT = range(4)
# Standard deviations before the recording: N m, N m s/rad, N m, and 1.
PRIOR = np.array([1e3, 1e3, 20.0, 0.1])
FEWEST_BLOCKS = 8
DETERMINED = 0.5  # of the value: a deviation below that
LEAST_ERROR = 0.02  # of `error`


@dataclass(frozen=True, eq=False)
class Torques:
    """A recording without contact: (m,) s, and (m, n) each in rad, rad/s, N m."""

    name: str
    time: Array
    q: Array
    dq: Array
    tau: Array


@dataclass(frozen=True, eq=False)
class FrictionFit:
    """values, half_width: (n, 4) by COULOMB, VISCOUS, OFFSET, WEIGHT; half widths of the 95 % intervals. times, measured,
    residual: at the middle of each weight, the torque that friction and offset explain, N m, (k, n); not a number while the
    joint's friction is not known. noise: (n,) N m, RMS of the observer's external torque while the joints slide."""

    torques: Torques
    joints: list[str]
    presliding: float
    values: Array
    half_width: Array
    times: Array
    measured: Array
    residual: Array
    noise: Array

    def is_determined(self) -> Array:
        """(n,): whether the Coulomb friction of each joint is known to half its value, or to a twentieth of the largest."""
        deviation = self.half_width[:, COULOMB] / 1.96
        coulomb = self.values[:, COULOMB]
        return np.asarray(deviation < np.maximum(DETERMINED * coulomb, 0.05 * coulomb.max()))

    @property
    def error(self) -> float:
        """Relative standard deviation of the friction of a sliding joint, over all joints, for the key `error`."""
        known = self.is_determined() & (self.values[:, COULOMB] > 0)
        if not known.any():
            return 1.0
        relative = self.half_width[known, COULOMB] / 1.96 / self.values[known, COULOMB]
        return float(np.clip(np.sqrt(np.mean(relative**2)), LEAST_ERROR, 1))


def coulomb_shares(q: Array, presliding: Array) -> Array:
    """(p, m, n): friction over the Coulomb friction, -1 to 1, for each presliding, rad, of (p,); not a number until the joint's
    motion determines it."""
    yields = presliding[:, None, None] * YIELD[:, None]
    lower = -np.ones((len(presliding), len(YIELD), q.shape[1]))
    upper = -lower
    middle, width = np.empty((2, len(q), len(presliding), q.shape[1]))
    for k, step in enumerate(np.diff(q, axis=0, prepend=q[:1])):
        moved = step / yields
        np.minimum(np.maximum(lower + moved, -1), 1, out=lower)
        np.minimum(np.maximum(upper + moved, -1), 1, out=upper)
        low, high = lower.sum(axis=1), upper.sum(axis=1)
        middle[k], width[k] = (low + high) / (2 * len(YIELD)), (high - low) / len(YIELD)
    return np.asarray(np.where(width < MET, middle, np.nan).transpose(1, 0, 2))


def observed(torques: Torques, balance: Array, momentum: Array, friction: Array, bandwidth: float) -> Array:
    """External torques that the observer of palpated finds, (m, n), N m; `balance`: tau + C^T dq - g."""
    gain = 2 * np.pi * bandwidth
    residual = np.zeros_like(momentum)
    driving = np.nan_to_num(balance - friction)
    for k in range(1, len(momentum)):
        step = torques.time[k] - torques.time[k - 1]
        residual[k] = (residual[k - 1] + gain * (momentum[k] - momentum[k - 1] - 0.5 * step * (driving[k] + driving[k - 1]))
                       ) / (1 + gain * step)  # fmt: skip
    return residual


class _Weights:
    """Integrals over a recording with the weights of all times."""

    def __init__(self, time: Array) -> None:
        self.middles = np.arange(time[0] + REACH * WEIGHT_TIME, time[-1] - REACH * WEIGHT_TIME, WEIGHT_TIME)
        self._begin = np.searchsorted(time, self.middles - REACH * WEIGHT_TIME)
        self._end = np.searchsorted(time, self.middles + REACH * WEIGHT_TIME)
        self._time, self._step = time, np.gradient(time)

    def mean(self, values: Array, is_rate: bool = False) -> Array:
        """(k, n): integral of w times the values, or of w' times them, over that of w."""
        out = np.empty((len(self.middles), values.shape[1]))
        for k, (a, b) in enumerate(zip(self._begin, self._end)):
            offset = (self._time[a:b] - self.middles[k]) / WEIGHT_TIME
            weight = np.exp(-0.5 * offset**2) * self._step[a:b]
            of = -offset / WEIGHT_TIME * weight if is_rate else weight
            out[k] = of @ values[a:b] / weight.sum()
        return out


def fit_friction(torques: Torques, arm: ArmDynamics, bandwidth: float = 10.0) -> FrictionFit:
    """`bandwidth`: Hz, of palpated's observer, for `noise`. Raises InputError."""
    steps = np.diff(torques.time)
    if len(steps) < 10 or (steps <= 0).any() or steps.max() > LONGEST_GAP:
        raise InputError(f"{torques.name}: the times of ROBOT_STATE do not increase, or have gaps above {LONGEST_GAP} s")
    weights = _Weights(torques.time)
    if len(weights.middles) * WEIGHT_TIME < FEWEST_BLOCKS * BLOCK_TIME:
        raise InputError(f"{torques.name}: {torques.time[-1] - torques.time[0]:.1f} s; allowed: {FEWEST_BLOCKS * BLOCK_TIME + 1:g} s or more")
    momentum, coriolis, gravity = arm.evaluate(torques.q, torques.dq)
    balance = torques.tau + coriolis - gravity
    friction = weights.mean(balance) + weights.mean(momentum, is_rate=True)
    columns = (weights.mean(torques.dq), np.ones_like(friction), weights.mean(gravity))
    all_shares = coulomb_shares(torques.q, PRESLIDING)
    fits = [_least_squares_of_all(torques.name, (weights.mean(shares), *columns), friction, weights.middles) for shares in all_shares]
    best = int(np.argmin([np.nanmean(np.square(residual)) for _, _, residual in fits]))
    presliding, shares, (values, half, residual) = PRESLIDING[best], all_shares[best], fits[best]
    modelled = values[:, COULOMB] * shares + values[:, VISCOUS] * torques.dq + values[:, OFFSET] + values[:, WEIGHT] * gravity
    external = observed(torques, balance, momentum, modelled, bandwidth)
    noise = [_rms(external[np.abs(shares[:, i]) > 0.9, i]) for i in range(len(arm.joints))]
    return FrictionFit(torques, [joint.name for joint in arm.joints], float(presliding), values, half, weights.middles,
                       friction, residual, np.array(noise))  # fmt: skip


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2))) if len(values) else float("nan")


def _least_squares_of_all(name: str, columns: tuple[Array, ...], friction: Array, times: Array) -> tuple[Array, Array, Array]:
    """Values, half widths and residuals of all joints."""
    count = friction.shape[1]
    values, half = np.zeros((count, 4)), np.full((count, 4), np.inf)
    residual = np.full_like(friction, np.nan)
    for i in range(count):
        X = np.column_stack([column[:, i] for column in columns])
        known = np.isfinite(X).all(axis=1)
        if known.sum() * WEIGHT_TIME < FEWEST_BLOCKS * BLOCK_TIME:
            raise InputError(f"{name}: {known.sum() * WEIGHT_TIME:.1f} s in which the friction of joint {i + 1} is determined by its motion; "
                             f"allowed: {FEWEST_BLOCKS * BLOCK_TIME:g} s or more. Move every joint to and fro")  # fmt: skip
        values[i], half[i] = _least_squares(X[known], friction[known, i], times[known])
        residual[known, i] = friction[known, i] - X[known] @ values[i]
    return values, half, residual


def _least_squares(X: Array, y: Array, times: Array) -> tuple[Array, Array]:
    """Values, friction not negative, and half widths of their 95 % intervals for errors that are alike within a block of time
    (sandwich covariance of clusters; Cameron and Miller 2015)."""
    scale = max(float(np.std(y)), 1e-6) / np.sqrt(BLOCK_TIME / WEIGHT_TIME)
    normal = X.T @ X + np.diag((scale / PRIOR) ** 2)
    free = np.ones(X.shape[1], bool)
    values = np.linalg.solve(normal, X.T @ y)
    for column in (COULOMB, VISCOUS):
        free[column] = values[column] > 0
    values = np.zeros(X.shape[1])
    values[free] = np.linalg.solve(normal[np.ix_(free, free)], X[:, free].T @ y)
    errors = y - X @ values
    blocks = np.unique(np.floor(times / BLOCK_TIME), return_inverse=True)[1]
    count = blocks.max() + 1
    sums = np.zeros((count, X.shape[1]))
    np.add.at(sums, blocks, X * errors[:, None])
    inverse = np.linalg.inv(normal)
    freedom = max(count - X.shape[1], 1)
    covariance = inverse @ (sums.T @ sums) @ inverse * count / freedom
    return values, np.asarray(stats.t.ppf(0.975, freedom) * np.sqrt(np.maximum(np.diag(covariance), 0)))
