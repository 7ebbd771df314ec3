"""What a configuration of palpated says about the arm and its component joint_torque."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Optional

import numpy as np

from palpate_calibrate.friction.arm_dynamics import ArmDynamics, Body, read_arm
from palpate_common.frames import rotation_and_position
from palpate_common.pose import Pose
from palpate_common.section import Section, plain, read_configuration_section


@dataclass
class JointTorqueConfiguration:
    file: Path
    arm: ArmDynamics
    polarity: float
    bandwidth: float  # Hz
    sensing: list[dict[str, Any]]  # all instances, as configured
    sensing_folder: Path  # to which names of files in `sensing` refer
    index: int  # of the component


def read_configuration(file: Path) -> JointTorqueConfiguration:
    """Raises InputError. palpated --check validates the rest of the file."""
    top = read_configuration_section(file)
    instances = top.sections("sensing", [])
    found = [i for i, item in enumerate(instances) if item.text("component", "") == "joint_torque"]
    if not found:
        top.fail("sensing", "no instance of joint_torque, whose friction is sought")
    sensor = instances[found[0]]
    if sensor.flag("external", False):
        sensor.fail("external", "true; allowed: false: external torques have no friction")
    robot, frames = top.section("robot"), top.optional("frames")
    gravity = np.array(frames.numbers("gravity_in_base", 3, -20, 20, [0, 0, -9.81]))
    R_ES, p_ES = rotation_and_position(frames.optional("sensor_in_flange"))
    urdf = robot.file_of("urdf").parent / robot.text("urdf")
    arm = read_arm(urdf, robot.text("flange", "flange"), gravity, _load(sensor, Pose(R_ES, p_ES)))
    return JointTorqueConfiguration(file, arm, sensor.number("polarity", -1, 1, 1), sensor.number("bandwidth_hz", 0.1, 200, 10.0),
                                    [plain(item.values) for item in instances], top.file_of("sensing").parent, found[0])  # fmt: skip


def _load(sensor: Section, X_ES: Pose) -> Optional[Body]:
    """In E; None: that of the URDF."""
    if not sensor.has("payload"):
        return None
    payload = sensor.section("payload")
    mass = payload.number("mass", 0, 1000)
    centre = np.array(payload.numbers("center_of_mass", 3, -2, 2, [0, 0, 0]))
    if payload.has("inertia"):
        xx, xy, xz, yy, yz, zz = payload.numbers("inertia", 6, -100, 100)
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    else:
        inertia = mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    return Body(mass, mass * centre, inertia).moved(X_ES)
