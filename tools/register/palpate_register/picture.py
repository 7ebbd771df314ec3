"""PNG of the mesh at its pose, with touches, cloud and the proposed touch, from two sides."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from palpate_common.surface import Surface
from palpate_register.next_touch import Touch
from palpate_register.observations import Observations
from palpate_register.register import Registration

VIEWS = ((25, -60), (25, 30))  # degrees: elevation, azimuth
MOST_TRIANGLES = 4000


def draw(surface: Surface, result: Registration, observed: Observations, proposals: list[Touch], path: Path) -> None:
    """Writes the picture. Axes are those of W, mm."""
    os.environ.setdefault("MPLCONFIGDIR", tempfile.gettempdir())
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    figure = pyplot.figure(figsize=(11, 5), layout="constrained")
    corners = 1e3 * result.pose.of(surface.corners.reshape(-1, 3)).reshape(-1, 3, 3)
    touches, state = 1e3 * observed.touches.points, result.refined.state
    for i, (elevation, azimuth) in enumerate(VIEWS):
        on: Any = figure.add_subplot(1, 2, i + 1, projection="3d")
        on.add_collection3d(Poly3DCollection(corners[:: 1 + len(corners) // MOST_TRIANGLES], facecolor="tab:orange",
                                             edgecolor="0.5", linewidth=0.3, alpha=0.25))  # fmt: skip
        if observed.cloud is not None:
            cloud = observed.cloud.thinned(2000)
            moved = cloud.middle + state.shift + (cloud.points - cloud.middle) @ state.turn.T
            on.scatter(*(1e3 * moved).T, s=1, color="tab:blue", label="cloud, corrected by the camera's error")
        if len(touches):
            on.scatter(*touches.T, s=25, color="tab:red", label="touches")
        for touch in proposals[:1]:
            start, way = 1e3 * (touch.point - 0.05 * touch.approach), 50 * touch.approach
            on.quiver(*start, *way, color="tab:green", label="next touch")
        everything = np.concatenate([corners.reshape(-1, 3), touches])
        middle = 0.5 * (everything.min(axis=0) + everything.max(axis=0))
        half = 0.55 * np.ptp(everything, axis=0).max()
        for name, value in zip("xyz", middle):
            getattr(on, f"set_{name}lim")(value - half, value + half)
            getattr(on, f"set_{name}label")(f"{name} (mm)")
        on.set_box_aspect((1, 1, 1))
        on.view_init(elevation, azimuth)
        if i == 0:
            on.legend(loc="upper left", fontsize=8)
    figure.savefig(path, dpi=110)
    pyplot.close(figure)
