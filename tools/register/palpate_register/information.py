"""What touches at known places say about a pose: information matrix and Cramer-Rao bound."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from palpate_common.pose import Pose
from palpate_common.rotations import cross_matrix
from palpate_common.surface import Surface
from palpate_register.observations import Touches

Floats = NDArray[np.float64]


def touch_information(surface: Surface, pose: Pose, points_W: Floats, normals_W: Floats, deviation: Floats,
                      normal_deviation: float) -> Floats:  # fmt: skip
    """Fisher information, (n, 6, 6), of each touch about (centre's position, rotation) in W.

    points_W, normals_W: (n, 3), where the surface is touched, m, and its outward normals there.
    deviation: (n,), m. normal_deviation: rad; inf where normals are not measured. For normally
    distributed errors the information is J' J / variance of the linearised measurement.
    """
    arm = points_W - pose.of(surface.center[None])
    J = np.hstack([normals_W, np.cross(arm, normals_W)]) / deviation[:, None]
    result: Floats = np.einsum("ni,nj->nij", J, J)
    if np.isfinite(normal_deviation):
        turns = np.array([cross_matrix(n) for n in normals_W]).reshape(-1, 3, 3)
        result[:, 3:, 3:] += np.einsum("nki,nkj->nij", turns, turns) / normal_deviation**2
    return result


def cramer_rao(surface: Surface, pose: Pose, touches: Touches, feet_W: Floats, normals_W: Floats) -> Floats:
    """Least covariance, (6, 6), that an unbiased estimator of the pose can have with the touches.

    feet_W, normals_W: (n, 3), true places and normals, at the true pose.
    """
    has = touches.has_normal
    total = np.zeros((6, 6))
    for chosen, deviation in ((has, touches.normal_deviation), (~has, np.inf)):
        if chosen.any():
            total += touch_information(surface, pose, feet_W[chosen], normals_W[chosen],
                                       touches.deviation[chosen], deviation).sum(axis=0)  # fmt: skip
    result: Floats = np.linalg.inv(total + 1e-12 * np.eye(6))
    result[:3, :3] += touches.common_deviation**2 * np.eye(3)
    return result
