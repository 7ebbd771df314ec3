"""Normalised residuals of touches, normals, cloud and prior, with their derivatives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Optional

import numpy as np
from numpy.typing import NDArray

from palpate_common.pose import Pose, difference, moved
from palpate_common.rotations import exp_rotation, log_rotation
from palpate_common.surface import Surface, gradients
from palpate_register.observations import Cloud, Guess, Observations, Touches

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class State:
    """Pose of the object, and the error of the camera, which moves the cloud's points."""

    pose: Pose  # X_WO
    shift: Floats  # (3,), m, in W
    turn: Floats  # (3, 3), rotation about the cloud's middle

    def stepped(self, step: Floats, about: Floats) -> "State":
        """After a step, (6,) or (12,): motion of the object (see `moved`), shift, rotation, in W."""
        pose = moved(self.pose, step[:6], about)
        if len(step) == 6:
            return State(pose, self.shift, self.turn)
        return State(pose, self.shift + step[6:9], exp_rotation(step[9:]) @ self.turn)


def start_at(pose: Pose) -> State:
    """With a camera that is where it should be."""
    return State(pose, np.zeros(3), np.eye(3))


@dataclass(frozen=True, eq=False)
class Residuals:
    """Normalised residuals, (m,), and derivatives by the step of `State`, (m, 6 or 12)."""

    r: Floats
    J: Floats
    is_robust: NDArray[np.bool_]  # (m,), of distances, which may be gross errors
    feet: Floats  # (k, 3), W, m: closest points of the surface; of touches, then of the cloud
    # (n, 6), of the touches, from which the information about the pose follows (see `TouchRows`).
    J_inside: Floats


@dataclass(frozen=True, eq=False)
class TouchRows:
    """Of touches at a pose: distances, then normals, and where the surface is touched."""

    r: Floats  # (n,), normalised distances
    J: Floats  # (n, 6), derivatives by the pose
    # (n, 6), the same as if each touch lay inside its face. A touch beyond the edge of the face that
    # its normal names pushes the face there, but does not hold it: it bounds the pose to one side only.
    J_inside: Floats
    feet: Floats  # (n, 3), W, m, closest points
    normal_r: Floats  # (2 k,), of the k touches with a normal
    normal_J: Floats  # (2 k, 6)


def touch_rows(surface: Surface, pose: Pose, touches: Touches) -> TouchRows:
    """A normal's residuals are the surface normal's parts across the measured one."""
    has = touches.has_normal
    feet, chosen = surface.closest(pose.inverse_of(touches.points), touches.normals @ pose.R if has.any() else None)
    feet_W, normals_W = pose.of(feet), surface.normals[chosen] @ pose.R.T
    distance, g = gradients(touches.points, feet_W, normals_W)
    arm = feet_W - pose.of(surface.center[None])
    J, J_inside = (-np.hstack([d, np.cross(arm, d)]) / touches.deviation[:, None] for d in (g, normals_W))
    across, n = touches.across, normals_W[has]
    # d(R n) = w x (R n), so that e . d(R n) = ((R n) x e) . w.
    turns = np.cross(n[:, None], across).reshape(-1, 3)
    normal_J = np.hstack([np.zeros_like(turns), turns])
    return TouchRows((distance - touches.radius) / touches.deviation, J, J_inside, feet_W,
                     np.einsum("kij,kj->ki", across, n).ravel() / touches.normal_deviation,
                     normal_J / touches.normal_deviation)  # fmt: skip


def cloud_rows(surface: Surface, state: State, cloud: Cloud) -> tuple[Floats, Floats, Floats]:
    """Normalised distances, (n,), derivatives by pose and camera's error, (n, 12), and feet in W."""
    arm = (cloud.points - cloud.middle) @ state.turn.T
    points = cloud.middle + state.shift + arm
    feet, chosen = surface.closest(state.pose.inverse_of(points))
    feet_W, normals_W = state.pose.of(feet), surface.normals[chosen] @ state.pose.R.T
    distance, g = gradients(points, feet_W, normals_W)
    of_object = feet_W - state.pose.of(surface.center[None])
    J = np.hstack([-g, -np.cross(of_object, g), g, np.cross(arm, g)])
    return distance / cloud.point_deviation, J / cloud.point_deviation, feet_W


def prior_rows(surface: Surface, pose: Pose, guess: Optional[Guess]) -> tuple[Floats, Floats]:
    """Residuals of the guess, (6,) or (0,), and derivatives by the pose."""
    if guess is None:
        return np.zeros(0), np.zeros((0, 6))
    return difference(pose, guess.pose, surface.center) / guess.deviation, np.diag(1 / guess.deviation)


def residuals(surface: Surface, state: State, observed: Observations) -> Residuals:
    """All of them, in the order touches, cloud, normals, prior, camera's prior."""
    cloud, touches = observed.cloud, observed.touches
    width = 6 if cloud is None else 12
    parts = []

    def add(r: Floats, J: Floats, is_robust: bool) -> None:
        wide = np.zeros((len(r), width))
        wide[:, : J.shape[1]] = J
        parts.append((r, wide, np.full(len(r), is_robust)))

    touched = touch_rows(surface, state.pose, touches)
    add(touched.r, touched.J, True)
    all_feet = [touched.feet]
    if cloud is not None:
        r, J, feet_of_cloud = cloud_rows(surface, state, cloud)
        add(r, J, True)
        all_feet.append(feet_of_cloud)
    add(touched.normal_r, touched.normal_J, True)
    add(*prior_rows(surface, state.pose, observed.guess), False)
    if cloud is not None:
        deviation = np.repeat([cloud.shift_deviation, cloud.rotation_deviation], 3)
        r = np.concatenate([state.shift, log_rotation(state.turn)]) / deviation
        add(r, np.hstack([np.zeros((6, 6)), np.diag(1 / deviation)]), False)
    r, J, robust = (np.concatenate(columns) for columns in zip(*parts))
    return Residuals(r, J, robust, np.concatenate(all_feet), touched.J_inside)
