"""The object's colour, regardless of brightness."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate_common.section import Section
from palpate_see.cloud import Floats, Mask

DARK = 0.06  # sum of red, green and blue below which a point has no colour


@dataclass(frozen=True, eq=False)
class ColourRange:
    """rgb: (3,), from 0 to 1. tolerance: largest distance of chromaticities, the shares of red, green and blue in their sum,
    as in section `camera` of a scene of palpate-sim."""

    rgb: Floats
    tolerance: float

    def keeps(self, colours: Floats) -> Mask:
        """(n,) of colours, (n, 3), from 0 to 1: whether they are the object's. Points that are almost black are not."""
        sums = colours.sum(axis=1)
        shares = colours / np.maximum(sums, 1e-9)[:, None]
        distance = np.linalg.norm(shares - self.rgb / self.rgb.sum(), axis=1)
        result: Mask = (sums > DARK) & (distance <= self.tolerance)
        return result


def read_colour(section: Section) -> ColourRange:
    """Of section `colour`. Raises InputError."""
    rgb = section.numbers("rgb", 3, 0, 1)
    if sum(rgb) <= DARK:
        section.fail("rgb", f"{rgb}; allowed: a sum above {DARK:g}, since black has no hue")
    made = ColourRange(np.array(rgb), section.number("tolerance", 0.001, 1, 0.09))
    section.check_unused()
    return made
