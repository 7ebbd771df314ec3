"""Whether the mesh fits what was measured: chi-square test, and the scale that would fit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Optional

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from palpate_common.surface import Surface
from palpate_register.observations import Observations
from palpate_register.refine import Refined, refine

Floats = NDArray[np.float64]
GROSS = 5.0  # standard deviations: beyond it a touch is a gross error
LEAST_P = 0.01  # probability below which the mesh does not fit
SCALES = (0.5, 2.0)
LEAST_SQUARES = 1e4  # widening of the loss that leaves all weights 1
TRIMMED = 0.1  # share of a cloud's distances that is left out
# Share of the sum of squares of a normal distribution that the others have: 0.9 - 2 z phi(z), z = 1.645.
KEPT = 0.561


@dataclass(frozen=True, eq=False)
class Verdict:
    """Result of the test."""

    fits: Optional[bool]  # None: too few points to say
    chi_square: float
    freedom: int
    p: float
    gross: list[int]  # touches, from 0, that are left out as gross errors
    scale: Optional[float] = None  # of the object relative to the mesh, if that was estimated
    scale_deviation: float = np.nan
    fits_scaled: bool = False  # with that scale
    text: str = ""


def distances(refined: Refined, observed: Observations) -> tuple[Floats, Floats]:
    """Normalised distances of touches and cloud to the surface."""
    n = len(observed.touches)
    r = refined.at.r
    return r[:n], r[n : n + (0 if observed.cloud is None else len(observed.cloud.points))]


def _chi_square(refined: Refined, observed: Observations, parameters: int) -> tuple[float, int, list[int]]:
    r, of_cloud = distances(refined, observed)
    gross = np.flatnonzero(np.abs(r) > GROSS)
    if len(gross) > max(1, len(r) // 6):
        gross = gross[:0]
    total = float((np.delete(r, gross) ** 2).sum())
    freedom = len(r) - len(gross) - parameters
    if observed.cloud is not None:
        # The largest tenth of the distances may belong to other things.
        size = np.sort(np.abs(of_cloud))[: max(1, int((1 - TRIMMED) * len(of_cloud)))]
        total += float(size @ size) / KEPT
        freedom += min(observed.cloud.independent, len(of_cloud))
    return total, freedom, gross.tolist()


def _fit_scale(surface: Surface, refined: Refined, observed: Observations) -> tuple[float, float, Refined]:
    """Scale about the centre, its deviation, and the refinement at that scale."""
    # Least squares: at a wrong scale most distances would look like gross errors.
    log_scale, at = 0.0, surface
    now = refine(surface, refined.state, observed, widenings=(LEAST_SQUARES,))
    deviation = np.inf
    for _ in range(10):
        n = len(now.at.feet)
        center = now.state.pose.of(surface.center[None])
        J = np.hstack([now.at.J, np.zeros((len(now.at.r), 1))])
        # A foot moves by (foot - centre) per unit of the scale's logarithm.
        J[:n, -1] = np.einsum("ij,ij->i", now.at.J[:n, :3], now.at.feet - center)
        H = J.T @ J + 1e-6 * np.eye(J.shape[1])
        step = float(-np.linalg.solve(H, J.T @ now.at.r)[-1])
        deviation = float(np.sqrt(np.linalg.inv(H)[-1, -1]))
        log_scale = float(np.clip(log_scale + np.clip(step, -0.2, 0.2), *np.log(SCALES)))
        at = surface.scaled(np.exp(log_scale))
        now = refine(at, now.state, observed, widenings=(LEAST_SQUARES,))
        if abs(step) < 0.01 * deviation:
            break
    now = refine(at, now.state, observed, widenings=(3.0, 1.0))
    scale = float(np.exp(log_scale))
    return scale, scale * deviation, now


def test_fit(surface: Surface, refined: Refined, observed: Observations) -> Verdict:
    """Compares squared distances with their deviations; names scale or object where they are too large.

    The sum of squared normalised distances at the best pose follows a chi-square distribution whose
    degrees of freedom are the distances less the pose's six parameters. A cloud counts as its
    independent points.
    """
    total, freedom, gross = _chi_square(refined, observed, 6)
    left_out = f"; touch {', '.join(str(i + 1) for i in gross)} left out as a gross error" if gross else ""
    if freedom < 1:
        return Verdict(None, total, freedom, np.nan, gross,
                       text=f"too few points to test whether the mesh fits (7 touches at least){left_out}")  # fmt: skip
    p = float(chi2.sf(total, freedom))
    numbers = f"chi-square {total:.1f} with {freedom} degrees of freedom, p = {p:.2g}"
    if p >= LEAST_P:
        return Verdict(True, total, freedom, p, gross, text=f"the mesh fits ({numbers}){left_out}")
    if freedom < 2:
        return Verdict(False, total, freedom, p, gross, text=f"the mesh does not fit ({numbers})")
    scale, deviation, scaled = _fit_scale(surface, refined, observed)
    total_s, freedom_s, gross_s = _chi_square(scaled, observed, 7)
    fits = bool(freedom_s >= 1 and chi2.sf(total_s, freedom_s) >= LEAST_P and abs(scale - 1) > 1.96 * deviation
                and SCALES[0] < scale < SCALES[1])  # fmt: skip
    if fits:
        meaning = (f"the object is {scale:.3f} +- {1.96 * deviation:.3f} (95 %) times as large as the mesh, "
                   "which then fits; check the mesh's unit and size")  # fmt: skip
    else:
        meaning = "no scale of it fits either: another object, a bent object, or larger errors than stated"
    return Verdict(False, total, freedom, p, gross, scale, deviation, fits,
                   f"the mesh does not fit ({numbers}): {meaning}")  # fmt: skip
