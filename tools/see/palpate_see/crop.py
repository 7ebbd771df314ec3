"""The box that contains the object."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate_common.section import Section
from palpate_see.cloud import Floats, Mask

FARTHEST = 100.0  # m


@dataclass(frozen=True, eq=False)
class Crop:
    """lower, upper: corners, (3,), m, in W."""

    lower: Floats
    upper: Floats

    def keeps(self, points: Floats) -> Mask:
        """(n,) of points in W, (n, 3), m: whether they are inside."""
        result: Mask = ((points >= self.lower) & (points <= self.upper)).all(axis=1)
        return result


def read_crop(section: Section) -> Crop:
    """Of section `crop`. Raises InputError."""
    lower = section.numbers("lower", 3, -FARTHEST, FARTHEST)
    upper = section.numbers("upper", 3, -FARTHEST, FARTHEST)
    if not all(low < high for low, high in zip(lower, upper)):
        section.fail("upper", f"{upper}; allowed: above lower, {lower}")
    section.check_unused()
    return Crop(np.array(lower), np.array(upper))
