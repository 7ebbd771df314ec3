"""From a camera's cloud to the points of the object."""

from __future__ import annotations

from typing import Optional

import numpy as np

from palpate_see.cloud import Cloud, Mask, Observation
from palpate_see.configuration import Settings
from palpate_see.counters import Counters
from palpate_see.obstacle_filter import ObstacleFilter
from palpate_see.robot_body import Poses, RobotBody
from palpate_see.shapes import within
from palpate_see.timing import ExposureOrder


class Pipeline:
    """All steps in order, with counters of what each of them removed. body: None if the robot is not removed."""

    def __init__(self, settings: Settings, body: Optional[RobotBody] = None) -> None:
        self._settings, self._body = settings, body
        self._obstacles = ObstacleFilter(settings.obstacles, settings.X_WC, settings.error)
        self._order = ExposureOrder(settings.timing)
        self.counters = Counters()

    def process(self, cloud: Cloud, received: Optional[int] = None) -> Optional[Observation]:
        """What is published of a cloud; None if nothing is, which is counted. received: us, by this computer's clock."""
        clouds = self.counters.clouds
        clouds["received"] += 1
        self.counters.points["received"] += len(cloud.points)
        exposure = self._order.exposure(cloud.utime, received)
        refusal = self._order.refusal(exposure, received)
        if refusal is not None:
            clouds[refusal] += 1
            return None
        poses: Optional[Poses] = {} if self._body is None else self._body.link_poses(exposure)
        if poses is None:
            clouds["without_joints"] += 1
            return None
        observation = self._observe(_Remaining(cloud, self.counters), exposure, poses)
        clouds["too_few_points" if observation is None else "published"] += 1
        return observation

    def _observe(self, left: "_Remaining", exposure: int, poses: Poses) -> Optional[Observation]:
        settings = self._settings
        left.keep(np.isfinite(left.seen).all(axis=1), "not_finite")
        depths = left.seen[:, 2]
        left.keep((depths >= settings.nearest) & (depths <= settings.farthest), "range")
        everything = left.seen
        left.points = settings.X_WC.of(left.seen)
        if settings.crop is not None:
            left.keep(settings.crop.keeps(left.points), "crop")
        if settings.colour is not None and left.colours is not None:
            left.keep(settings.colour.keeps(left.colours), "colour")
        left.keep(~self._obstacles.removes(left.seen, everything, poses), "obstacles")
        if self._body is not None:
            margins = settings.error.margins(left.seen, self._body.options.deviation)
            left.keep(~within(left.points, self._body.placed(poses), margins), "robot")
        # Only now, since what was removed has edges with the object.
        at_edges = settings.edges.of_cloud(left.seen, everything) if left.at_edges is None else left.at_edges
        left.keep(~at_edges, "edges")
        if settings.outliers is not None:
            left.keep(settings.outliers.keeps(left.points), "outliers")
        chosen = np.zeros(len(left.points), bool)
        chosen[settings.thinning.chosen(left.points)] = True
        left.keep(chosen, "thinning")
        if len(left.points) < settings.least_points:
            self.counters.points["few"] += len(left.points)
            return None
        self.counters.points["published"] += len(left.points)
        return Observation(exposure, left.points, settings.error.common_deviation(left.seen))


class _Remaining:
    """What no step has removed yet. seen: points in C, (n, 3), m. points: the same in W once they are transformed."""

    def __init__(self, cloud: Cloud, counters: Counters) -> None:
        self.seen = self.points = cloud.points
        self.colours, self.at_edges = cloud.colours, cloud.at_edges
        self._counters = counters

    def keep(self, mask: Mask, reason: str) -> None:
        """Of (n,); the others are counted under `reason`."""
        self._counters.points[reason] += int(len(mask) - mask.sum())
        self.seen, self.points = self.seen[mask], self.points[mask]
        if self.colours is not None:
            self.colours = self.colours[mask]
        if self.at_edges is not None:
            self.at_edges = self.at_edges[mask]
