"""Picture of a fit: residuals one after the other, and their distribution compared with the normal one."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

import numpy as np

from palpate_calibrate.camera.camera_fit import CameraFit

FEWEST = 6  # residuals of a group that is drawn
BINS = np.linspace(-5, 5, 41)  # estimated deviations


def draw(fit: CameraFit, path: Path) -> None:
    """One row per group: residuals on the left, gross errors in red; on the right their distribution."""
    os.environ.setdefault("MPLCONFIGDIR", tempfile.gettempdir())
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    groups = [group for group in fit.estimate.groups if len(group.r) >= FEWEST]
    figure, axes = pyplot.subplots(len(groups), 2, figsize=(11, 2.8 * len(groups)), squeeze=False, layout="constrained",
                                   width_ratios=[2, 1])  # fmt: skip
    for (left, right), group in zip(axes, groups):
        residuals, gross = fit.residuals(group), fit.gross(group)
        left.plot(residuals, ".", markersize=3, color="tab:blue")
        left.plot(gross, residuals[gross], ".", markersize=4, color="tab:red", label=f"{len(gross)} gross errors")
        middle = 5 * fit.deviation(group)
        left.set_ylim(-max(middle, 1e-9), max(middle, 1e-9))
        left.axhline(0, color="0.7", linewidth=0.8)
        left.set_ylabel(f"{group.name}, {group.unit}")
        if len(gross):
            left.legend(loc="upper right", fontsize=8)
        right.hist(group.r / fit.estimate.factors[group.name], BINS, density=True, color="tab:blue", alpha=0.5)
        right.plot(BINS, np.exp(-0.5 * BINS**2) / np.sqrt(2 * np.pi), color="0.3", linewidth=0.8)
    axes[0, 0].set_title(f"residuals, by {fit.way}")
    axes[0, 1].set_title("distribution; line: normal")
    axes[-1, 0].set_xlabel("number of the residual")
    axes[-1, 1].set_xlabel("estimated standard deviations")
    figure.savefig(path, dpi=110)
    pyplot.close(figure)
