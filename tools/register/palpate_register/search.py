"""Coarse global search: many starts at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from palpate_common import robust
from palpate_common.pose import Pose, random_rotations
from palpate_common.rotations import exp_rotation, from_wxyz
from palpate_common.surface import Surface
from palpate_register.observations import Observations

Floats = NDArray[np.float64]
ACROSS = 0.1  # weight of a distance across the normal, relative to one along it
SAMPLES = 1000
MOST_OF_CLOUD = 60
STEPS = 12


def starts(surface: Surface, observed: Observations, count: int, random: np.random.Generator) -> tuple[Floats, Floats]:
    """Rotations, (count, 3, 3), and centres of the object in W, (count, 3), m.

    Within the range of the guess; without one, over all rotations, about the points' mean.
    """
    if observed.guess is not None:
        guess = observed.guess
        axes = random.normal(size=(count, 3))
        axes *= (guess.angle_range * random.uniform(size=count) ** (1 / 3) / np.linalg.norm(axes, axis=1))[:, None]
        axes[0] = 0
        shifts = random.uniform(-guess.position_range, guess.position_range, (count, 3))
        shifts[0] = 0
        R = np.array([exp_rotation(axis) for axis in axes]) @ guess.pose.R
        return R, guess.pose.of(surface.center[None]) + shifts
    R = random_rotations(random, count)
    offsets = random.uniform(-0.3, 0.3, (count, 3)) * surface.sides
    return R, observed.points.mean(axis=0) + np.einsum("mij,mj->mi", R, offsets)


def coarse_search(surface: Surface, observed: Observations, count: int, seed: int) -> list[Pose]:
    """Poses in order of their loss, the best first.

    All starts take the same number of damped Gauss-Newton steps on distances to a sampled surface;
    samples are matched by place and, where a normal was measured, by normal (as in Rusinkiewicz and
    Levoy 2001). The camera's error counts as uncertainty of the touches.
    """
    random = np.random.default_rng(seed)
    R, center = starts(surface, observed, count, random)
    samples, of = surface.samples(SAMPLES)
    samples, normals = samples - surface.center, surface.normals[of]
    spacing = np.sqrt(surface.areas.sum() / SAMPLES)
    points, measured, deviation = _data(observed, spacing)
    has = np.linalg.norm(measured, axis=1) > 0.5
    turned = 0.15 * surface.largest_side  # m: a distance equivalent to opposite normals, halved
    plain, matched = cKDTree(samples), cKDTree(np.hstack([samples, turned * normals]))
    weight = 1 / deviation**2
    for step in range(STEPS):
        q = np.einsum("mji,mnj->mni", R, points[None] - center[:, None])
        nearest = np.empty(q.shape[:2], np.int64)
        nearest[:, ~has] = plain.query(q[:, ~has])[1]
        n_O = np.einsum("mji,nj->mni", R, measured[has])
        nearest[:, has] = matched.query(np.concatenate([q[:, has], turned * n_O], axis=2))[1]
        s, n = samples[nearest], normals[nearest]
        e = q - s
        along = np.einsum("mni,mni->mn", e, n)
        widening = 10.0 if step < STEPS // 2 else 4.0
        size = np.sqrt(along**2 + ACROSS * (e**2).sum(axis=2)) / deviation
        if step == STEPS - 1:
            break
        w = weight * robust.weights(size / widening)
        # Residual W^(1/2) e with W = n n' + ACROSS I, by a motion of the surface in O.
        W = np.einsum("mni,mnj->mnij", n, n) + ACROSS * np.eye(3)
        G = np.zeros((*q.shape[:2], 3, 6))
        G[..., :3] = -np.eye(3)
        G[..., 0, 4], G[..., 0, 5], G[..., 1, 3] = -s[..., 2], s[..., 1], s[..., 2]
        G[..., 1, 5], G[..., 2, 3], G[..., 2, 4] = -s[..., 0], -s[..., 1], s[..., 0]
        WG = np.einsum("mn,mnij,mnjk->mnik", w, W, G)
        H = np.einsum("mnik,mnil->mkl", WG, G)
        g = np.einsum("mnik,mni->mk", WG, e)
        scale = np.trace(H[:, :3, :3], axis1=1, axis2=2)[:, None] / 3
        lever = np.array([1.0] * 3 + [(0.3 * surface.largest_side) ** 2] * 3)
        H += np.einsum("mk,kl->mkl", 0.01 * np.maximum(scale, 1e-9) * lever, np.eye(6))
        x = -np.linalg.solve(H, g[..., None])[..., 0]
        center = center + np.einsum("mij,mj->mi", R, x[:, :3])
        R = R @ _small_rotations(np.clip(x[:, 3:], -0.5, 0.5))
    cost = robust.loss(size / 3).sum(axis=1)
    if observed.guess is not None:
        cost = cost + _prior_cost(R, center, observed, surface)
    return [Pose(R[i], center[i] - R[i] @ surface.center) for i in np.argsort(cost, kind="stable")]


def _small_rotations(vectors: Floats) -> Floats:
    """(m, 3, 3) of rotation vectors, (m, 3), rad."""
    half = 0.5 * np.linalg.norm(vectors, axis=1, keepdims=True)
    return from_wxyz(np.hstack([np.cos(half), 0.5 * np.sinc(half / np.pi) * vectors]))


def _data(observed: Observations, spacing: float) -> tuple[Floats, Floats, Floats]:
    """Points and normals in W, (n, 3), and deviations, (n,), m, of the coarse search."""
    touches, cloud = observed.touches, observed.cloud
    deviation = np.hypot(touches.deviation + touches.radius, 0.5 * spacing)
    if cloud is None:
        return touches.points, touches.normals, deviation
    thin = cloud.thinned(MOST_OF_CLOUD)
    points = np.concatenate([touches.points, thin.points])
    normals = np.concatenate([touches.normals, np.zeros_like(thin.points)])
    of_cloud = np.full(len(thin.points), np.hypot(thin.deviation, 0.5 * spacing))
    return points, normals, np.concatenate([np.hypot(deviation, cloud.shift_deviation), of_cloud])


def _prior_cost(R: Floats, center: Floats, observed: Observations, surface: Surface) -> Floats:
    guess = observed.guess
    assert guess is not None
    shift = (center - guess.pose.of(surface.center[None])) / guess.deviation[:3]
    trace = np.einsum("mij,ij->m", R, guess.pose.R)
    angle = np.arccos(np.clip(0.5 * (trace - 1), -1, 1)) / guess.deviation[3]
    result: Floats = 0.5 * (shift**2).sum(axis=1) + 0.5 * angle**2
    return result
