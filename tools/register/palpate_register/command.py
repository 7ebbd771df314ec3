"""Command line of palpate-register. Imports nothing slow, so that --help comes at once."""

from __future__ import annotations

import argparse
from pathlib import Path

from palpate_common.command_line import Number, Parser, PositionAndAngle, exit_code_of

DESCRIPTION = """palpate-register finds the pose of an object's mesh in the robot's base W from touched points, from
a camera's cloud, or from both, with its uncertainty, and writes it for palpated. It names the
object's symmetries, proposes the next touch, and says when the mesh does not fit."""

EPILOGUE = """Touches: CSV whose first line names the columns x,y,z, in m in W: the centre of the probe's tip at contact;
optionally nx,ny,nz, the outward normal of the surface (against the measured force, or against the
approach), which decides between neighbouring faces, and deviation, m. Cloud: PLY, PCD, XYZ or NPY, m, in
W by the camera's nominal pose, of the object alone.
The guess is frames.object_in_base of --config, or --guess; without one the search covers all poses.
Intervals hold in the base frame as the arm reports it: a shift that all touches have in common
moves the result, and what the hand then grasps, alike (--common-deviation adds it).

Examples:
  palpate-register --config bar.yaml --touches touches.csv --output registered.yaml --picture fit.png
  palpate-register --config bar.yaml --touches touches.csv --table 0.25     # says where to touch next
  palpate-register --mesh toy.msh --touches touches.csv --cloud seen.ply --json -
  palpate-register --box 0.06 0.06 0.06 --touches touches.csv --guess 0.6 0 0.3 0 0 0 --guess-range 0.05 20
palpated then reads registered.yaml, whose base is bar.yaml.
Exit codes: 0   done, and the mesh fits, or there are too few points to say
            1   an error of a file, or the mesh does not fit (then no configuration is written)
            64  wrong command line
            78  wrong configuration; the message names file, line, key, value and allowed values"""


_COORDINATE, _DISTANCE = Number(-100, 100), Number(1e-6, 10)
_DEVIATION, _ANGLE = Number(1e-6, 0.1), Number(0.01, 180)


def parser() -> Parser:
    """Of the command line."""
    made = Parser("palpate-register", DESCRIPTION, "[OPTIONS]", EPILOGUE)
    add = made.add_argument
    add("--config", type=Path, help="Configuration of palpated: its mesh and the guess of the pose")
    add("--mesh", type=Path, help="Instead: mesh in m, .msh (Gmsh 2.2, 4.1), .stl or .obj")
    add("--box", type=Number(1e-3, 10), nargs=3, help="Instead: box with a corner in O, edges in m")
    add("--touches", type=Path, help="CSV of touched points")
    add("--cloud", type=Path, help="Points that a camera sees: .ply, .pcd, .xyz or .npy")
    add("--guess", type=Number(-360, 360), nargs=6,
        help="Pose of the mesh in W: position of O, m, roll, pitch, yaw, degrees")  # fmt: skip
    add("--guess-range", default=[0.05, 20.0], action=PositionAndAngle, position=_DISTANCE, angle=_ANGLE,
        help="How far the object may be from the guess: each axis of its centre, m, and the angle, degrees")  # fmt: skip
    add("--no-guess", action="store_true", help="Search all poses, whatever the configuration states")
    add("--deviation", type=_DEVIATION, default=3e-4,
        help="Standard deviation of each axis of a touched point, m, independent")  # fmt: skip
    add("--normal-deviation", type=_ANGLE, default=10.0,
        help="Of each of the two angles of a normal, degrees")  # fmt: skip
    add("--common-deviation", type=Number(0, 0.1), default=0.0,
        help="Of each axis of a shift that all touches have in common, m")  # fmt: skip
    add("--probe-radius", type=Number(0, 0.1), default=0.0, help="Of the probe's tip, m")
    add("--cloud-deviation", type=_DEVIATION, default=1e-3,
        help="Standard deviation of a point of the cloud along the surface's normal, m")  # fmt: skip
    add("--camera-deviation", default=[0.02, 2.0], action=PositionAndAngle, position=_DISTANCE, angle=_ANGLE,
        help="Of the camera's error: each axis of a shift of the cloud, m, and of a rotation, degrees")  # fmt: skip
    add("--table", type=_COORDINATE, help="Height in W below which nothing is touched, m; nor is anything steeply from below")
    add("--next", type=Number(0, 20, whole=True), default=3, help="Number of touches to propose")
    add("--next-for", choices=("pose", "position"), default="pose", help="What they should determine")
    add("--starts", type=Number(10, 100000, whole=True),
        help="Starts of the global search (default: 150 with a guess, 400 without)")  # fmt: skip
    add("--seed", type=Number(0, 2**31, whole=True), default=0, help="Of the starts")
    add("--output", type=Path, help="YAML with frames.object_in_base and the filter's prior, for palpated")
    add("--json", help="All results as JSON; - for the standard output")
    add("--picture", type=Path, help="PNG of points, mesh and proposed touch")
    return made


def parse(words: list[str], version: str) -> argparse.Namespace:
    """Options that agree with each other; ends with 64 otherwise."""
    made = parser()
    made.add_argument("--version", action="version", version=version, help="Display program version information and exit")
    options = made.parse_args(words)
    meshes = [name for name in ("config", "mesh", "box") if getattr(options, name)]
    if len(meshes) != 1:
        made.error("exactly one of --config, --mesh and --box is needed")
    if not (options.touches or options.cloud):
        made.error("--touches, --cloud or both are needed")
    if options.guess and options.no_guess:
        made.error("--guess and --no-guess exclude each other")
    if options.picture and options.picture.suffix.lower() != ".png":
        made.error(f"--picture: {options.picture}; allowed: a name that ends in .png")
    return options


def main(words: list[str], version: str) -> int:
    """Returns the exit code."""
    options = parse(words, version)
    from palpate_register.program import run

    return exit_code_of("palpate-register", lambda: run(options))
