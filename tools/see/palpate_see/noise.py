"""Standard deviation of measured depths by distance."""

from __future__ import annotations

from dataclasses import dataclass

from palpate_common.section import Section
from palpate_see.cloud import Floats


@dataclass(frozen=True)
class NoiseModel:
    """Along the optical axis of a surface seen from the front, m: base + growth (z - nearest)^2.

    The defaults are those of the first Kinect: Nguyen, Izadi and Lovell 2012, "Modeling Kinect sensor noise for improved 3D
    reconstruction and tracking", eq. 2.
    """

    base: float = 0.0012  # m
    growth: float = 0.0019  # 1/m
    nearest: float = 0.4  # m

    def deviation(self, depths: Floats) -> Floats:
        """(n,) m of depths, (n,), m."""
        return self.base + self.growth * (depths - self.nearest) ** 2


def read_noise(section: Section) -> NoiseModel:
    """Of section `noise`. Raises InputError."""
    kinect = NoiseModel()
    model = NoiseModel(
        section.number("base", 1e-5, 0.1, kinect.base),
        section.number("growth", 0, 1, kinect.growth),
        section.number("nearest", 0, 10, kinect.nearest),
    )
    section.check_unused()
    return model
