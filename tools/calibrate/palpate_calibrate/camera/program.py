"""palpate-calibrate camera: from files to files."""

from __future__ import annotations

import argparse
import sys
from typing import Optional

import numpy as np

from palpate_calibrate.camera.camera_fit import CameraFit
from palpate_calibrate.camera.depth_error import DepthError
from palpate_calibrate.camera.flange_poses import ArmError, read_views
from palpate_calibrate.camera.intrinsics import read_intrinsics
from palpate_calibrate.camera.marker import KnownPlace, SeenMarker, fit_marker
from palpate_calibrate.camera.marker_images import MarkerDetector, read_image
from palpate_calibrate.camera.output import check_scene, yaml_text
from palpate_calibrate.camera.pick_file import read_picks, with_depths_of
from palpate_calibrate.camera.report import summary, table
from palpate_calibrate.camera.tool import ToolClouds, fit_tool
from palpate_calibrate.camera.touches import fit_touches
from palpate_common.cloud_files import read_cloud
from palpate_common.json_output import write_json
from palpate_common.mesh_files import read_surface
from palpate_common.pose import Pose
from palpate_common.rotations import from_rpy

NOT_DETERMINED = 1


def _pose(values: Optional[list[float]]) -> Optional[Pose]:
    """Of position, m, and roll, pitch, yaw, degrees."""
    return None if values is None else Pose(from_rpy(np.radians(values[3:])), np.array(values[:3]))


def _arm(options: argparse.Namespace) -> ArmError:
    return ArmError(options.arm_deviation[0], float(np.radians(options.arm_deviation[1])))


def _by_touches(options: argparse.Namespace) -> tuple[CameraFit, list[str]]:
    picked, notes = read_picks(options.touches, options.touch_deviation, DepthError(*options.depth_deviation)), []
    if options.cloud:
        picked, kept = with_depths_of(read_cloud(options.cloud), picked, options.pick_radius)
        if kept:
            numbers = ", ".join(str(i + 1) for i in kept)
            notes.append(f"Picks that keep their depth, since the cloud around them is no plane: {numbers}")
    return fit_touches(picked), notes


def _by_tool(options: argparse.Namespace) -> tuple[CameraFit, list[str]]:
    views, guess = read_views(options.poses), _pose(options.guess)
    assert guess is not None
    seen = ToolClouds(str(options.poses), read_surface(options.tool), [view.flange for view in views],
                      [read_cloud(view.path) for view in views], guess, options.reach, DepthError(*options.depth_deviation),
                      _arm(options))  # fmt: skip
    return fit_tool(seen), []


def _by_marker(options: argparse.Namespace) -> tuple[CameraFit, list[str]]:
    intrinsics, detector = read_intrinsics(options.intrinsics), MarkerDetector(options.dictionary, options.marker)
    place = _pose(options.marker_in_base)
    corners, flanges, without = [], [], []
    for view in read_views(options.poses, has_poses=place is None):
        found = detector.corners(read_image(view.path))
        if found is None:
            without.append(view.path.name)
        else:
            corners.append(intrinsics.undistorted(found))
            flanges.append(view.flange)
    known = None
    if place is not None:
        known = KnownPlace(place, options.marker_place_error[0], float(np.radians(options.marker_place_error[1])))
    side = options.marker_size
    seen = SeenMarker(str(options.poses), intrinsics, corners, flanges, side, options.marker_size_error * side,
                      options.pixel_deviation, _arm(options), known)  # fmt: skip
    notes = [f"The marker is not found in: {', '.join(without)}"] if without else []
    return fit_marker(seen, _pose(options.guess)), notes


def run(options: argparse.Namespace) -> int:
    """Returns the exit code. Raises InputError and OSError."""
    if options.scene is not None:
        check_scene(options.scene)
    fit, notes = {"touches": _by_touches, "tool": _by_tool, "marker": _by_marker}[options.way](options)
    if options.json:
        write_json(summary(fit, notes), options.json)
    if options.json != "-":
        print(table(fit, notes))
    if options.picture:
        from palpate_calibrate.camera.residual_picture import draw

        draw(fit, options.picture)
    if fit.undetermined:
        print("palpate-calibrate: the measurements do not determine the pose; no YAML is written" if options.output else
              "palpate-calibrate: the measurements do not determine the pose", file=sys.stderr)  # fmt: skip
        return NOT_DETERMINED
    if options.output:
        options.output.write_text(yaml_text(fit, options.scene, options.output), encoding="utf-8")
    return 0
