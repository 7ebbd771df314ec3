"""Picture of a surface with the cloud's points coloured by their distance from it."""

from __future__ import annotations

from pathlib import Path

import matplotlib
import numpy as np
from numpy.typing import NDArray

from palpate_common.surface import Surface
from palpate_scan.deviation import Deviation

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402
from mpl_toolkits.mplot3d.art3d import Line3DCollection  # noqa: E402

MOST = 8000  # points that are drawn
VIEWS = ((25, -60), (-20, 120))  # elevation and azimuth, degrees


def draw(path: Path, name: str, points: NDArray[np.float64], surface: Surface, found: Deviation) -> None:
    """Two views from opposite sides and a histogram."""
    chosen = np.random.default_rng(0).permutation(len(points))[:MOST]
    limit = max(1e3 * float(np.quantile(np.abs(found.signed), 0.95)), 1e-3)
    figure = pyplot.figure(figsize=(15, 5))
    edges = np.concatenate([surface.corners[:, [i, (i + 1) % 3]] for i in range(3)])
    middle, half = 0.5 * (points.min(axis=0) + points.max(axis=0)), 0.5 * float(np.ptp(points, axis=0).max())
    for place, (elevation, azimuth) in enumerate(VIEWS, 1):
        axes = figure.add_subplot(1, 3, place, projection="3d")
        a, e = np.radians(azimuth), np.radians(elevation)
        towards = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
        front = chosen[(surface.normals[surface.closest(points[chosen])[1]] @ towards) > 0]
        drawn = axes.scatter(*(1e3 * points[front]).T, c=1e3 * found.signed[front], s=2, cmap="coolwarm",
                             vmin=-limit, vmax=limit)  # fmt: skip
        axes.add_collection3d(Line3DCollection(1e3 * edges, colors="0.3", linewidths=0.4))
        for axis, at in zip("xyz", middle):
            getattr(axes, f"set_{axis}lim")(1e3 * (at - half), 1e3 * (at + half))
            getattr(axes, f"set_{axis}label")(f"{axis}, mm")
        axes.view_init(elevation, azimuth)
    figure.colorbar(drawn, ax=figure.axes, shrink=0.7, label="distance from the mesh, mm, positive outside")
    axes = figure.add_subplot(1, 3, 3)
    axes.set_position([0.76, 0.15, 0.21, 0.7])
    axes.hist(1e3 * np.clip(found.signed, -2e-3 * limit, 2e-3 * limit), 61, color="#0072b2")
    axes.set(xlabel="distance from the mesh, mm", ylabel="points")
    for other in figure.axes[:3]:
        box = other.get_position()
        other.set_position([0.7 * box.x0, box.y0, 0.9 * box.width, box.height])
    figure.suptitle(f"{name}: deviation of {len(points)} points, mean {1e3 * np.abs(found.signed).mean():.2f} mm, "
                    f"largest {1e3 * np.abs(found.signed).max():.2f} mm")  # fmt: skip
    figure.savefig(path, dpi=80)
    pyplot.close(figure)
