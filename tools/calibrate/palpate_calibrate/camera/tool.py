"""The robot's own tool in clouds of the camera: joint fit over several poses of the flange."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from palpate_calibrate.camera.camera_fit import CameraFit
from palpate_calibrate.camera.depth_error import DepthError
from palpate_calibrate.camera.flange_poses import ArmError, error_groups, moved_flanges
from palpate_calibrate.camera.least_squares import Group, estimate, minimised
from palpate_common.input_error import InputError
from palpate_common.pose import Pose, moved
from palpate_common.surface import Surface, gradients

Floats = NDArray[np.float64]
FEWEST_VIEWS, FEWEST_POINTS = 3, 30
MOST_POINTS = 100  # of a cloud: more cost time, and neighbours do not err independently
COARSE_POINTS = 60  # of a cloud, while the start is far
COARSE, FINE = (30.0, 10.0), (3.0, 1.0)  # widenings of the loss meanwhile, and then
AROUND = 0.02  # m: points farther from the tool than this, after the coarse fit, belong to something else


@dataclass(frozen=True, eq=False)
class ToolClouds:
    """What was recorded. Raises InputError where too little of the tool is seen."""

    source: str  # file, for messages
    tool: Surface  # in E
    flanges: list[Pose]  # X_WE as reported
    clouds: list[Floats]  # (n, 3) each, m, in C
    guess: Pose  # X_WC
    reach: float  # m: points farther from the tool, by the guess, are left out
    error: DepthError
    arm: ArmError

    def __post_init__(self) -> None:
        if len(self.clouds) < FEWEST_VIEWS:
            raise InputError(f"{self.source}: {len(self.clouds)} clouds; allowed: {FEWEST_VIEWS} or more")

    def near(self, camera: Pose, reach: float, most: int) -> list[Floats]:
        """Of each cloud at most `most` points, evenly over the file's order, within `reach`, m, of the tool."""
        found = []
        for k, (flange, cloud) in enumerate(zip(self.flanges, self.clouds)):
            # Far more than are kept are not looked at: a camera delivers hundreds of thousands.
            some = cloud[_evenly(len(cloud), 40 * most)]
            in_E = flange.inverse_of(camera.of(some))
            lower, upper = self.tool.nodes.min(axis=0) - reach, self.tool.nodes.max(axis=0) + reach
            inside = ((in_E > lower) & (in_E < upper)).all(axis=1)
            some, in_E = some[inside], in_E[inside]
            chosen = _evenly(len(some), 3 * most)
            some, in_E = some[chosen], in_E[chosen]
            feet = self.tool.closest(in_E)[0] if len(some) else in_E
            some = some[np.linalg.norm(in_E - feet, axis=1) < reach]
            if len(some) < FEWEST_POINTS:
                raise InputError(f"{self.source}: cloud {k + 1}: {len(some)} points within {reach:g} m of the tool where "
                                 f"--guess places it; allowed: {FEWEST_POINTS} or more")  # fmt: skip
            found.append(some[_evenly(len(some), most)])
        return found


def _evenly(count: int, most: int) -> NDArray[np.int64]:
    if count == 0:
        return np.zeros(0, np.int64)
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(np.int64))


@dataclass(frozen=True, eq=False)
class ToolState:
    """Parameters."""

    camera: Pose  # X_WC
    errors: Floats  # (k, 6), of the arm: position, m, and rotation, rad, axes of W


class ToolProblem:
    """Distances of all points from the tool's surface, and the arm's errors."""

    leading = 6

    def __init__(self, seen: ToolClouds, points: list[Floats]) -> None:
        self._seen = seen
        self._points = np.concatenate(points)
        self._view = np.repeat(np.arange(len(points)), [len(some) for some in points])
        self._rays = self._points / np.linalg.norm(self._points, axis=1, keepdims=True)
        self.count = 6 + 6 * len(points)

    def groups(self, state: ToolState) -> list[Group]:
        """Derivatives by the step of `moved` about C's origin, and of each flange's pose about E's."""
        flanges, n = moved_flanges(self._seen.flanges, state.errors), len(self._points)
        R_WE, p_WE = (np.array([getattr(flange, name) for flange in flanges])[self._view] for name in ("R", "p"))
        points_W = state.camera.of(self._points)
        points_E = np.einsum("nji,nj->ni", R_WE, points_W - p_WE)
        feet, chosen = self._seen.tool.closest(points_E)
        distance, g_E = gradients(points_E, feet, self._seen.tool.normals[chosen])
        g = np.einsum("nij,nj->ni", R_WE, g_E)
        along = np.einsum("ni,ni->n", g, self._rays @ state.camera.R.T) ** 2
        error = self._seen.error
        deviation = np.sqrt(along * error.along(self._points) ** 2 + (1 - along) * error.across(self._points) ** 2)
        J = np.zeros((n, self.count))
        J[:, :6] = np.hstack([g, np.cross(points_W - state.camera.p, g)])
        columns = 6 + 6 * self._view[:, None] + np.arange(6)
        J[np.arange(n)[:, None], columns] = -np.hstack([g, np.cross(points_W - p_WE, g)])
        of_cloud = Group("distance from the tool", distance / deviation, J / deviation[:, None], 1e3 * deviation, "mm",
                         True, True)  # fmt: skip
        return [of_cloud, *error_groups(state.errors, self._seen.arm, 6, self.count)]

    def stepped(self, state: ToolState, step: Floats) -> ToolState:
        """The arm's rotations are so small that they add up."""
        return ToolState(moved(state.camera, step[:6], np.zeros(3)), state.errors + step[6:].reshape(-1, 6))


def fit_tool(seen: ToolClouds) -> CameraFit:
    """X_WC by all clouds together."""
    zero = np.zeros((len(seen.clouds), 6))
    state = ToolState(seen.guess, zero)
    coarse = ToolProblem(seen, seen.near(seen.guess, seen.reach, COARSE_POINTS))
    one = {group.name: 1.0 for group in coarse.groups(state)}
    for widening in COARSE:
        state = minimised(coarse, state, one, widening, free=6)
    fine = ToolProblem(seen, seen.near(state.camera, AROUND, MOST_POINTS))
    found = estimate(fine, replace(state, errors=zero), FINE)
    assert isinstance(found.state, ToolState)
    return CameraFit("tool", seen.source, found.state.camera, found)
