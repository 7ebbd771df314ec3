"""Rotation matrices, rotation vectors, quaternions and angles of the configuration."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def cross_matrix(v: Array) -> Array:
    """(..., 3) to (..., 3, 3) with cross_matrix(v) @ u = v x u."""
    v = np.asarray(v, float)
    m = np.zeros(v.shape[:-1] + (3, 3))
    m[..., 0, 1], m[..., 0, 2], m[..., 1, 2] = -v[..., 2], v[..., 1], -v[..., 0]
    m[..., 1, 0], m[..., 2, 0], m[..., 2, 1] = v[..., 2], -v[..., 1], v[..., 0]
    return m


def cross(a: Array, b: Array) -> Array:
    """a x b of rows (n, 3) or (3,); numpy's own takes longer for few rows."""
    ax, ay, az = a[..., 0], a[..., 1], a[..., 2]
    bx, by, bz = b[..., 0], b[..., 1], b[..., 2]
    return np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], axis=-1)


def perpendiculars(directions: Array) -> Array:
    """(n, 2, 3): two unit vectors at right angles to each unit vector, (n, 3), and to each other."""
    least = np.eye(3)[np.argmin(np.abs(directions), axis=1)]
    first = np.cross(directions, least)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return np.stack([first, np.cross(directions, first)], axis=1)


def exp_rotation(v: Array) -> Array:
    """Rotation matrix of a rotation vector, rad, (3,)."""
    angle = float(np.linalg.norm(v))
    k = cross_matrix(v)
    if angle < 1e-8:
        return np.eye(3) + k + 0.5 * k @ k
    return np.eye(3) + np.sin(angle) / angle * k + (1 - np.cos(angle)) / angle**2 * k @ k


def exp_rotations(v: Array) -> Array:
    """exp_rotation() of rows: (n, 3) to (n, 3, 3)."""
    angle = np.linalg.norm(v, axis=1)[:, None, None]
    k = cross_matrix(v)
    # sin(a) / a and (1 - cos(a)) / a^2, accurate for small angles, too
    return np.asarray(np.eye(3) + np.sinc(angle / np.pi) * k + 0.5 * np.sinc(0.5 * angle / np.pi) ** 2 * k @ k)


def log_rotation(rotation: Array) -> Array:
    """Rotation vector, rad, of length 0 to pi, (3,)."""
    q = to_wxyz(rotation)
    sine = float(np.linalg.norm(q[1:]))
    if sine < 1e-12:
        return 2 * q[1:]
    return 2 * np.arctan2(sine, q[0]) / sine * q[1:]


def from_wxyz(q: Array) -> Array:
    """Rotation matrices (..., 3, 3) of quaternions w, x, y, z (..., 4), which need not be of unit length."""
    q = np.asarray(q, float)
    q = q / np.linalg.norm(q, axis=-1, keepdims=True)
    k = cross_matrix(q[..., 1:])
    return np.eye(3) + 2 * q[..., :1, None] * k + 2 * k @ k


def to_wxyz(rotation: Array) -> Array:
    """Unit quaternions w, x, y, z (..., 4), w >= 0, of rotation matrices (..., 3, 3): the largest eigenvectors of 4 x 4 matrices
    (Bar-Itzhack 2000)."""
    r = np.asarray(rotation, float)
    trace = r[..., 0, 0] + r[..., 1, 1] + r[..., 2, 2]
    k = np.zeros(r.shape[:-2] + (4, 4))
    k[..., 0, 0] = trace
    for i, j, m in ((0, 2, 1), (1, 0, 2), (2, 1, 0)):
        k[..., 0, i + 1] = k[..., i + 1, 0] = r[..., j, m] - r[..., m, j]
    k[..., 1:, 1:] = r + np.swapaxes(r, -1, -2) - trace[..., None, None] * np.eye(3)
    q = np.linalg.eigh(k)[1][..., :, -1]
    return np.asarray(np.where(q[..., :1] < 0, -q, q))


def from_rpy(rpy: Array) -> Array:
    """R = Rz(yaw) Ry(pitch) Rx(roll) as in `rpy_deg` of a configuration; rad."""
    x, y, z = np.eye(3)
    return exp_rotation(rpy[2] * z) @ exp_rotation(rpy[1] * y) @ exp_rotation(rpy[0] * x)


def to_rpy(rotation: Array) -> Array:
    """Inverse of from_rpy(), rad."""
    pitch = np.arcsin(np.clip(-rotation[2, 0], -1, 1))
    if abs(rotation[2, 0]) > 1 - 1e-12:  # roll and yaw turn about one axis
        return np.array([0.0, pitch, np.arctan2(-rotation[0, 1], rotation[1, 1])])
    return np.array([np.arctan2(rotation[2, 1], rotation[2, 2]), pitch, np.arctan2(rotation[1, 0], rotation[0, 0])])


def fit_rotation(from_vectors: Array, to_vectors: Array, start: Array | None = None) -> Array:
    """R that minimises |to - R from| over rows (n, 3) (Kabsch 1976). Where the rows determine no rotation about some
    axis, the one nearest to `start` (default: identity)."""
    start = np.eye(3) if start is None else start
    h = to_vectors.T @ from_vectors
    h = h + 1e-9 * np.linalg.norm(h) * start
    u, _, vt = np.linalg.svd(h)
    return np.asarray(u @ np.diag([1, 1, np.sign(np.linalg.det(u @ vt))]) @ vt)
