"""Distances between a cloud and a surface."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from palpate_common.surface import Surface, gradients

Floats = NDArray[np.float64]
SAMPLES = 5000


class Deviation(NamedTuple):
    """signed: (n,), m, of each point from the surface, positive outside. facts: as the report has them."""

    signed: Floats
    facts: dict[str, Any]


def measure(points: Floats, surface: Surface) -> Deviation:
    """points: (n, 3), m, in the surface's frame."""
    feet, of = surface.closest(points)
    signed, _ = gradients(points, feet, surface.normals[of])
    samples, _ = surface.samples(SAMPLES)
    back, _ = cKDTree(points).query(samples)
    facts = {"cloud_from_surface": {**_numbers(np.abs(signed)), "signed_mean_m": float(signed.mean())},
             "surface_from_cloud": _numbers(back)}  # fmt: skip
    return Deviation(signed, facts)


def _numbers(distances: Floats) -> dict[str, float]:
    return {"mean_m": float(distances.mean()), "rms_m": float(np.sqrt((distances**2).mean())),
            "p95_m": float(np.quantile(distances, 0.95)), "largest_m": float(distances.max())}  # fmt: skip
