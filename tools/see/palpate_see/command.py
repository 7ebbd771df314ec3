"""Command line of palpate-see. Imports nothing slow, so that --help comes at once."""

from __future__ import annotations

import argparse
from pathlib import Path

from palpate_common.command_line import Number, Parser, exit_code_of

DESCRIPTION = """palpate-see publishes the object's points in a depth camera's clouds on SHAPE_OBSERVATION, for palpated.
It transforms each cloud to the robot's base W, removes what is not the object (by a box, a colour, the
configured obstacles, the robot's own geometry at its joint angles, distance from neighbours), and thins
the rest to at most 256 points with one standard deviation."""

EPILOGUE = """Without --log, --clouds and --images, clouds (drake/lcmt_point_cloud) and joint states are received and
observations published on LCM, until a signal. The configuration is YAML (tools/see/README.md). Clouds in
files: a folder whose names end in the exposure's time, us, such as cloud_1700000000000000.ply, or a CSV
list with the columns utime and file.
Once a second and at the end it prints how many clouds and points were removed, and why.

Examples:
  palpate-see --config see.yaml --check
  palpate-see --config see.yaml
  palpate-see --config see.yaml --log run.log --output seen.log
  palpate-see --config see.yaml --log clouds.log --joints sensors.log --output seen.log
  palpate-see --config see.yaml --clouds clouds --joints run.log --output seen.csv
  palpate-see --config see.yaml --images images.csv --output seen.log --json -
Exit codes: 0   done, or ended by a signal
            1   an error of a file, a message or the network
            64  wrong command line
            78  wrong configuration; the message names file, line, key, value and allowed values"""


def parser() -> Parser:
    """Of the command line."""
    made = Parser("palpate-see", DESCRIPTION, "[OPTIONS]", EPILOGUE)
    add = made.add_argument
    add("--config", type=Path, help="Configuration: the camera's pose, the steps and their limits; required")
    add("--check", action="store_true", help="Validate the configuration, and end")
    add("--log", type=Path, help="LCM log with clouds and joint states, instead of the network")
    add("--clouds", type=Path, help="Folder or CSV list of clouds: .ply, .pcd, .xyz or .npy, m, in the camera's frame")
    add("--images", type=Path, help="Folder or CSV list of depth images: .png of 16 bits or .npy")
    add("--joints", type=Path, help="LCM log with ROBOT_STATE and HAND_STATE at the times of --log, --clouds or --images")
    add("--output", type=Path, help="LCM log of the observations, or .csv; on the network in addition to publishing")
    add("--seconds", type=Number(0.1, 1e6), help="End after this time, s, on the network")
    add("--json", help="The counters at the end as JSON; - for the standard output")
    return made


def parse(words: list[str], version: str) -> argparse.Namespace:
    """Options that agree with each other; ends with 64 otherwise."""
    made = parser()
    made.add_argument("--version", action="version", version=version, help="Display program version information and exit")
    options = made.parse_args(words)
    sources = [f"--{name}" for name in ("log", "clouds", "images") if getattr(options, name)]
    if options.config is None:
        made.error("--config is required")
    if len(sources) > 1:
        made.error(f"{' and '.join(sources)} exclude each other")
    if sources and not options.output and not options.check:
        made.error(f"{sources[0]}: --output is required")
    if sources and options.seconds:
        made.error(f"--seconds and {sources[0]} exclude each other")
    if options.joints and not sources:
        made.error("--joints: is for --log, --clouds and --images")
    return options


def main(words: list[str], version: str) -> int:
    """Returns the exit code."""
    options = parse(words, version)
    from palpate_see.program import run

    return exit_code_of("palpate-see", lambda: run(options))
