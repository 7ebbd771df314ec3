"""Each way of the calibration applied to one draw: its errors and intervals."""

from __future__ import annotations

from typing import Any, Callable

import numpy as np
from numpy.typing import NDArray

import drawn_camera
import simulated_marker
import simulated_tool
import simulated_touches
from palpate_calibrate.camera.camera_fit import CameraFit
from palpate_calibrate.camera.defaults import ARM, CORNER_DEVIATION, DEPTH, PICK_RADIUS, REACH, SIDE_ERROR, TOUCH_DEVIATION
from palpate_calibrate.camera.intrinsics import Intrinsics
from palpate_calibrate.camera.marker import SeenMarker, fit_marker
from palpate_calibrate.camera.marker_images import MarkerDetector
from palpate_calibrate.camera.pick_file import with_depths_of
from palpate_calibrate.camera.tool import ToolClouds, fit_tool
from palpate_calibrate.camera.touches import PickedTouches, fit_touches
from palpate_common.pose import Pose
from palpate_common.rotations import log_rotation
from palpate_common.surface import Surface

Floats = NDArray[np.float64]


def _pose(frame: drawn_camera.Frame) -> Pose:
    return Pose(frame.R.as_matrix(), frame.p)


def by_touches(camera: drawn_camera.Frame, guess: drawn_camera.Frame, random: np.random.Generator) -> CameraFit:
    """30 touches, whose picks' depths come from the cloud; no guess is needed."""
    recording = simulated_touches.record(camera, random)
    picked = PickedTouches("draw", recording.touched, recording.picked, TOUCH_DEVIATION, DEPTH)
    return fit_touches(with_depths_of(recording.cloud, picked, PICK_RADIUS)[0])


def by_tool(camera: drawn_camera.Frame, guess: drawn_camera.Frame, random: np.random.Generator) -> CameraFit:
    """14 clouds of the hand, from the guess."""
    recording = simulated_tool.record(camera, random)
    tool = Surface(*simulated_tool.hand_mesh())
    flanges = [_pose(flange) for flange in recording.flanges]
    return fit_tool(ToolClouds("draw", tool, flanges, recording.clouds, _pose(guess), REACH, DEPTH, ARM))


def by_marker(camera: drawn_camera.Frame, guess: drawn_camera.Frame, random: np.random.Generator) -> CameraFit:
    """20 images of a marker at an unknown place on the flange; no guess is needed."""
    recording = simulated_marker.record(camera, random)
    detector = MarkerDetector("4x4_50", 0)
    found = [(detector.corners(image), flange) for image, flange in zip(recording.images, recording.flanges)]
    corners, flanges = [c for c, _ in found if c is not None], [_pose(flange) for c, flange in found if c is not None]
    intrinsics = Intrinsics(drawn_camera.FOCAL, drawn_camera.FOCAL, drawn_camera.WIDTH / 2, drawn_camera.HEIGHT / 2)
    side = simulated_marker.SIDE
    return fit_marker(SeenMarker("draw", intrinsics, corners, flanges, side, SIDE_ERROR * side, CORNER_DEVIATION, ARM))


WAYS: dict[str, Callable[..., CameraFit]] = {"touches": by_touches, "tool": by_tool, "marker": by_marker}


def score(way: str, seed: int) -> dict[str, Any]:
    """Of one draw: error of the position of C, m, and of the rotation, rad, in W, half widths of the 95 % intervals and
    standard deviations of the same; at_work: distance, m, between the found and the true place of what C sees in the
    workspace's middle."""
    random = np.random.default_rng([seed, *way.encode()])
    camera, guess = drawn_camera.draw_camera(random)
    fit = WAYS[way](camera, guess, random)
    error = np.concatenate([fit.pose.p - camera.p, log_rotation(fit.pose.R @ camera.R.as_matrix().T)])
    middle = drawn_camera.MIDDLE
    at_work = fit.pose.of(fit.pose.inverse_of(middle[None])) - fit.pose.of(camera.back(middle[None]))
    return {"error": error.tolist(), "half_width": fit.half_widths.tolist(),
            "deviation": np.sqrt(np.diag(fit.covariance)).tolist(), "at_work": float(np.linalg.norm(at_work))}  # fmt: skip
