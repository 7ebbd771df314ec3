"""The YAML that palpated reads: frames, payload and delay."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Optional

import numpy as np
import yaml

from palpate_calibrate.configuration import Configuration
from palpate_calibrate.fit import WristFit
from palpate_calibrate.quantities import deviations, is_determined
from palpate_common.rotations import Array, to_rpy

# Smallest deviation that is written for the delay: palpated's own sampling is not better known.
SMALLEST_LAG_DEVIATION = 0.5  # ms


def _numbers(values: Array, digits: int) -> list[float]:
    return [round(float(value), digits) + 0.0 for value in values]


def payload(fit: WristFit) -> dict[str, Any]:
    """`sensing[].payload`. The inertia is left out where the recording does not determine it: palpated then takes that
    of a point mass. The bias is that of the recording's end."""
    p = fit.parameters
    section: dict[str, Any] = {"mass": round(float(p.mass), 5), "center_of_mass": _numbers(p.center_of_mass, 6)}
    if is_determined(fit, "inertia").all():
        section["inertia"] = _numbers(p.inertia, 7)
    bias = np.concatenate([p.force_bias + p.force_drift / 2, p.torque_bias + p.torque_drift / 2])
    section["bias"] = _numbers(bias, 5)
    return section


def frames(fit: WristFit, configuration: Optional[Configuration]) -> dict[str, Any]:
    """`frames`, only the rotations that the recording determines; positions from the configuration."""
    p, section = fit.parameters, {}
    for key, block, rotation in (("sensor_in_flange", "sensor_rotation", p.R_ES), ("imu_in_flange", "imu_rotation", p.R_EI)):
        if block in fit.rows and is_determined(fit, block).all():
            position = np.zeros(3)
            if configuration is not None:
                of = configuration.mounting
                position = of.sensor_position if key == "sensor_in_flange" else of.imu_position
            section[key] = {"position": _numbers(position, 6), "rpy_deg": _numbers(np.degrees(to_rpy(rotation)), 4)}
            if configuration is not None and configuration.frames.optional(key).has("quaternion"):
                section[key]["quaternion"] = None  # the base's own notation would contradict
    return section


def rebased(value: Any, old: Path, new: Path) -> Any:
    """The same with names of files relative to folder `new` instead of `old`."""
    if isinstance(value, dict):
        return {key: rebased(entry, old, new) for key, entry in value.items()}
    if isinstance(value, list):
        return [rebased(entry, old, new) for entry in value]
    is_file = isinstance(value, str) and not Path(value).is_absolute() and (old / value).is_file()
    return os.path.relpath(old.resolve() / value, new) if is_file else value


def write_section(fit: WristFit, file: Path, configuration: Optional[Configuration]) -> None:
    """A file that palpated reads: with a configuration the whole of it, by `base`; else the sections alone."""
    document: dict[str, Any] = {}
    sensing: list[dict[str, Any]] = [{"name": "wrist", "component": "ft_newton_euler"}]
    if configuration is not None:
        folder = file.resolve().parent
        document["base"] = os.path.relpath(configuration.file.resolve(), folder)
        sensing = rebased(configuration.sensing, configuration.sensing_folder, folder)
    found = frames(fit, configuration)
    where = document if configuration is None or configuration.arm == 0 else document.setdefault("second_arm", {})
    if found:
        where["frames"] = found
    index = configuration.wrist if configuration is not None else 0
    sensing[index] = {**sensing[index], "payload": payload(fit)}
    if fit.polarity < 0 or "polarity" in sensing[index]:
        sensing[index]["polarity"] = fit.polarity
    document["sensing"] = sensing
    has_lag = configuration is not None and configuration.has_wrench_lag
    if has_lag and is_determined(fit, "wrench_delay").all() and fit.parameters.wrench_delay > 0:
        deviation = max(1e3 * float(deviations(fit, "wrench_delay")[0]), SMALLEST_LAG_DEVIATION)
        document["estimation"] = {"wrench_lag_ms": round(float(1e3 * fit.parameters.wrench_delay), 3),
                                  "wrench_lag_deviation_ms": round(deviation, 3)}  # fmt: skip
    header = f"# Written by palpate-calibrate wrist from {fit.recording.name}\n"
    if configuration is None:
        header += "# Sections for a configuration of palpated: copy them into yours, or give --config.\n"
    file.write_text(header + yaml.safe_dump(document, sort_keys=False, default_flow_style=None, width=120))
