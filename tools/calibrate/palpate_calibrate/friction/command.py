"""Command line of palpate-calibrate friction."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from palpate_calibrate.friction import output
from palpate_calibrate.friction.configuration import JointTorqueConfiguration, read_configuration
from palpate_calibrate.friction.friction_fit import Torques, fit_friction
from palpate_common.command_line import Parser
from palpate_common.input_error import InputError
from palpate_common.json_output import write_json

DESCRIPTION = """Identifies the friction of an arm's joints from its joint torques: Coulomb and viscous friction of each joint and the rotation
over which friction builds up, each with a 95 % interval; also the offset of each torque, an error of the modelled weight, and
the noise of the external torque that palpated's observer finds. The arm moves freely: nothing is held or touched.
"""
TAIL = """
A recording is one or more LCM logs with ROBOT_STATE (palpate-record), of a minute or more, in which every joint turns to and fro
several times at different speeds. The configuration has the section robot, with the arm's URDF, and a sensor model joint_torque.
--output writes a configuration whose base is that one, with `friction` and `joint_deviation` of the sensor model.

Examples:
  palpate-record --seconds 90 run
  palpate-calibrate friction run.control.lcmlog --config my_robot.yaml --output friction.yaml --picture friction.png
  palpated --config friction.yaml --check
Exit codes: 0   done
            1   an error, or a recording that cannot be used
            64  wrong command line
            78  wrong configuration; the message names file, key, value and what is allowed
"""


def friction_parser() -> Parser:
    parser = Parser("palpate-calibrate friction", DESCRIPTION, "[OPTIONS] recording...", TAIL)
    parser.add_argument("recording", nargs="+", help="LCM logs")
    parser.add_argument("--config", required=True, help="configuration of palpated: arm, load and gravity; the result is a change of it")
    parser.add_argument("--output", help="file for the YAML that palpated reads")
    parser.add_argument("--picture", help="file for a picture (PNG) of measured friction and residuals")
    parser.add_argument("--json", help="file for the results as JSON; - for standard output")
    return parser


def read_torques(paths: list[str], configuration: JointTorqueConfiguration) -> Torques:
    """Raises InputError."""
    try:
        import palpate
    except ImportError as error:
        raise InputError(f"LCM logs need the Python package palpate: {error}; remedy: apt-get install python3-palpate") from error
    named = ", ".join(paths)
    try:
        log = palpate.read_log(*paths, clock="sent")
    except (OSError, ValueError) as error:
        raise InputError(f"{named}: {error}") from error
    if "ROBOT_STATE" not in log:
        raise InputError(f"{named}: no ROBOT_STATE; the log has: {', '.join(log.channels) or 'nothing'}")
    states, count = log["ROBOT_STATE"], len(configuration.arm.joints)
    if (states.joint_count != count).any():
        raise InputError(f"{named}: ROBOT_STATE.joint_count: {states.joint_count[0]}; allowed: {count}, as the URDF has")
    values = {name: np.asarray(getattr(states, name))[:, :count] for name in ("q", "dq", "tau")}
    for name, array in values.items():
        if not np.isfinite(array).all():
            raise InputError(f"{named}: ROBOT_STATE.{name}: not finite at {states.time[~np.isfinite(array).all(axis=1)][0]:.3f} s")
    if not values["tau"].any():
        raise InputError(f"{named}: ROBOT_STATE.tau: 0 throughout; the arm reports no joint torques")
    return Torques(named, states.time, values["q"], values["dq"], configuration.polarity * values["tau"])


def main(words: list[str]) -> int:
    """Returns the exit code. Raises InputError and OSError."""
    options = friction_parser().parse_args(words)
    configuration = read_configuration(Path(options.config))
    fit = fit_friction(read_torques(options.recording, configuration), configuration.arm, configuration.bandwidth)
    if options.output:
        output.write_section(fit, Path(options.output), configuration)
    if options.picture:
        output.plot_residuals(fit, Path(options.picture))
    if options.json:
        write_json(output.summary(fit), options.json)
    if options.json != "-":
        print(output.table(fit))
    return 0
