"""Command line of palpate-calibrate."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Optional

import numpy as np

from palpate_calibrate import plan_output, report, section_output
from palpate_calibrate.camera import command as camera
from palpate_calibrate.configuration import Configuration, read_configuration
from palpate_calibrate.fit import Options, fit_wrist
from palpate_calibrate.friction import command as friction
from palpate_calibrate.log_input import read_logs
from palpate_calibrate.plan import Room, plan_poses
from palpate_calibrate.recording import Mounting, Recording
from palpate_calibrate.residual_plot import plot_residuals
from palpate_calibrate.table_input import read_description
from palpate_common.command_line import Number, Parser, exit_code_of
from palpate_common.input_error import InputError
from palpate_common.json_output import write_json
from palpate_common.rotations import from_rpy
from palpate_common.section import read_section

PRESETS = Path(__file__).resolve().parents[1] / "presets"
LARGEST_ROOM = 0.1  # m, of the plan about its start without a configuration

TOP_DESCRIPTION = """Calibrates the set-up of an arm from recordings of its own motion, and of a camera that observes it.
"""
TOP_TAIL = """
Subcommands:
  wrist                       Load, bias and mounting of a wrist's force-torque sensor and inertial unit, and their delays
  friction                    Friction of the joints of an arm whose joint torques replace a force-torque sensor
  camera                      Pose of a depth camera in the robot's base, by touches, by the hand in clouds, or by a marker

Examples:
  palpate-calibrate wrist run.control.lcmlog --config my_robot.yaml --output wrist.yaml
  palpate-calibrate friction run.control.lcmlog --config my_robot.yaml --output friction.yaml
  palpate-calibrate camera --touches touches.csv --output camera.yaml
Exit codes: 0   done
            1   an error, or a recording that cannot be used
            64  wrong command line
            78  wrong configuration or description; the message names file, key, value and what is allowed
"""
DESCRIPTION = """Identifies what a wrist's force-torque sensor carries: mass, centre of mass and inertia of the load, the sensor's bias, its
rotation in the flange, that of the inertial unit, and the delay of each stream relative to the robot's pose, each with a
95 % interval. Names what the recording does not determine, and a motion that would. Nothing may be held or touched.
"""
TAIL = f"""
A recording is one or more LCM logs with ROBOT_STATE, FT_WRENCH and, where present, IMU (palpate-record), a YAML description of
CSV files (tools/calibrate/README.md), or one of the presets {' '.join(sorted(f.stem for f in PRESETS.glob('*.yaml')))}, with --data.
Move the hand through the poses of --plan at 0.3 to 0.5 rad/s for one to two minutes, with quick small turns in between.

Examples:
  palpate-calibrate wrist --plan --config my_robot.yaml --start 0.6 0 0.5 0 90 0 --picture plan.png
  palpate-record --seconds 100 run
  palpate-calibrate wrist run.control.lcmlog --config my_robot.yaml --output wrist.yaml --picture wrist.png
  palpated --config wrist.yaml --check
  palpate-calibrate wrist ft_static_ati --data recordings --json -
Exit codes: 0   done
            1   an error, or a recording that cannot be used
            64  wrong command line
            78  wrong configuration or description; the message names file, key, value and what is allowed
"""


def wrist_parser() -> Parser:
    parser = Parser("palpate-calibrate wrist", DESCRIPTION, "[OPTIONS] [recording...]", TAIL)
    parser.add_argument("recording", nargs="*", help="LCM logs, a description (.yaml), or the name of a preset")
    parser.add_argument("--config", help="configuration of palpated: mounting, gravity and gate; the result is a change of it")
    parser.add_argument("--arm", type=int, choices=[0, 1], default=0, help="index of the arm; 1: the second one")
    parser.add_argument("--data", help="folder of the files that a description names; default: that of the description")
    parser.add_argument("--clock", choices=["received", "sent"], default="received",
                        help="times of an LCM log: of reception, which palpated acts on, or the senders'")  # fmt: skip
    parser.add_argument("--drift", choices=["none", "linear", "walk"], default="linear",
                        help="of the bias over the recording")  # fmt: skip
    parser.add_argument("--no-pose-errors", action="store_true",
                        help="residuals do not depend on the pose: there are no cables; narrower intervals")  # fmt: skip
    parser.add_argument("--unknown-gravity", action="store_true", help="the direction of gravity in the base is sought, too")
    parser.add_argument("--output", help="file for the YAML that palpated reads")
    parser.add_argument("--picture", help="file for a picture (PNG): residuals, or the poses of --plan")
    parser.add_argument("--json", help="file for the results as JSON; - for standard output")
    parser.add_argument("--plan", action="store_true",
                        help="choose poses instead: those that determine the parameters best")  # fmt: skip
    parser.add_argument("--start", type=float, nargs=6,
                        help="of --plan: pose of the flange in the base, x y z in m, roll pitch yaw in degrees")  # fmt: skip
    parser.add_argument("--poses", type=Number(4, 60, whole=True), default=12, help="of --plan: number of poses, 4 to 60")
    parser.add_argument("--tilt", type=Number(10, 180), default=70.0,
                        help="of --plan: largest rotation from the start, degrees, 10 to 180")  # fmt: skip
    parser.add_argument("--mass", type=Number(0.01, 100), default=1.0, help="of --plan: about that of the load, kg, 0.01 to 100")
    return parser


def _read(options: argparse.Namespace, configuration: Optional[Configuration]) -> tuple[Recording, Mounting, bool]:
    """Recording, mounting, and whether gravity's direction is unknown."""
    first = Path(options.recording[0])
    description = first if first.suffix in (".yaml", ".yml") else PRESETS / f"{first}.yaml"
    if first.suffix in (".yaml", ".yml") or (not first.is_file() and description.is_file()):
        is_preset = description is not first
        folder = Path(options.data) if options.data else description.parent
        if is_preset and not options.data:
            raise InputError(f"{first}: a preset; --data names the folder of its files")
        if is_preset and (folder / first.name).is_dir():
            folder = folder / first.name
        described = read_description(read_section(description), folder)
        return described.recording, described.mounting, described.gravity_is_unknown or options.unknown_gravity
    gravity = np.array([0, 0, -9.81]) if configuration is None else configuration.gravity
    mounting = Mounting() if configuration is None else configuration.mounting
    if configuration is None:  # without a drawing the positions are not known either
        mounting.sensor_position_deviation = mounting.imu_position_deviation = 0.1
    return read_logs(options.recording, options.arm, options.clock, gravity), mounting, options.unknown_gravity


def _room(options: argparse.Namespace, configuration: Optional[Configuration]) -> Room:
    start = np.array(options.start[:3])
    lower, upper = start - LARGEST_ROOM, start + LARGEST_ROOM
    if configuration is not None and configuration.gate.has("workspace"):
        workspace = configuration.gate.section("workspace")
        lowest, highest = workspace.numbers("lower", 3, -100, 100), workspace.numbers("upper", 3, -100, 100)
        if (start < lowest).any() or (start > highest).any():
            configuration.gate.fail("workspace", f"the start {start.tolist()} is outside; allowed: {lowest} to {highest}")
        lower, upper = np.maximum(lower, lowest), np.minimum(upper, highest)
    return Room(start, from_rpy(np.radians(options.start[3:])), lower, upper, np.radians(options.tilt))


def _plan(options: argparse.Namespace, configuration: Optional[Configuration]) -> None:
    room = _room(options, configuration)
    R_ES, gravity, center = np.eye(3), np.array([0, 0, -9.81]), np.array([0, 0, 0.1])
    if configuration is not None:
        gravity = configuration.gravity
        R_ES = R_ES if configuration.mounting.sensor_rotation is None else configuration.mounting.sensor_rotation
    plan = plan_poses(room, options.poses, options.mass, center, R_ES, gravity)
    if options.output:
        plan_output.write_yaml(plan, Path(options.output))
    if options.picture:
        plan_output.plot_plan(plan, room, Path(options.picture))
    if options.json:
        write_json(plan_output.document(plan), options.json)
    if options.json != "-":
        print(plan_output.table(plan))


def _fit(options: argparse.Namespace, configuration: Optional[Configuration]) -> None:
    recording, mounting, is_tilted = _read(options, configuration)
    fit = fit_wrist(recording, mounting, Options(options.drift, not options.no_pose_errors, is_tilted))
    if options.output:
        section_output.write_section(fit, Path(options.output), configuration)
    if options.picture:
        plot_residuals(fit, Path(options.picture))
    if options.json:
        write_json(report.summary(fit), options.json)
    if options.json != "-":
        print(report.table(fit))


def wrist(words: list[str]) -> int:
    """Returns the exit code. Raises InputError and OSError."""
    parser = wrist_parser()
    options = parser.parse_args(words)
    if options.plan == bool(options.recording):
        parser.error("a recording, or --plan without one, is required")
    if options.plan and options.start is None:
        parser.error("--plan: --start is required")
    configuration = read_configuration(Path(options.config), options.arm) if options.config else None
    (_plan if options.plan else _fit)(options, configuration)
    return 0


def main(words: list[str], version: str) -> int:
    top = Parser("palpate-calibrate", TOP_DESCRIPTION, "[OPTIONS] SUBCOMMAND", TOP_TAIL)
    top.add_argument("--version", action="version", version=version, help="Display program version information and exit")
    subcommands = {"wrist": wrist, "friction": friction.main, "camera": camera.main}
    if words and words[0] in subcommands:
        return exit_code_of("palpate-calibrate", lambda: subcommands[words[0]](words[1:]))
    top.parse_args(words)
    top.error(f"a subcommand is required; allowed: {', '.join(subcommands)}")
