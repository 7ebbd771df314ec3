"""A marker on the flange, or on a known place, in images: joint fit of reprojection errors."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Optional

import numpy as np
from numpy.typing import NDArray

from palpate_calibrate.camera.camera_fit import CameraFit
from palpate_calibrate.camera.closed_form import eye_to_hand, pose_of_square
from palpate_calibrate.camera.flange_poses import ArmError, error_groups, moved_flanges
from palpate_calibrate.camera.intrinsics import Intrinsics
from palpate_calibrate.camera.least_squares import Group, estimate
from palpate_common.input_error import InputError
from palpate_common.pose import Pose, difference, moved
from palpate_common.rotations import cross_matrix

Floats = NDArray[np.float64]
FEWEST_ON_FLANGE = 4  # images
# Corners of a marker of side 1, in the order of OpenCV's detector: seen from the front, clockwise from the upper left.
# Frame M: x right, y up, z out of the marker.
CORNERS = np.array([[-0.5, 0.5, 0], [0.5, 0.5, 0], [0.5, -0.5, 0], [-0.5, -0.5, 0]])


@dataclass(frozen=True)
class KnownPlace:
    """X_WM of a marker that the arm does not carry, with deviations of each axis, m and rad."""

    pose: Pose
    position_deviation: float
    rotation_deviation: float


@dataclass(frozen=True, eq=False)
class SeenMarker:
    """What was detected. Raises InputError for too few images."""

    source: str  # file, for messages
    intrinsics: Intrinsics
    corners: list[Floats]  # (4, 2) each, undistorted pixels, in the order of CORNERS
    flanges: list[Pose]  # X_WE as reported; of a known place the identity
    side: float  # m
    side_deviation: float  # m
    pixel_deviation: float  # of each coordinate of a corner
    arm: ArmError
    place: Optional[KnownPlace] = None  # absent: on the flange, at an unknown pose

    def __post_init__(self) -> None:
        least = 1 if self.place else FEWEST_ON_FLANGE
        if len(self.corners) < least:
            raise InputError(f"{self.source}: the marker is found in {len(self.corners)} images; allowed: {least} or more")


@dataclass(frozen=True, eq=False)
class MarkerState:
    """Parameters."""

    camera: Pose  # X_WC
    marker: Pose  # X_EM; of a known place X_WM
    side: float  # m
    errors: Floats  # (k, 6), of the arm: position, m, and rotation, rad, axes of W


class MarkerProblem:
    """Reprojection errors of all corners, the marker's size, and the arm's errors or those of the known place."""

    leading = 12

    def __init__(self, seen: SeenMarker) -> None:
        self._seen = seen
        self.count = 13 if seen.place else 13 + 6 * len(seen.corners)

    def groups(self, state: MarkerState) -> list[Group]:
        """Derivatives by camera (6), marker (6), side (1, relative), and the arm's errors (6 of each image)."""
        seen = self._seen
        rows, r = [], []
        in_M = state.side * CORNERS
        in_E = state.marker.of(in_M)
        for k, flange in enumerate(moved_flanges(seen.flanges, state.errors)):
            in_W = flange.of(in_E)
            in_C = state.camera.inverse_of(in_W)
            r.append((seen.intrinsics.projected(in_C) - seen.corners[k]).ravel())
            z = in_C[:, 2]
            by_point = np.zeros((4, 2, 3))
            by_point[:, 0, 0], by_point[:, 1, 1] = seen.intrinsics.fx / z, seen.intrinsics.fy / z
            by_point[:, 0, 2], by_point[:, 1, 2] = -by_point[:, 0, 0] * in_C[:, 0] / z, -by_point[:, 1, 1] * in_C[:, 1] / z
            A = by_point @ state.camera.R.T  # by the point in W
            of_E = A @ flange.R
            J = np.zeros((4, 2, self.count))
            J[:, :, 0:3], J[:, :, 3:6] = -A, A @ cross_matrix(in_W - state.camera.p)
            J[:, :, 6:9], J[:, :, 9:12] = of_E, -of_E @ cross_matrix(in_E - state.marker.p)
            J[:, :, 12] = np.einsum("cij,cj->ci", of_E, in_E - state.marker.p)
            if seen.place is None:
                columns = 13 + 6 * k
                J[:, :, columns : columns + 3], J[:, :, columns + 3 : columns + 6] = A, -A @ cross_matrix(in_W - flange.p)
            rows.append(J.reshape(8, -1))
        deviation = np.full(8 * len(rows), seen.pixel_deviation)
        corners = Group("corners", np.concatenate(r) / deviation, np.concatenate(rows) / deviation[:, None], deviation, "px",
                        True, True, 2)  # fmt: skip
        if seen.place is None:
            return [corners, self._size(state), *error_groups(state.errors, seen.arm, 13, self.count)]
        return [corners, self._size(state), self._of_place(state, seen.place)]

    def _size(self, state: MarkerState) -> Group:
        seen, J = self._seen, np.zeros((1, self.count))
        J[0, 12] = seen.side / seen.side_deviation
        r = np.array([seen.side * np.log(state.side / seen.side) / seen.side_deviation])
        return Group("marker's side", r, J, np.array([1e3 * seen.side_deviation]), "mm", False, False)

    def _of_place(self, state: MarkerState, place: KnownPlace) -> Group:
        deviation = np.repeat([place.position_deviation, place.rotation_deviation], 3)
        J = np.zeros((6, self.count))
        J[:, 6:12] = np.diag(1 / deviation)
        r = difference(state.marker, place.pose, np.zeros(3)) / deviation
        unit = np.repeat([1e3, np.degrees(1)], 3)
        return Group("marker's place", r, J, unit * deviation, "mm, degree", False, False)

    def stepped(self, state: MarkerState, step: Floats) -> MarkerState:
        """The side's step is relative; the arm's rotations are so small that they add up."""
        errors = state.errors + step[13:].reshape(-1, 6) if len(step) > 13 else state.errors
        zero = np.zeros(3)
        return MarkerState(moved(state.camera, step[:6], zero), moved(state.marker, step[6:12], zero),
                           state.side * float(np.exp(step[12])), errors)  # fmt: skip


def start_state(seen: SeenMarker, guess: Optional[Pose]) -> MarkerState:
    """From the guess of X_WC, or from closed forms alone."""
    in_C = [pose_of_square(seen.intrinsics.rays(corners), seen.side * CORNERS) for corners in seen.corners]
    zero = np.zeros((len(in_C), 6))
    if seen.place is not None:
        return MarkerState(guess or seen.place.pose.times(in_C[0].inverse()), seen.place.pose, seen.side, zero)
    camera, marker = eye_to_hand(seen.flanges, in_C)
    return MarkerState(guess or camera, marker, seen.side, zero)


def fit_marker(seen: SeenMarker, guess: Optional[Pose] = None) -> CameraFit:
    """X_WC by all images together."""
    found = estimate(MarkerProblem(seen), start_state(seen, guess))
    state = found.state
    assert isinstance(state, MarkerState)
    name = "marker_in_base" if seen.place else "marker_in_flange"
    return CameraFit("marker", seen.source, state.camera, found, {name: state.marker})
