"""Command line of palpate-calibrate camera."""

from __future__ import annotations

import argparse
from pathlib import Path

from palpate_calibrate.camera import defaults
from palpate_calibrate.camera.marker_images import DICTIONARIES
from palpate_common.command_line import Number, Parser, PositionAndAngle

DESCRIPTION = """Measures where a depth camera stands: its pose X_WC in the robot's base W, with a 6 x 6 covariance and 95 % intervals,
in one of three ways: by points that the robot touched and that were picked in the camera's cloud (--touches), by the
robot's own hand in clouds at several poses of the flange (--tool), or by an ArUco marker on the flange in images
(--marker).
C: z forwards, x right, y down. Lengths in m; quaternions w first.
"""
TAIL = """
--touches: CSV whose first line names the columns x,y,z (touched, in W: the probe's tip at contact less its radius)
and u,v,w (the same point picked in C). Ten points or more, spread over the workspace in all three directions, on
faces, not on edges. With --cloud (PLY, PCD, XYZ or NPY, in C) a pick's depth is that of the plane through the cloud
around it, which errs less.
--poses: CSV with the columns file (a cloud of --tool or an image of --marker, relative to the CSV),
x,y,z,qw,qx,qy,qz: pose of the flange in W, at rest. Ten or more, over the whole workspace, with rotations of 30
degrees or more about all axes.
--tool: mesh in the flange's frame (STL, OBJ, Gmsh), with what is bolted to it; clouds in C, of the whole scene or of
the hand alone. Needs --guess: about 30 mm and 3 degrees suffice.
--marker: its number in the dictionary; where it sits on the flange is sought, too. --intrinsics: YAML with fx, fy,
cx, cy (pixels) and optionally distortion: [k1, k2, p1, p2, k3]. C is the frame of the images: take those of the depth
camera itself (infrared), or colour images to which the depths are registered. Needs python3-opencv. A marker on a
known place instead of the flange: --marker-in-base; one image then suffices, and --poses needs the column file only.
Stated deviations are starting values: the residuals correct them. What all poses of the arm have in common cannot be
found: the pose is that in the base as the arm reports it.
--output: YAML with camera_in_base; with --scene a scene of palpate-sim with this camera.

Examples:
  palpate-calibrate camera --touches touches.csv --cloud scene.ply --output camera.yaml --picture camera.png
  palpate-calibrate camera --tool hand.stl --poses clouds.csv --guess 1.1 -0.7 0.8 -130 0 40 --output camera.yaml
  palpate-calibrate camera --marker 0 --marker-size 0.08 --intrinsics lens.yaml --poses images.csv --json -
Exit codes: 0   done
            1   an error, or measurements that do not determine the pose (then no file is written)
            64  wrong command line
            78  wrong intrinsics or scene; the message names file, key, value and what is allowed
"""
_COORDINATE, _DEVIATION, _ANGLE = Number(-360, 360), Number(1e-6, 0.1), Number(1e-3, 20)
# Options that each way requires, and ways that allow an option.
_REQUIRED = {"touches": (), "tool": ("poses", "guess"), "marker": ("poses", "marker_size", "intrinsics")}
_ALLOWED = {"cloud": ("touches",), "poses": ("tool", "marker"), "guess": ("tool", "marker"), "marker_size": ("marker",),
            "intrinsics": ("marker",), "marker_in_base": ("marker",)}  # fmt: skip


def camera_parser() -> Parser:
    parser = Parser("palpate-calibrate camera", DESCRIPTION, "[OPTIONS]", TAIL)
    add = parser.add_argument
    add("--touches", type=Path, help="CSV of touched and picked points")
    add("--cloud", type=Path, help="of --touches: cloud in C, from which the picks' depths are taken")
    add("--tool", type=Path, help="mesh of the hand in the flange's frame")
    add("--marker", type=Number(0, 1023, whole=True), help="number of an ArUco marker, 0 to 1023")
    add("--poses", type=Path, help="of --tool and --marker: CSV of clouds or images and poses of the flange")
    add("--guess", type=_COORDINATE, nargs=6, help="X_WC: position, m, roll, pitch, yaw, degrees; required by --tool")
    add("--reach", type=Number(0.005, 1), default=defaults.REACH,
        help="of --tool: points farther from the tool at the guess are left out, m, 0.005 to 1")  # fmt: skip
    add("--pick-radius", type=Number(1e-3, 0.1), default=defaults.PICK_RADIUS,
        help="of --cloud: around a pick, of the points that give its depth, m, 0.001 to 0.1")  # fmt: skip
    add("--marker-size", type=Number(1e-3, 2), help="side of the marker's black square, m, 0.001 to 2; required by --marker")
    add("--marker-size-error", type=Number(1e-5, 0.1), default=defaults.SIDE_ERROR,
        help="its relative standard deviation, as printed, 1e-05 to 0.1")  # fmt: skip
    add("--dictionary", choices=DICTIONARIES, default=DICTIONARIES[0], help="of the marker")
    add("--intrinsics", type=Path, help="of --marker: YAML of the camera's intrinsics")
    add("--marker-in-base", type=_COORDINATE, nargs=6,
        help="X_WM of a marker that the arm does not carry: position, m, roll, pitch, yaw, degrees; M: x right, y up, "
             "z towards the viewer")  # fmt: skip
    add("--marker-place-error", default=list(defaults.PLACE), action=PositionAndAngle, position=_DEVIATION, angle=_ANGLE,
        help="of --marker-in-base: standard deviations of each axis, m and degrees")  # fmt: skip
    add("--touch-deviation", type=_DEVIATION, default=defaults.TOUCH_DEVIATION,
        help="standard deviation of each axis of a touched point, m, 1e-06 to 0.1")  # fmt: skip
    add("--depth-deviation", type=_DEVIATION, nargs=2, default=[defaults.DEPTH.along_at_1_m, defaults.DEPTH.across_at_1_m],
        help="of a point 1 m in front of the camera, along and across the viewing ray, m, 1e-06 to 0.1")  # fmt: skip
    add("--pixel-deviation", type=Number(1e-3, 10), default=defaults.CORNER_DEVIATION,
        help="of a marker's corner, pixels, 0.001 to 10")  # fmt: skip
    add("--arm-deviation", default=[defaults.ARM.position, defaults.ARM_DEGREES],
        action=PositionAndAngle, position=_DEVIATION, angle=_ANGLE,
        help="of the flange's pose, the part that varies from pose to pose: each axis, m and degrees")  # fmt: skip
    add("--output", type=Path, help="file for the YAML with camera_in_base")
    add("--scene", type=Path, help="scene of palpate-sim: --output is a change of it with this camera")
    add("--json", help="file for the results as JSON; - for standard output")
    add("--picture", type=Path, help="file for a picture (PNG) of the residuals")
    return parser


def parse(words: list[str]) -> argparse.Namespace:
    """Options that agree with each other; ends with 64 otherwise."""
    parser = camera_parser()
    options = parser.parse_args(words)
    ways = [name for name in ("touches", "tool", "marker") if getattr(options, name) is not None]
    if len(ways) != 1:
        parser.error("exactly one of --touches, --tool and --marker is required")
    options.way = ways[0]
    for name in _REQUIRED[options.way]:
        if getattr(options, name) is None:
            parser.error(f"--{options.way}: --{name.replace('_', '-')} is required")
    for name, allowed in _ALLOWED.items():
        if options.way not in allowed and getattr(options, name) is not None:
            parser.error(f"--{name.replace('_', '-')}: allowed with {' and '.join(f'--{way}' for way in allowed)} only")
    if options.scene is not None and options.output is None:
        parser.error("--scene: --output is required")
    if options.picture and options.picture.suffix.lower() != ".png":
        parser.error(f"--picture: {options.picture}; allowed: a name that ends in .png")
    return options


def main(words: list[str]) -> int:
    """Returns the exit code. Raises InputError and OSError."""
    options = parse(words)
    from palpate_calibrate.camera.program import run

    return run(options)
