"""Registration: global search, refinement, covariance, symmetries, test of the fit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate_common.pose import Pose, covariance_at, difference
from palpate_common.surface import Surface
from palpate_common.undetermined import undetermined_directions
from palpate_register.goodness_of_fit import Verdict, test_fit
from palpate_register.observations import Observations
from palpate_register.refine import Refined, refine
from palpate_register.search import coarse_search
from palpate_register.symmetry import Symmetries, find_symmetries

Floats = NDArray[np.float64]
OTHER_WITHIN = 4.0  # loss: poses that are less likely than the best by up to e^4 are named
SAME_START = 0.1  # rad, and of the object's size: coarse poses that lead to the same end


@dataclass(frozen=True, eq=False)
class Registration:
    """Result."""

    pose: Pose  # X_WO
    covariance: Floats  # (6, 6), of (position of the object's centre, m; rotation, rad), axes of W
    refined: Refined
    symmetries: Symmetries
    others: list[Pose]  # other poses that explain the points nearly as well, no symmetry among them
    verdict: Verdict
    center: Floats  # (3,), m, of the object, in W

    def covariance_of_origin(self) -> Floats:
        """(6, 6), of (position of O, m; rotation, rad), axes of W: of `frames.object_in_base`."""
        return covariance_at(self.covariance, self.pose.p - self.center)

    @property
    def deviations(self) -> Floats:
        """(6,), m and rad, of the centre's position and the rotation, axes of W."""
        result: Floats = np.sqrt(np.diag(self.covariance))
        return result

    @property
    def undetermined(self) -> list[str]:
        """Directions in W that the points do not determine, in words."""
        return undetermined_directions(self.covariance)


def _without_free_turn(final: Refined, symmetries: Symmetries) -> Floats:
    """Covariance, (6, 6); a turn about an axis of full symmetry changes nothing and has none."""
    axis = symmetries.free_axis()
    if axis is None:
        return final.covariance
    turn = np.zeros(len(final.information))
    turn[3:6] = final.state.pose.R @ axis
    known = final.information + 1e12 * np.outer(turn, turn)
    result: Floats = np.linalg.inv(known)[:6, :6]
    return result


def register(surface: Surface, observed: Observations, starts: int = 300, keep: int = 16, seed: int = 0,
             symmetries: Symmetries | None = None) -> Registration:  # fmt: skip
    """Pose of a surface in W from touches, a cloud, or both.

    starts: of the coarse search. keep: of its best poses, how many are refined. Among poses that the
    object's symmetry makes alike, the one nearest to the guess, or to the axes of W, is given.
    Raises ValueError for fewer than three points without a guess.
    """
    if len(observed.points) < (1 if observed.guess else 3):
        raise ValueError("at least three points are needed, or a guess and one point")
    symmetries = symmetries or find_symmetries(surface)
    thin = observed
    if observed.cloud is not None:
        thin = Observations(observed.touches, observed.cloud.thinned(150), observed.guess)
    found: list[Refined] = []
    tried: list[Pose] = []
    for start in coarse_search(surface, observed, starts, seed)[: 10 * keep]:
        if len(tried) >= keep:
            break
        # Poses that the symmetry makes alike have the same loss, but for the guess.
        alike = [start] if observed.guess else symmetries.equivalents(start)
        if all(_distance(pose, other, surface) > SAME_START for pose in alike for other in tried):
            tried.append(start)
            found.append(refine(surface, start, thin, steps=12, widenings=(10.0, 2.0, 1.0)))
    found.sort(key=lambda one: one.cost)
    best = found[0]
    reference = observed.guess.pose if observed.guess else Pose(np.eye(3), np.zeros(3))
    chosen = symmetries.nearest(best.state.pose, reference)
    final = refine(surface, type(best.state)(chosen, best.state.shift, best.state.turn), observed)
    covariance = _without_free_turn(final, symmetries)
    covariance[:3, :3] += observed.touches.common_deviation**2 * np.eye(3)
    verdict = test_fit(surface, final, observed)
    if verdict.freedom > 0:  # errors larger than stated widen the intervals; smaller ones do not narrow them
        covariance = covariance * max(1.0, verdict.chi_square / verdict.freedom)
    pose = final.state.pose
    others: list[Pose] = []
    for one in found[1:]:
        pair = symmetries.nearest(one.state.pose, pose)
        is_other = all(_is_apart(pair, known, covariance, surface) for known in [pose, *others])
        if one.cost < best.cost + OTHER_WITHIN and is_other:
            others.append(pair)
    center = pose.of(surface.center[None])[0]
    return Registration(pose, covariance, final, symmetries, others, verdict, center)


def _distance(a: Pose, b: Pose, surface: Surface) -> float:
    """Relative to the object's size: of two poses, 1."""
    step = difference(a, b, surface.center)
    return float(np.linalg.norm(step[:3]) / surface.largest_side + np.linalg.norm(step[3:]))


def _is_apart(a: Pose, b: Pose, covariance: Floats, surface: Surface) -> bool:
    """Whether a pose lies outside the other's uncertainty, by more than five deviations."""
    step = difference(a, b, surface.center)
    return float(step @ np.linalg.solve(covariance, step)) > 25
