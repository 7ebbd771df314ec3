"""An ideal arm: its joints follow velocities exactly, within limits; it moves by the scene's motion
or obeys commands, as sim/robot/velocity_follower.cpp does with a simulated one.
"""

from __future__ import annotations

from typing import Optional

import numpy as np
from rigid import Floats, Pose, cross, exp_rotation, log_rotation, twist_at
from robot_model import RobotModel
from scene import Scene

_ACCELERATION = 15.0  # rad/s^2, of every joint
_MARGIN = 0.02  # rad, to the end of a joint
_POSTURE_GAIN = 1.0  # 1/s, in the null space
_SINGULARITY = 0.05  # smallest singular value below which rates are damped
_DAMPING = 0.05
_TIME_OUT = 0.1  # s without a command until the arm stops
_MOTION_GAIN = 10.0  # 1/s, from the error of the pose to the twist


class Arm:
    """Joints q, rad, and what follows from them."""

    def __init__(self, scene: Scene) -> None:
        """Raises SceneError."""
        self.model = RobotModel(scene)
        self._scene = scene
        self.q = scene.initial_joints.copy()
        self._posture = self.q.copy()
        self.dq = np.zeros(len(self.q))
        self._twist: Optional[Floats] = None
        self._rates: Optional[Floats] = None
        self._age = 0.0
        self.X_WE, self.jacobian = self.model.flange(self.q)
        self.V_WE = np.zeros(6)  # linear first, origin of E, in W
        self.A_WE = np.zeros(6)  # its derivative in W
        self._first = self.grasp_in_object()

    @property
    def obeys(self) -> bool:
        """Whether it follows commands rather than the scene's motion."""
        return not self._scene.legs

    def grasp_in_object(self) -> Pose:
        """X_OG."""
        return self._scene.body.pose.inverse() @ self.X_WE @ self._scene.X_EG

    def command_twist(self, twist: Floats) -> None:
        """Of the flange in W, until the next command or its time-out."""
        self._twist, self._rates, self._age = twist, None, 0.0

    def command_joints(self, rates: Floats) -> None:
        self._twist, self._rates, self._age = None, rates, 0.0

    def stop(self) -> None:
        self._twist = self._rates = None

    def step(self, time: float, dt: float) -> None:
        """From `time` to `time + dt`, s."""
        if not self.obeys:
            self._follow_motion(time)
        self._age += dt
        target = np.zeros(len(self.q))
        if self._age <= _TIME_OUT + 1e-9:
            if self._twist is not None:
                target = self._resolved_rates(self._twist)
            if self._rates is not None:
                target = self._rates
        before = self.V_WE
        self.dq = self._limited(target, dt)
        self.q = self.q + self.dq * dt
        self.X_WE, self.jacobian = self.model.flange(self.q)
        self.V_WE = self.jacobian @ self.dq
        self.A_WE = (self.V_WE - before) / dt

    def publish(self, channel: str, message: object) -> bool:
        """Whether the arm's own messages contain what is to be published on the channel."""
        return False

    def acceleration_at(self, offset: Floats) -> Floats:
        """Of the hand's point that lies `offset`, in W, from the origin of E: m/s^2 in W."""
        omega, alpha = self.V_WE[3:], self.A_WE[3:]
        centripetal = cross(omega, cross(omega, offset))
        return np.asarray(self.A_WE[:3] + cross(alpha, offset) + centripetal)

    def _follow_motion(self, time: float) -> None:
        translation, turn, rate = motion_at(self._scene, time)
        X_OG = self.grasp_in_object()
        linear = rate[:3] + _MOTION_GAIN * (self._first.position + translation - X_OG.position)
        error = turn @ self._first.rotation @ X_OG.rotation.T
        angular = rate[3:] + _MOTION_GAIN * log_rotation(error)
        R_WO = self._scene.body.pose.rotation
        offset = self.X_WE.rotation @ self._scene.X_EG.position
        twist = np.concatenate([R_WO @ linear, R_WO @ angular])
        self.command_twist(twist_at(twist, -offset))

    def _resolved_rates(self, twist: Floats) -> Floats:
        J = self.jacobian
        squared = J @ J.T
        smallest = np.sqrt(max(0.0, np.linalg.eigvalsh(squared)[0]))
        if smallest < _SINGULARITY:
            squared = squared + (_DAMPING * (1 - smallest / _SINGULARITY)) ** 2 * np.eye(6)
        pull = _POSTURE_GAIN * (self._posture - self.q)
        return np.asarray(pull + J.T @ np.linalg.solve(squared, twist - J @ pull))

    def _limited(self, target: Floats, dt: float) -> Floats:
        up = _fastest(self.model.upper - _MARGIN - self.q)
        down = _fastest(self.q - self.model.lower - _MARGIN)
        target = target / max(1.0, float((np.abs(target) / self.model.speed).max()))
        change = np.clip(target, -down, up) - self.dq
        most = _ACCELERATION * dt
        change = change / max(1.0, float(np.abs(change).max()) / most)
        change = np.clip(np.clip(change, -down - self.dq, up - self.dq), -most, most)
        return np.asarray(self.dq + change)


def _fastest(gap: Floats) -> Floats:
    """Speed at a distance from a joint's end, rad/s: braking uses half the acceleration."""
    gap = np.maximum(gap, 0)
    return np.minimum(10 * gap, np.sqrt(_ACCELERATION * gap))


def motion_at(scene: Scene, time: float) -> tuple[Floats, Floats, Floats]:
    """Translation (m), rotation and twist (m/s, rad/s) of the grasp relative to its first pose, in
    O: minimum-jerk moves from pose to pose."""
    translation, rotation = np.zeros(3), np.eye(3)
    begin = scene.start_delay
    for leg in scene.legs:
        if time <= begin:
            break
        target = exp_rotation(leg.rotation)
        if time < begin + leg.move:
            x = (time - begin) / leg.move
            share = x**3 * (10 + x * (-15 + 6 * x))
            rate = 30 * x**2 * (1 - x) ** 2 / leg.move
            way = leg.translation - translation
            turn = log_rotation(target @ rotation.T)
            return (
                translation + share * way,
                exp_rotation(share * turn) @ rotation,
                np.concatenate([rate * way, rate * turn]),
            )
        translation, rotation = leg.translation, target
        begin += leg.move + leg.hold
    return translation, rotation, np.zeros(6)
