"""Plots of logs and scores; needs matplotlib (Debian: python3-matplotlib)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional

import numpy as np

from palpate.evaluate import FeatureError, ShapeError
from palpate.mesh import Mesh

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def axes(projection: Optional[str] = None) -> "Axes":
    """Axes of a new figure. Raises ImportError with the remedy if matplotlib is missing."""
    try:
        from matplotlib import pyplot
    except ImportError as error:
        raise ImportError("palpate.plot needs matplotlib: apt-get install python3-matplotlib, "
                          "or pip install palpate[plot]") from error  # fmt: skip
    figure = pyplot.figure(figsize=(7, 4), layout="constrained")
    made: "Axes" = figure.add_subplot(projection=projection)
    return made


def shape_error(error: ShapeError, on: Optional["Axes"] = None) -> "Axes":
    """Mean and maximum error of the nodes over time, mm."""
    on = on or axes()
    on.fill_between(error.time, 0, 1e3 * error.maximum, alpha=0.25, label="maximum")
    on.plot(error.time, 1e3 * error.mean, label="mean")
    on.set(xlabel="time (s)", ylabel="error of nodes (mm)", ylim=(0, None))
    on.legend()
    return on


def feature_error(error: FeatureError, on: Optional["Axes"] = None) -> "Axes":
    """Distance of the plant's feature to its target over time, mm, logarithmic."""
    on = on or axes()
    on.semilogy(error.time, 1e3 * np.maximum(error.distance, 1e-6))
    on.set(xlabel="time since the target (s)", ylabel=f"{error.kind} to target (mm)")
    on.grid(alpha=0.3)
    return on


def mesh(of: Mesh, positions: Any = None, on: Optional["Axes"] = None, **style: Any) -> "Axes":
    """The surface of a mesh at `positions`, (n, 3), m in O; at rest by default."""
    on = on or axes("3d")
    x, y, z = (of.nodes if positions is None else np.asarray(positions, float)).T
    options: dict[str, Any] = {"alpha": 0.4, "edgecolor": "grey", "linewidth": 0.3, **style}
    drawn: Any = on
    drawn.plot_trisurf(x, y, z, triangles=of.triangles, **options)
    drawn.set(xlabel="x (m)", ylabel="y (m)", zlabel="z (m)", aspect="equal")
    return on


def save(on: "Axes", path: str) -> None:
    """Writes the figure to a file of the type given by its extension, e.g. error.png."""
    figure = on.get_figure()
    assert figure is not None
    figure.savefig(path, dpi=120)
