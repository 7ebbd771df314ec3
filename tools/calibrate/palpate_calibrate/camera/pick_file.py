"""Touched and picked points from CSV, and their depths from a cloud around them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from palpate_calibrate.camera.depth_error import DepthError
from palpate_calibrate.camera.touches import PickedTouches
from palpate_common import robust
from palpate_common.column_file import Layout, read_columns
from palpate_common.input_error import InputError

Floats = NDArray[np.float64]
TOUCHED, PICKED = ("x", "y", "z"), ("u", "v", "w")
LARGEST = 100.0  # m
LAYOUT = Layout((*TOUCHED, *PICKED), (), {name: (-LARGEST, LARGEST) for name in (*TOUCHED, *PICKED)})
NEAREST = 0.01  # m, least depth of a pick
FEWEST = 8  # points of the cloud around a pick
FAR = 0.03  # m: from the picked depth, of points that belong to something else
UNEVEN = 3.0  # ratio of residuals and the stated deviation from which on the surroundings are no plane


def read_picks(path: Path, touch_deviation: float, error: DepthError) -> PickedTouches:
    """Of a CSV file with columns x, y, z in W and u, v, w in C, m. touch_deviation: m. Raises InputError."""
    table = read_columns(path, LAYOUT)
    points_C = table.numbers(*PICKED)
    for i, depth in enumerate(points_C[:, 2]):
        if depth < NEAREST:
            table.fail(i, f"w: {depth:g}; allowed: {NEAREST:g} or more: C's z points forwards")
    return PickedTouches(str(path), table.numbers(*TOUCHED), points_C, touch_deviation, error)


def with_depths_of(cloud: Floats, picked: PickedTouches, radius: float) -> tuple[PickedTouches, list[int]]:
    """The same with depths from planes through the cloud around each pick, and the picks, by index, that keep theirs.

    cloud: (n, 3), m, in C. radius: m, around the pick's viewing ray. One pixel's depth errs far more than the plane through
    some fifty. A plane is linear in the inverse depth over the image, whose errors are alike everywhere.
    Raises InputError where no pick is near the cloud.
    """
    cloud = cloud[cloud[:, 2] > NEAREST]
    in_image = cloud[:, :2] / cloud[:, 2:]
    tree = cKDTree(in_image)
    points, kept = picked.points_C.copy(), []
    stated = picked.error.along(picked.points_C)
    near = 0
    for i, pick in enumerate(picked.points_C):
        at = pick[:2] / pick[2]
        around = np.array(tree.query_ball_point(at, radius / pick[2]), np.int64)
        around = around[np.abs(cloud[around, 2] - pick[2]) < FAR]
        near += len(around) > 0
        depth = _depth_at(in_image[around] - at, cloud[around, 2], stated[i]) if len(around) >= FEWEST else None
        if depth is None:
            kept.append(i)
        else:
            points[i] = depth * np.append(at, 1.0)
    if near == 0:
        raise InputError(f"{picked.source}: no pick lies within {radius:g} m of the cloud; allowed: "
                         "picks and cloud in one frame C")  # fmt: skip
    return PickedTouches(picked.source, picked.points_W, points, picked.touch_deviation, picked.error), kept


def _depth_at(in_image: Floats, depths: Floats, deviation: float) -> float | None:
    """m, of the plane through points at the image's places, (n, 2), relative to the pick's; None where they lie on none."""
    A = np.column_stack([np.ones(len(in_image)), in_image])
    w, solution = np.ones(len(depths)), np.zeros(3)
    for _ in range(4):
        solution = np.linalg.lstsq(A * w[:, None], w / depths, rcond=None)[0]
        r = (A @ solution * depths - 1) * depths
        w = np.sqrt(robust.weights(r / deviation))
    if solution[0] <= 0 or np.median(np.abs(r)) > UNEVEN * deviation:
        return None
    return float(1 / solution[0])
