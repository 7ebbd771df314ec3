"""What a configuration of palpated says about a wrist."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from palpate_calibrate.recording import Mounting
from palpate_calibrate.rotations import Array, from_rpy, from_wxyz
from palpate_calibrate.section import Section, SectionError

WRIST_COMPONENTS = ("ft_newton_euler", "ft_rnnob")


@dataclass
class Configuration:
    file: Path
    arm: int
    mounting: Mounting
    gravity: Array  # in W, m/s^2
    sensing: list[dict[str, Any]]  # all instances, as configured
    wrist: int  # index of the wrist's
    has_wrench_lag: bool
    gate: dict[str, Any]


def _merged(base: Any, over: Any) -> Any:
    """As palpated merges: mappings key by key, an empty entry removes, anything else replaces."""
    if not isinstance(base, dict) or not isinstance(over, dict):
        return over
    out = dict(base)
    for key, value in over.items():
        if value is None:
            out.pop(key, None)
        else:
            out[key] = _merged(base.get(key), value)
    return out


def _load(file: Path) -> dict[str, Any]:
    try:
        values = yaml.safe_load(file.read_text())
    except (OSError, UnicodeDecodeError) as error:
        raise SectionError(f"{file}: {error}") from error
    except yaml.YAMLError as error:
        raise SectionError(f"{file}: {str(error).splitlines()[0]}") from error
    if not isinstance(values, dict):
        raise SectionError(f"{file}: not a mapping of keys")
    base = values.pop("base", None)
    return values if base is None else dict(_merged(_load(file.parent / str(base)), values))


def _pose(frames: dict[str, Any], key: str, file: Path) -> tuple[Array, Array]:
    section = Section(frames.get(key) or {}, file, f"frames.{key}")
    position = np.array(section.numbers("position", 3, -100, 100, [0, 0, 0]))
    if section.has("quaternion"):
        return from_wxyz(np.array(section.numbers("quaternion", 4, -1, 1))), position
    return from_rpy(np.radians(section.numbers("rpy_deg", 3, -360, 360, [0, 0, 0]))), position


def read_configuration(file: Path, arm: int) -> Configuration:
    """Raises SectionError. palpated --check validates the rest of the file."""
    values = _load(file)
    of_arm = values if arm == 0 else values.get("second_arm") or {}
    frames = of_arm.get("frames") or {}
    sensing = [dict(item) for item in values.get("sensing") or []]
    wrists = [i for i, item in enumerate(sensing) if item.get("component") in WRIST_COMPONENTS and item.get("arm", 0) == arm]
    if not wrists:
        raise SectionError(f"{file}: sensing: no instance for arm {arm} of {', '.join(WRIST_COMPONENTS)}, "
                           "which have a payload")  # fmt: skip
    R_ES, p_ES = _pose(frames, "sensor_in_flange", file)
    R_EI, p_EI = _pose(frames, "imu_in_flange", file)
    gravity = Section(frames, file, "frames").numbers("gravity_in_base", 3, -20, 20, [0, 0, -9.81])
    if np.linalg.norm(gravity) < 1:
        raise SectionError(f"{file}: frames.gravity_in_base: {gravity}; allowed: a length of 1 m/s^2 or more")
    estimation = values.get("estimation") or {}
    return Configuration(file, arm, Mounting(R_ES, False, p_ES, R_EI, p_EI), np.array(gravity), sensing, wrists[0],
                         estimation.get("component") == "pose_wrench_filter", of_arm.get("gate") or {})  # fmt: skip
