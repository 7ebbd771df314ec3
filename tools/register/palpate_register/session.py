"""Touch after touch: each one is proposed from the estimate by all earlier ones."""

from __future__ import annotations

from typing import Optional

import numpy as np
from numpy.typing import NDArray

from palpate_common.surface import Surface
from palpate_register.next_touch import Reach, Touch, next_touches
from palpate_register.observations import Cloud, Guess, Observations, Touches, no_touches
from palpate_register.refine import Refined, refine
from palpate_register.residuals import State, start_at

Floats = NDArray[np.float64]
FEW = 5  # touches up to which the guess, too, is a start of the refinement
WIDE = (100.0, 10.0, 1.0)  # of the loss: a new touch may be far from where it was expected


class Session:
    """Collects touches of one object and keeps an estimate of its pose.

    guess: of the pose. deviation, normal_deviation: of a touch, m and rad. state: where to begin,
    such as the registration of the cloud alone.
    """

    def __init__(self, surface: Surface, guess: Guess, reach: Reach, deviation: float, normal_deviation: float,
                 cloud: Optional[Cloud] = None, state: Optional[State] = None) -> None:  # fmt: skip
        self._surface, self._guess, self._reach = surface, guess, reach
        self._deviation, self._normal_deviation = deviation, normal_deviation
        self._cloud = None if cloud is None else cloud.thinned(150)
        self.touches = no_touches()
        self._state = state or start_at(guess.pose)
        self.estimate = self._refined()

    def propose(self, of_position: bool = False, count: int = 1) -> list[Touch]:
        """The next touches, the best first (see `next_touches`)."""
        return next_touches(self._surface, self.estimate.state.pose, self.estimate.covariance, self._deviation,
                            self._normal_deviation, self._reach, of_position=of_position, count=count,
                            seed=len(self.touches))  # fmt: skip

    def add(self, point: Floats, normal: Floats) -> None:
        """A touched point, (3,), m, and its outward normal, (3,), in W, as measured."""
        old = self.touches
        self.touches = Touches(np.vstack([old.points, point]), np.vstack([old.normals, normal]),
                               np.append(old.deviation, self._deviation), self._normal_deviation)  # fmt: skip
        self.estimate = self._refined()
        self._state = self.estimate.state

    def _refined(self) -> Refined:
        observed = Observations(self.touches, self._cloud, self._guess)
        best = refine(self._surface, self._state, observed, steps=12, widenings=WIDE)
        if self._cloud is None and 0 < len(self.touches) <= FEW:
            other = refine(self._surface, self._guess.pose, observed, steps=12, widenings=WIDE)
            best = min(best, other, key=lambda one: one.cost)
        return best
