"""Error of the camera's configured pose."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate_common.section import Section
from palpate_see.cloud import Floats

WITHIN_95 = 2.795  # standard deviations of each of three axes: the length that 95 % of normal vectors do not exceed


@dataclass(frozen=True)
class CameraError:
    """Lengths that 95 % of the errors do not exceed, of any direction. position: of C's origin, m. angle: rad.

    The defaults are the goals of palpate-calibrate camera.
    """

    position: float = 0.002
    angle: float = float(np.radians(0.2))

    @property
    def position_deviation(self) -> float:
        """Standard deviation of each axis, m."""
        return self.position / WITHIN_95

    @property
    def angle_deviation(self) -> float:
        """Standard deviation about each axis, rad."""
        return self.angle / WITHIN_95

    def deviation(self, points_C: Floats) -> Floats:
        """(n,), m, of each coordinate in W of points, (n, 3), m, in C: at most, namely across the viewing ray."""
        result: Floats = np.hypot(self.position_deviation, self.angle_deviation * np.linalg.norm(points_C, axis=1))
        return result


def read_camera_error(section: Section) -> CameraError:
    """Of section `camera_error`. Raises InputError."""
    usual = CameraError()
    made = CameraError(
        section.number("position", 1e-5, 0.1, usual.position),
        float(np.radians(section.number("angle_deg", 1e-3, 10, np.degrees(usual.angle)))),
    )
    section.check_unused()
    return made
