"""Picture of a fit: what was measured, what the model explains, and the residuals."""

from __future__ import annotations

from pathlib import Path

from palpate_calibrate.fit import WristFit

_LABELS = {"force": "force in S, N", "torque": "torque in S, N m", "acceleration": "specific force in I, m/s²",
           "angular_velocity": "angular velocity in I, rad/s"}  # fmt: skip
_COLOURS = ("tab:red", "tab:green", "tab:blue")


def plot_residuals(fit: WristFit, file: Path) -> None:
    """One row per signal: measured (points) and model (lines) on the left, residuals on the right."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    names = list(fit.residuals)
    figure, axes = pyplot.subplots(len(names), 2, figsize=(12, 2.6 * len(names)), squeeze=False, sharex=True)
    time = fit.motion.time
    for row, name in enumerate(names):
        residual = fit.residuals[name]
        for k, colour in enumerate(_COLOURS):
            axes[row, 0].plot(time, fit.measured[name][:, k], ".", color=colour, markersize=3, label="xyz"[k])
            axes[row, 0].plot(time, fit.measured[name][:, k] - residual[:, k], "-", color=colour, linewidth=0.8)
            axes[row, 1].plot(time, residual[:, k], ".-", color=colour, markersize=3, linewidth=0.6)
        axes[row, 0].set_ylabel(_LABELS[name])
        axes[row, 1].axhline(0, color="0.7", linewidth=0.8)
    axes[0, 0].set_title("measured (points), model (lines)")
    axes[0, 1].set_title("residual")
    axes[0, 0].legend(loc="upper right", fontsize=8)
    for ax in axes[-1]:
        ax.set_xlabel("pose" if fit.motion.at_rest else "time, s")
    figure.tight_layout()
    figure.savefig(file, dpi=110)
    pyplot.close(figure)
