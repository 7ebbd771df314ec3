"""Offset between the clocks of two recordings, from two quantities that move together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
FINEST_STEP = 1e-3  # s, of the common grid
MOST_POINTS = 200000  # of the grid
SHORTEST_OVERLAP = 50  # points
LEAST_CORRELATION = 0.5
AMBIGUITY = 0.95  # of the largest correlation: another maximum of this height makes the offset ambiguous
LEAST_SIGNAL = 0.5  # share of the squared derivative that is not noise
COARSER = (1, 2, 4, 8)  # cells, in those of the samples
ITERATIONS = 20


class NotObservable(ValueError):
    """The message says why."""


class _Noisy(NotObservable):
    """The reference's derivative is mostly noise; means over longer cells may help."""


@dataclass(frozen=True)
class Offset:
    """seconds: to be added to the times of the first signal. deviation: s, standard. correlation: -1 to 1, at the offset."""

    seconds: float
    deviation: float
    correlation: float


@dataclass(frozen=True)
class Signal:
    """time: (n,), s, not decreasing. value: (n,)."""

    time: Floats
    value: Floats


def _averages(of: Signal, edges: Floats) -> Floats:
    """Means over the cells between edges, of straight lines between samples."""
    time, first = np.unique(of.time, return_index=True)
    value = of.value[first]
    area = np.concatenate([[0.0], np.cumsum(0.5 * (value[1:] + value[:-1]) * np.diff(time))])
    at = np.interp(edges, time, value)
    index = np.clip(np.searchsorted(time, edges, side="right") - 1, 0, len(time) - 2)
    within = area[index] + 0.5 * (value[index] + at) * (edges - time[index])
    return np.asarray(np.diff(within) / np.diff(edges))


def _grid(of: Signal, step: float) -> tuple[Floats, Floats]:
    """Centres of cells and the means over them."""
    first, last = np.ceil(of.time[0] / step), np.floor(of.time[-1] / step)
    edges = np.arange(first, last + 1) * step
    if len(edges) < SHORTEST_OVERLAP:
        raise NotObservable(f"{len(edges)} cells of {step:.3g} s; allowed: at least {SHORTEST_OVERLAP}")
    return 0.5 * (edges[1:] + edges[:-1]), _averages(of, edges)


def _correlations(a: Floats, b: Floats, lags: NDArray[np.int64]) -> Floats:
    """Of a[i] and b[i + lag] over the cells that both have; 0 where these are too few or one is constant."""
    made = np.zeros(len(lags))
    for k, lag in enumerate(lags):
        low, high = max(0, -lag), min(len(a), len(b) - lag)
        if high - low < max(SHORTEST_OVERLAP, 0.25 * min(len(a), len(b))):
            continue
        x, y = a[low:high], b[low + lag : high + lag]
        x, y = x - x.mean(), y - y.mean()
        size = np.sqrt((x @ x) * (y @ y))
        made[k] = x @ y / size if size > 0 else 0.0
    return made


def _lobe(size: Floats, top: int) -> tuple[int, int]:
    """Bounds of the maximum at `top`: where the correlation has fallen to its half."""
    below = np.flatnonzero(size < 0.5 * size[top])
    left, right = below[below < top], below[below > top]
    return (int(left[-1]) if left.size else 0), (int(right[0]) if right.size else len(size) - 1)


def fit_offset(moved: Signal, reference: Signal, within: float) -> Offset:
    """The seconds, -within to within, that make `moved` follow gain * reference + constant, by least squares. Raises NotObservable.

    The maximum of the correlation of both signals on a common grid is refined by Newton's method; the deviation allows for noise of
    both and for residuals that are correlated in time (Newey and West 1987)."""
    spacing = max(float(np.median(np.diff(signal.time))) if len(signal.time) > 2 else np.inf for signal in (moved, reference))
    longest = max(signal.time[-1] - signal.time[0] for signal in (moved, reference)) if np.isfinite(spacing) else 0.0
    if longest <= 0:
        raise NotObservable("a signal has fewer than three samples")
    finest = max(spacing, FINEST_STEP, longest / MOST_POINTS)
    for factor in COARSER:
        try:
            return _fitted(moved, reference, within, factor * finest)
        except _Noisy:
            if factor == COARSER[-1]:
                raise
    raise AssertionError


def _fitted(moved: Signal, reference: Signal, within: float, step: float) -> Offset:
    time_a, a = _grid(moved, step)
    time_b, b = _grid(reference, step)
    for name, values in (("the quantity", a), ("the one that it follows", b)):
        if np.ptp(values) <= 1e-9 * np.abs(values).max():
            raise NotObservable(f"{name} is constant")
    shift = int(round((time_a[0] - time_b[0]) / step))  # a[i] and b[i + shift] are at one time
    reach = int(np.ceil(within / step))
    lags = np.arange(-reach, reach + 1) + shift
    size = np.abs(_correlations(a, b, lags))
    top = int(size.argmax())
    if size[top] < LEAST_CORRELATION:
        raise NotObservable(f"the largest correlation of both is {size[top]:.2f}; allowed: at least {LEAST_CORRELATION}")
    if top in (0, len(lags) - 1) and within > step:
        raise NotObservable(f"the correlation is largest at the end of the range, {within:g} s")
    left, right = _lobe(size, top)
    others = np.concatenate([size[:left], size[right + 1 :]])
    if others.size and others.max() > AMBIGUITY * size[top]:
        other = int(np.where((np.arange(len(size)) < left) | (np.arange(len(size)) > right), size, 0).argmax())
        raise NotObservable(f"two offsets fit alike, {(lags[top] - shift) * step:.3f} and {(lags[other] - shift) * step:.3f} s")
    return _refined(time_a, a, time_b, b, (lags[top] - shift) * step, step, float(size[top]))


def _refined(time_a: Floats, a: Floats, time_b: Floats, b: Floats, start: float, step: float, correlation: float) -> Offset:
    """Newton's method for the sum of squares of a(t) - gain * b(t + offset) - constant."""
    from scipy.interpolate import CubicSpline

    curve = CubicSpline(time_b, b)
    offset = start
    for _ in range(ITERATIONS):
        inside = (time_a + offset >= time_b[0]) & (time_a + offset <= time_b[-1])
        at = time_a[inside] + offset
        regressors = np.column_stack([curve(at), np.ones(len(at))])
        gain, constant = np.linalg.lstsq(regressors, a[inside], rcond=None)[0]
        residual = a[inside] - regressors @ [gain, constant]
        J = np.column_stack([gain * curve(at, 1), regressors])
        # Noise of b is in its derivative, too, where it enlarges J^T J; the second derivatives cancel that.
        hessian = J.T @ J
        hessian[0, 0] -= gain * (curve(at, 2) @ residual)
        hessian[0, 1] -= curve(at, 1) @ residual
        hessian[1, 0] = hessian[0, 1]
        if not (np.all(np.linalg.eigvalsh(hessian) > 0) and hessian[0, 0] > LEAST_SIGNAL * (J[:, 0] @ J[:, 0])):
            raise _Noisy(f"the sum of squares has no clear minimum near {start:.3f} s")
        change = float(np.clip(np.linalg.solve(hessian, J.T @ residual)[0], -step, step))
        offset += change
        if abs(change) < 1e-9:
            break
    if abs(offset - start) > 3 * step:
        raise NotObservable(f"the fit leaves the maximum of the correlation, {start:.3f} s, for {offset:.3f} s")
    return Offset(offset, _deviation(J * residual[:, None], hessian, _memory(residual)), float(np.sign(gain) * correlation))


def _deviation(scores: Floats, hessian: Floats, memory: int) -> float:
    """Of the first parameter. scores: (n, k), of each cell. memory: cells over which they may be correlated."""
    count, width = scores.shape
    middle = scores.T @ scores
    lags = int(min(count // 4, max(4, 4 * (count / 100) ** (2 / 9), memory)))
    for lag in range(1, lags + 1):
        products = scores[lag:].T @ scores[:-lag]
        middle += (1 - lag / (lags + 1)) * (products + products.T)
    inverse = np.linalg.inv(hessian)
    return float(np.sqrt(max(0.0, count / max(1, count - width) * (inverse @ middle @ inverse)[0, 0])))


def _memory(residual: Floats) -> int:
    """Cells over which residuals are alike: twice the distance at which their correlation has fallen to a half."""
    centred = residual - residual.mean()
    total = float(centred @ centred)
    lag = 1
    while lag < len(centred) // 8 and total > 0 and float(centred[lag:] @ centred[:-lag]) > 0.5 * total:
        lag += 1
    return 2 * lag
