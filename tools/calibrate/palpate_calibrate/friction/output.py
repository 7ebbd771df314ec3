"""The YAML that palpated reads, the table, and the picture of the residuals."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from palpate_calibrate.friction.configuration import JointTorqueConfiguration
from palpate_calibrate.friction.friction_fit import COULOMB, OFFSET, VISCOUS, WEIGHT, FrictionFit
from palpate_calibrate.section_output import rebased


def section(fit: FrictionFit) -> dict[str, Any]:
    """Keys of the component joint_torque. Friction that the recording does not determine is 0."""
    known = fit.is_determined()
    coulomb = np.where(known, fit.values[:, COULOMB], 0)
    return {
        "friction": {"coulomb": _rounded(coulomb), "viscous": _rounded(np.where(known, fit.values[:, VISCOUS], 0)),
                     "presliding": float(f"{fit.presliding:.3g}"), "error": round(fit.error, 4)},
        "joint_deviation": _rounded(np.maximum(fit.noise, 1e-4)),
    }  # fmt: skip


def _rounded(values: Any) -> list[float]:
    return [round(float(value), 5) + 0.0 for value in values]


def write_section(fit: FrictionFit, file: Path, configuration: JointTorqueConfiguration) -> None:
    folder = file.resolve().parent
    sensing = rebased(configuration.sensing, configuration.sensing_folder, folder)
    sensing[configuration.index] = {**sensing[configuration.index], **section(fit)}
    document = {"base": os.path.relpath(configuration.file.resolve(), folder), "sensing": sensing}
    file.write_text(f"# Written by palpate-calibrate friction from {fit.torques.name}\n"
                    + yaml.safe_dump(document, sort_keys=False, default_flow_style=None, width=120))  # fmt: skip


def summary(fit: FrictionFit) -> dict[str, Any]:
    known = fit.is_determined()
    joints = []
    for i, name in enumerate(fit.joints):
        joint: dict[str, Any] = {"name": name, "determined": bool(known[i]), "noise": float(fit.noise[i]),
                                 "residual_rms": float(np.sqrt(np.nanmean(fit.residual[:, i] ** 2)))}  # fmt: skip
        for key, column in (("coulomb", COULOMB), ("viscous", VISCOUS), ("offset", OFFSET), ("weight_error", WEIGHT)):
            joint[key] = {"value": float(fit.values[i, column]), "half_width": float(fit.half_width[i, column])}
        joints.append(joint)
    return {"recording": fit.torques.name, "duration_s": float(fit.torques.time[-1] - fit.torques.time[0]),
            "presliding": fit.presliding, "error": fit.error, "joints": joints}  # fmt: skip


def table(fit: FrictionFit) -> str:
    known = fit.is_determined()
    lines = [f"{fit.torques.name}: {fit.torques.time[-1] - fit.torques.time[0]:.1f} s", "",
             f"  {'joint':<14}{'Coulomb, N m':>20}{'viscous, N m s/rad':>22}{'offset, N m':>20}{'error of weight':>19}{'noise, N m':>13}"]  # fmt: skip
    for i, name in enumerate(fit.joints):
        cells = [f"{fit.values[i, c]:.3f} +- {fit.half_width[i, c]:.3f}" for c in (COULOMB, VISCOUS, OFFSET, WEIGHT)]
        lines.append(f"  {name:<14}{cells[0]:>20}{cells[1]:>22}{cells[2]:>20}{cells[3]:>19}{fit.noise[i]:>13.3f}")
    lines += ["", f"  presliding {fit.presliding:.2g} rad, relative error {fit.error:.3f}; intervals are those of 95 %"]
    if not known.all():
        names = ", ".join(name for name, is_known in zip(fit.joints, known) if not is_known)
        lines.append(f"The recording does not determine the friction of {names}: turn these joints to and fro, at two speeds or more")
    return "\n".join(lines)


def plot_residuals(fit: FrictionFit, file: Path) -> None:
    """One row per joint: measured friction (points) and the model (line) by time, residuals by velocity."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    count = len(fit.joints)
    figure, axes = pyplot.subplots(count, 2, figsize=(12, 1.8 * count), squeeze=False)
    velocity = np.array([np.interp(fit.times, fit.torques.time, fit.torques.dq[:, i]) for i in range(count)]).T
    for i, name in enumerate(fit.joints):
        left, right = axes[i]
        left.plot(fit.times, fit.measured[:, i], ".", color="tab:blue", markersize=3)
        left.plot(fit.times, fit.measured[:, i] - fit.residual[:, i], "-", color="tab:red", linewidth=0.8)
        left.set_ylabel(f"{name}, N m")
        right.plot(velocity[:, i], fit.residual[:, i], ".", color="tab:blue", markersize=3)
        right.axhline(0, color="0.7", linewidth=0.8)
    axes[0, 0].set_title("friction, offset and error of the weight: measured (points), model (line)")
    axes[0, 1].set_title("residual by velocity")
    axes[-1, 0].set_xlabel("time, s")
    axes[-1, 1].set_xlabel("velocity, rad/s")
    figure.tight_layout()
    figure.savefig(file, dpi=110)
    pyplot.close(figure)
