"""Which points were measured on the configured obstacles."""

from __future__ import annotations

from typing import Mapping

import numpy as np

from palpate_common.pose import Pose
from palpate_see.cloud import Floats, Mask
from palpate_see.obstacles import Obstacle
from palpate_see.point_error import PointError
from palpate_see.shapes import HalfSpace, PlacedShape, within
from palpate_see.support_plane import fitted_plane


class ObstacleFilter:
    """Of the camera at X_WC. Obstacles that messages move, and those on a link without pose, are left out."""

    def __init__(self, obstacles: list[Obstacle], X_WC: Pose, error: PointError) -> None:
        self._obstacles = [obstacle for obstacle in obstacles if not obstacle.is_moved]
        self._X_WC, self._error = X_WC, error

    def removes(self, points_C: Floats, everything: Floats, poses: Mapping[str, Pose]) -> Mask:
        """(n,) of points, (n, 3), m, in C: whether they are nearer to an obstacle than their margin.

        everything: all that was seen, (k, 3), m, in C, in which half-spaces are sought. poses: X_WL by link.
        """
        result: Mask = np.zeros(len(points_C), bool)
        points = self._X_WC.of(points_C)
        for obstacle in self._obstacles:
            if obstacle.link is None:
                result |= self._near(obstacle, obstacle.X, points_C, points, everything)
            elif obstacle.link in poses:
                result |= self._near(obstacle, poses[obstacle.link].times(obstacle.X), points_C, points, everything)
        return result

    def _near(self, obstacle: Obstacle, X_WS: Pose, points_C: Floats, points: Floats, everything: Floats) -> Mask:
        """points: points_C in W."""
        if isinstance(obstacle.shape, HalfSpace):
            seen = fitted_plane(obstacle, X_WS, everything, self._X_WC, self._error)
            if seen is not None:
                return within(points, [PlacedShape(obstacle.shape, seen)], self._error.margins_of_fit(points_C))
        lever = np.linalg.norm(points - X_WS.p, axis=1)
        surface = np.hypot(obstacle.position_deviation, obstacle.rotation_deviation * lever)
        return within(points, [PlacedShape(obstacle.shape, X_WS)], self._error.margins(points_C, surface))
