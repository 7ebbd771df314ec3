"""Result of each way of calibrating a camera."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from palpate_calibrate.camera.least_squares import Estimate, Group
from palpate_common.pose import Pose
from palpate_common.undetermined import undetermined_directions

Floats = NDArray[np.float64]
OUTLIER = 0.5  # weight below which a residual counts as gross error


@dataclass(frozen=True, eq=False)
class CameraFit:
    """Pose of the camera with what determined it. C: z forwards, x right, y down, as in the camera's images."""

    way: str  # touches, tool, marker
    source: str  # file
    pose: Pose  # X_WC
    estimate: Estimate  # its first six parameters are those of X_WC
    others: dict[str, Pose] = field(default_factory=dict)  # further poses that were sought, by name

    @property
    def covariance(self) -> Floats:
        """(6, 6), of (position of C's origin, m; rotation, rad), axes of W."""
        return self.estimate.covariance[:6, :6]

    @property
    def half_widths(self) -> Floats:
        """(6,), m and rad, of the 95 % intervals of the same."""
        return self.estimate.half_widths[:6]

    @property
    def undetermined(self) -> list[str]:
        """Directions in W that the measurements do not determine, in words."""
        return undetermined_directions(self.covariance)

    def residuals(self, group: Group) -> Floats:
        """(n,), in the group's unit."""
        result: Floats = group.r * group.deviation
        return result

    def deviation(self, group: Group) -> float:
        """As estimated, in the group's unit; of the middle measurement, where they differ."""
        return float(np.median(group.deviation)) * self.estimate.factors[group.name]

    def gross(self, group: Group) -> NDArray[np.int64]:
        """Indices, (k,), of residuals with little weight."""
        return np.flatnonzero(self.estimate.weights[group.name] < OUTLIER)
