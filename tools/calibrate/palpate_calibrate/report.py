"""Results as text and as JSON."""

from __future__ import annotations

from typing import Any

import numpy as np

from palpate_calibrate.fit import WristFit
from palpate_calibrate.observability import weaknesses
from palpate_calibrate.quantities import quantities

_UNITS = {"force": "N", "torque": "N m", "acceleration": "m/s^2", "angular_velocity": "rad/s"}


def summary(fit: WristFit) -> dict[str, Any]:
    """Everything that the table shows, in the same units."""
    residuals: dict[str, dict[str, Any]] = {}
    for name in fit.residuals:
        rms = fit.rms(name)
        residuals[name] = {"rms": rms.tolist(), "rms_norm": float(np.linalg.norm(rms)), "unit": _UNITS[name]}
    for name, d in fit.deviations.items():
        residuals[name]["parts"] = {"white": d.white, "slow": d.slow, "pose": d.pose, "slow_time_s": d.time}
    return {
        "recording": fit.recording.name,
        "at_rest": fit.motion.at_rest,
        "samples": len(fit.motion.time),
        "duration_s": 0.0 if fit.motion.at_rest else float(fit.recording.wrench.time[-1] - fit.recording.wrench.time[0]),
        "polarity": fit.polarity,
        "outliers": fit.outliers,
        "quantities": {q.name: {"value": q.value, "half_width": q.half_width, "unit": q.unit, "determined": q.is_determined}
                       for q in quantities(fit)},  # fmt: skip
        "residuals": residuals,
        "not_determined": [{"parameters": list(w.parameters), "advice": w.advice} for w in weaknesses(fit)],
    }


def table(fit: WristFit) -> str:
    """For people: one line per result, the residuals, and what is not determined."""
    time = fit.recording.wrench.time
    kind = f"{time[-1] - time[0]:.1f} s in motion, {len(fit.motion.time)} samples"
    if fit.motion.at_rest:
        kind = f"{len(fit.motion.time)} poses at rest"
    lines = [f"{fit.recording.name}: {kind}", "", f"  {'parameter':<22}{'value':>12}   {'95 % interval':<16}unit"]
    for q in quantities(fit):
        digits = int(np.clip(2 - np.floor(np.log10(max(q.half_width, 1e-9))), 0, 7))
        interval = f"+- {q.half_width:.{digits}f}" if q.is_determined else "not determined"
        lines.append(f"  {q.name:<22}{q.value:>12.{digits}f}   {interval:<16}{q.unit}")
    lines.append("")
    for name in fit.residuals:
        axes = " ".join(f"{value:.4g}" for value in fit.rms(name))
        norm = np.linalg.norm(fit.rms(name))
        lines.append(f"  residual of {name.replace('_', ' ')}: {axes} {_UNITS[name]} (x y z), {norm:.3f} in all")
    if fit.polarity < 0:
        lines.append("  The sensor reports what its load exerts on it: polarity: -1.")
    if "gravity_tilt" in fit.rows:
        lines.append("  With an unknown direction of gravity the sign of the readings and that direction are known only together.")
    if fit.outliers:
        lines.append(f"  {fit.outliers} samples with reduced weight.")
    found = weaknesses(fit)
    if found:
        lines += ["", "The recording does not determine:"]
        lines += [f"  {', '.join(w.parameters)}: {w.advice}" for w in found]
    return "\n".join(lines)
