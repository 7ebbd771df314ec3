"""How far a measured point may lie from where it was measured."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Union

import numpy as np

from palpate_see.camera_error import CameraError
from palpate_see.cloud import Floats
from palpate_see.noise import NoiseModel

# Standard deviations of a margin: of what differs from point to point, beyond which one of 30 000 points of a surface lies,
# and of what all points have in common.
EACH, COMMON = 4.0, 3.0


def margin_of(noise: Floats, place: Floats) -> Floats:
    """(n,), m: how far from a surface points may be that were measured on it.

    noise, place: standard deviations of each point, and of the surface's place as the camera sees it there, (n,), m.
    """
    result: Floats = np.hypot(EACH * noise, COMMON * place)
    return result


@dataclass(frozen=True)
class PointError:
    """Of the measured depth, and of the camera's configured pose, which all points of a cloud have in common."""

    noise: NoiseModel
    camera: CameraError

    def in_base(self, points_C: Floats) -> Floats:
        """(n,), m: standard deviation of each coordinate in W of points, (n, 3), m, in C."""
        result: Floats = np.hypot(self.noise.deviation(points_C[:, 2]), self.camera.deviation(points_C))
        return result

    def common_deviation(self, points_C: Floats) -> float:
        """m: one for all points, (n, 3), m, in C, n > 0: the root of the mean variance."""
        return float(np.sqrt(np.mean(self.in_base(points_C) ** 2)))

    def margins(self, points_C: Floats, surface: Union[Floats, float]) -> Floats:
        """(n,), m: how far from a surface points, (n, 3), m, in C, may be that were measured on it.

        surface: standard deviation of its configured place there, (n,) or one for all, m.
        """
        return margin_of(self.noise.deviation(points_C[:, 2]), np.hypot(self.camera.deviation(points_C), surface))

    def margins_of_fit(self, points_C: Floats) -> Floats:
        """(n,), m: the same of a surface that was found in the cloud itself, with the camera's error in common."""
        return EACH * self.noise.deviation(points_C[:, 2])
