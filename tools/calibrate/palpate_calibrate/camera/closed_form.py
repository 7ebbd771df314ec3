"""Closed forms from which the joint fit of a marker starts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from palpate_common.pose import Pose, angle_of
from palpate_common.rotations import fit_rotation

Floats = NDArray[np.float64]
CONTRADICTS = np.radians(20)  # rotation beyond which an image's pose is taken for the mirrored one
ROUNDS = 4


def pose_of_square(rays: Floats, corners: Floats) -> Pose:
    """X_CM of a planar square from its corners' rays, (4, 3), in C, and places, (4, 3), in M with z = 0, m.

    Of the homography from the plane to the image (Zhang 2000, A flexible new technique for camera calibration).
    """
    rows = []
    for ray, corner in zip(rays, corners):
        point = np.array([corner[0], corner[1], 1.0])
        rows.append(np.concatenate([np.zeros(3), -ray[2] * point, ray[1] * point]))
        rows.append(np.concatenate([ray[2] * point, np.zeros(3), -ray[0] * point]))
    H = np.linalg.svd(np.array(rows))[2][-1].reshape(3, 3)
    H = H / (0.5 * (np.linalg.norm(H[:, 0]) + np.linalg.norm(H[:, 1])))
    H = H * np.sign(H[2, 2])  # in front of the camera
    first, second = H[:, 0], H[:, 1]
    R = fit_rotation(np.eye(3), np.array([first, second, np.cross(first, second)]))
    return Pose(R, H[:, 2])


def eye_to_hand(flanges: list[Pose], markers: list[Pose]) -> tuple[Pose, Pose]:
    """X_WC and X_EM of X_WE X_EM = X_WC X_CM, (k) each.

    Rotations by the dominant singular vectors of a sum of Kronecker products, then positions by linear least squares (Shah
    2013, Solving the robot-world/hand-eye calibration problem using the Kronecker product). Images whose pose contradicts
    the others are left out: a small planar marker looks nearly alike in two poses.
    """
    used = list(range(len(flanges)))
    for _ in range(ROUNDS):
        R_WC, R_EM = _rotations([flanges[k].R for k in used], [markers[k].R for k in used])
        error = np.array([angle_of((flange.R @ R_EM).T @ R_WC @ marker.R) for flange, marker in zip(flanges, markers)])
        agreeing = [k for k in range(len(flanges)) if error[k] < max(CONTRADICTS, float(np.median(error)))]
        if len(agreeing) < 3 or agreeing == used:
            break
        used = agreeing
    A, b = [], []
    for k in used:
        A.append(np.hstack([np.eye(3), -flanges[k].R]))
        b.append(flanges[k].p - R_WC @ markers[k].p)
    solution = np.linalg.lstsq(np.concatenate(A), np.concatenate(b), rcond=None)[0]
    return Pose(R_WC, solution[:3]), Pose(R_EM, solution[3:])


def _rotations(of_flanges: list[Floats], of_markers: list[Floats]) -> tuple[Floats, Floats]:
    """R_WC and R_EM of R_WE R_EM = R_WC R_CM."""
    total = np.zeros((9, 9))
    for R_WE, R_CM in zip(of_flanges, of_markers):
        total += np.kron(R_CM, R_WE)
    # With columns stacked, (R_CM' (x) R_WE') maps R_WC to R_EM: at the solution a singular vector of the largest value.
    u, _, vt = np.linalg.svd(total)
    R_WC, R_EM = (_nearest_rotation(v.reshape(3, 3, order="F")) for v in (u[:, 0], vt[0]))
    return R_WC, R_EM


def _nearest_rotation(m: Floats) -> Floats:
    """Of a matrix that is a multiple of a rotation but for errors, of either sign."""
    m = m * np.sign(np.linalg.det(m))
    return fit_rotation(np.eye(3), m.T)
