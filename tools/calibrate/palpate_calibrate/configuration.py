"""What a configuration of palpated says about a wrist."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from palpate_calibrate.recording import Mounting
from palpate_common.frames import rotation_and_position
from palpate_common.rotations import Array
from palpate_common.section import Section, plain, read_configuration_section

WRIST_COMPONENTS = ("ft_newton_euler", "ft_rnnob")


@dataclass
class Configuration:
    file: Path
    arm: int
    mounting: Mounting
    gravity: Array  # in W, m/s^2
    frames: Section  # as configured
    sensing: list[dict[str, Any]]  # all instances, as configured
    sensing_folder: Path  # to which names of files in `sensing` refer
    wrist: int  # index of the wrist's
    has_wrench_lag: bool
    gate: Section


def read_configuration(file: Path, arm: int) -> Configuration:
    """Raises InputError. palpated --check validates the rest of the file."""
    top = read_configuration_section(file)
    of_arm = top if arm == 0 else top.optional("second_arm")
    frames = of_arm.optional("frames")
    sensing = [plain(item.values) for item in top.sections("sensing", [])]
    wrists = [i for i, item in enumerate(sensing) if item.get("component") in WRIST_COMPONENTS and item.get("arm", 0) == arm]
    if not wrists:
        top.fail("sensing", f"no instance for arm {arm} of {', '.join(WRIST_COMPONENTS)}, which have a payload")
    R_ES, p_ES = rotation_and_position(frames.optional("sensor_in_flange"))
    R_EI, p_EI = rotation_and_position(frames.optional("imu_in_flange"))
    gravity = frames.numbers("gravity_in_base", 3, -20, 20, [0, 0, -9.81])
    if np.linalg.norm(gravity) < 1:
        frames.fail("gravity_in_base", f"{gravity}; allowed: a length of 1 m/s^2 or more")
    return Configuration(file, arm, Mounting(R_ES, False, p_ES, R_EI, p_EI), np.array(gravity), frames, sensing,
                         top.file_of("sensing").parent, wrists[0], top.optional("estimation").text("component", "") == "pose_wrench_filter",
                         of_arm.optional("gate"))  # fmt: skip
