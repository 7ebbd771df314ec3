"""Points that are far from their neighbours: flying pixels, dust, remains of what else was removed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from palpate_common.section import Section
from palpate_see.cloud import Floats, Mask


@dataclass(frozen=True)
class OutlierFilter:
    """neighbours: number of nearest neighbours of which the mean distance is taken.

    deviations: how many standard deviations above the mean of all points that distance may be. largest: m, above which a
    point is removed whatever the others are.
    """

    neighbours: int = 12
    deviations: float = 2.0
    largest: float = 0.03

    def keeps(self, points: Floats) -> Mask:
        """(n,) of points, (n, 3), m. None of no more than `neighbours` points is kept."""
        if len(points) <= self.neighbours:
            return np.zeros(len(points), bool)
        distances, _ = cKDTree(points).query(points, self.neighbours + 1)
        means = distances[:, 1:].mean(axis=1)
        result: Mask = means <= min(self.largest, float(means.mean() + self.deviations * means.std()))
        return result


def read_outliers(section: Section) -> OutlierFilter:
    """Of section `outliers`. Raises InputError."""
    usual = OutlierFilter()
    made = OutlierFilter(
        section.whole("neighbours", 1, 100, usual.neighbours),
        section.number("deviations", 0.1, 100, usual.deviations),
        section.number("largest", 1e-4, 10, usual.largest),
    )
    section.check_unused()
    return made
