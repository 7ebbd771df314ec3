"""Joint angles at the moment of an exposure."""

from __future__ import annotations

from bisect import bisect_left
from typing import Optional, Sequence

import numpy as np

from palpate_see.cloud import Floats


class JointTrack:
    """The latest states of one group of joints.

    most_gap_us: between an exposure and the nearest state. at_rest: (k,), rad, which hold before any state; None: unknown.
    most_kept: number of states; beyond it the older half is discarded.
    """

    def __init__(self, most_gap_us: int, at_rest: Optional[Sequence[float]], most_kept: int) -> None:
        self._most_gap, self._most_kept = most_gap_us, most_kept
        self._at_rest = None if at_rest is None else np.array(at_rest, float)
        self._times: list[int] = []
        self._states: list[Floats] = []

    @property
    def has_states(self) -> bool:
        return bool(self._times)

    def add(self, utime: int, q: Sequence[float]) -> None:
        """A state, (k,), rad, at utime, us. One that is not later than the last is ignored."""
        if self._times and utime <= self._times[-1]:
            return
        self._times.append(utime)
        self._states.append(np.array(q, float))
        if len(self._times) > self._most_kept:
            del self._times[: self._most_kept // 2], self._states[: self._most_kept // 2]

    def at(self, utime: int) -> Optional[Floats]:
        """(k,), rad: linear between states, constant before the first and after the last; None if none is near enough."""
        if not self._times:
            return self._at_rest
        after = bisect_left(self._times, utime)
        near = [i for i in (after - 1, after) if 0 <= i < len(self._times)]
        if min(abs(self._times[i] - utime) for i in near) > self._most_gap:
            return None
        if len(near) == 1:
            return self._states[near[0]]
        begin, end = self._times[after - 1], self._times[after]
        share = (utime - begin) / (end - begin)
        return (1 - share) * self._states[after - 1] + share * self._states[after]
