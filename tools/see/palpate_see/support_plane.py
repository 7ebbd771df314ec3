"""The plane on which the object stands, found in the cloud near to where it is configured."""

from __future__ import annotations

from typing import Optional

import numpy as np

from palpate_common import robust
from palpate_common.pose import Pose, moved
from palpate_see.cloud import Floats
from palpate_see.obstacles import Obstacle
from palpate_see.point_error import PointError, margin_of

MOST, FEWEST = 5000, 200  # points that are used, and that must lie on the plane
STEPS = 15  # of reweighted least squares


def fitted_plane(obstacle: Obstacle, X_WS: Pose, points_C: Floats, X_WC: Pose, error: PointError) -> Optional[Pose]:
    """Pose in W of a half-space as the camera sees it; None if too few points lie on it.

    X_WS: as configured, with the half-space below z = 0 of S. points_C: (n, 3), m, in C, all that were seen.
    It is the lowest plane within the deviations of the camera's and the obstacle's poses, since nothing can be seen below
    it, with the most probable height and tilt.
    """
    points_C = points_C[:: max(1, len(points_C) // MOST)]
    local, camera = X_WS.inverse_of(X_WC.of(points_C)), X_WS.inverse_of(X_WC.p[None])[0]
    # Height, m, and rotations, rad, about the camera's position, which tilt the plane by the distance from it.
    A = np.column_stack([np.ones(len(local)), local[:, 1] - camera[1], camera[0] - local[:, 0]])
    covariance = _covariance(obstacle, camera, error)
    noise, place = error.noise.deviation(points_C[:, 2]), np.sqrt(np.einsum("ni,ij,nj->n", A, covariance, A))
    chosen = np.flatnonzero(np.abs(local[:, 2]) <= margin_of(noise, place))
    while len(chosen) >= FEWEST:
        step = _most_probable(A[chosen], local[chosen, 2], noise[chosen], place[chosen], covariance)
        away = (local[chosen, 2] - A[chosen] @ step) / noise[chosen]
        if (np.abs(away) <= robust.A).sum() < FEWEST:
            return None
        chosen = chosen[away < -robust.B]
        if len(chosen) < FEWEST:
            return moved(X_WS, np.concatenate([step[0] * X_WS.R[:, 2], X_WS.R[:, :2] @ step[1:]]), camera)
    return None


def _most_probable(A: Floats, heights: Floats, noise: Floats, place: Floats, covariance: Floats) -> Floats:
    """(3,): parameters of heights A @ parameters, (n,), m, whose prior has the covariance, (3, 3).

    noise, place: (n,), m, standard deviations of each height by its measurement and by the prior. By iteratively reweighted
    least squares (Huber 1981, Robust statistics, 7.8), whose weights begin with all that may be the plane and narrow to the
    noise (graduated non-convexity: Blake and Zisserman 1987, Visual reconstruction).
    """
    prior = np.linalg.inv(np.linalg.cholesky(covariance))
    step: Floats = np.zeros(3)
    for i in range(STEPS):
        scale = np.sqrt(robust.weights((heights - A @ step) / np.hypot(noise, 0.5**i * place))) / noise
        rows, values = np.vstack([A * scale[:, None], prior]), np.concatenate([heights * scale, np.zeros(3)])
        step = np.linalg.lstsq(rows, values, rcond=None)[0]
    return step


def _covariance(obstacle: Obstacle, camera: Floats, error: PointError) -> Floats:
    """(3, 3) of the plane's height, m, and its rotations, rad, about the camera's position, (3,), m, in S."""
    seen = np.array([np.hypot(error.camera.position_deviation, obstacle.position_deviation),
                     error.camera.angle_deviation, error.camera.angle_deviation])  # fmt: skip
    # The obstacle itself turns about the origin of S.
    turned: Floats = obstacle.rotation_deviation * np.array([[camera[1], -camera[0]], [1, 0], [0, 1]])
    result: Floats = np.diag(seen**2) + turned @ turned.T
    return result
