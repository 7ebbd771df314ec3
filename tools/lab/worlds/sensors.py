"""Sensors of the hand and arm, with the errors of sim/sensors/sensors.yaml: rate, delay, jitter and
drop-out of each message; bias, drift, noise, hysteresis and step of each signal. Cables and
warm-up of the force-torque sensor are not represented.
"""

from __future__ import annotations

from collections import deque
from typing import Any, Callable, Deque, NamedTuple

import numpy as np
from arm import Arm
from palpate.messages import ft_wrench_t, hand_state_t, imu_t, robot_state_t
from rigid import Floats, Pose, cross, twist_at
from scene import Scene
from scene_reader import SceneError
from scipy.spatial.transform import Rotation

GRAVITY_W = np.array([0, 0, -9.81])  # m/s^2


class Reading(NamedTuple):
    """A message that is due."""

    channel: str
    message: Any


class Signal:
    """Adds a sensor's errors to a vector: play, bias and random walk, noise, quantisation."""

    def __init__(
        self, errors: dict[str, float], rate: float, bias: Any, random: np.random.Generator
    ) -> None:
        self._step, self._noise = float(errors["step"]), float(errors["noise"])
        self._walk = float(errors["drift"]) / np.sqrt(rate)
        self._play = float(errors.get("hysteresis", 0))
        self._offset, self._random = np.array(bias, float), random
        self._played: Any = None

    def measure(self, value: Floats) -> Floats:
        played = value if self._played is None else self._played
        self._played = np.clip(played, value - self._play, value + self._play)
        if self._walk > 0:
            self._offset = self._offset + self._walk * self._random.standard_normal(len(value))
        noise = self._noise * self._random.standard_normal(len(value))
        measured = self._played + self._offset + noise
        if self._step > 0:
            measured = self._step * np.round(measured / self._step)
        return np.asarray(measured)


class _Channel:
    """Samples at a rate, delivers late and in order, with losses."""

    def __init__(
        self,
        name: str,
        timing: dict[str, float],
        measure: Callable[[], Any],
        random: np.random.Generator,
    ) -> None:
        self._name, self._measure, self._random = name, measure, random
        self._rate, self._delay = float(timing["rate"]), float(timing["delay"])
        self._jitter, self._drop_out = float(timing["jitter"]), float(timing["drop_out"])
        self._count, self._next_us, self._last_us = 0, 0, 0
        self._queue: Deque[tuple[int, Any]] = deque()

    def sample(self, now_us: int, utime: int) -> None:
        if now_us < self._next_us:
            return
        self._count += 1
        self._next_us = int(np.ceil(self._count * 1e6 / self._rate - 1e-6))
        message = self._measure()
        message.utime = utime
        late = self._delay + self._jitter * abs(self._random.standard_normal())
        if self._random.uniform() < self._drop_out:
            return
        self._last_us = max(self._last_us, now_us + round(1e6 * late))
        self._queue.append((self._last_us, message))

    def due(self, now_us: int) -> list[Reading]:
        readings = []
        while self._queue and self._queue[0][0] <= now_us:
            readings.append(Reading(self._name, self._queue.popleft()[1]))
        return readings


class SensorSuite:
    """FT_WRENCH, IMU, ROBOT_STATE and HAND_STATE of an arm."""

    def __init__(self, scene: Scene, arm: Arm) -> None:
        """Raises SceneError."""
        self._arm, self._scene = arm, scene
        self._wrench_O = np.zeros(6)  # of the hand on the object at G, in O
        table = scene.sensors
        _reject_unsupported(scene, table["force_torque"])
        seeds = np.random.SeedSequence(scene.seed).spawn(11)
        random = [np.random.default_rng(seed) for seed in seeds]

        def signal(sensor: str, name: str, bias: Any, index: int) -> Signal:
            return Signal(table[sensor][name], float(table[sensor]["rate"]), bias, random[index])

        force_bias, imu_bias = table["force_torque"]["bias"], table["imu"]["bias"]
        joints = np.zeros(len(arm.q))
        self._force = signal("force_torque", "force", force_bias[:3], 0)
        self._torque = signal("force_torque", "torque", force_bias[3:], 1)
        self._acceleration = signal("imu", "acceleration", imu_bias[:3], 2)
        self._rotation = signal("imu", "angular_velocity", imu_bias[3:], 3)
        self._position = signal("robot_state", "position", joints, 4)
        self._velocity = signal("robot_state", "velocity", joints, 5)
        self._joint_torque = signal("robot_state", "torque", joints, 6)
        error = table.get("kinematics_error", {})
        angles = error.get("rpy_deg", [0, 0, 0])
        X_error = Pose(
            Rotation.from_euler("xyz", angles, degrees=True).as_matrix(),
            np.array(error.get("position", [0, 0, 0]), float),
        )
        self._X_EE = scene.X_EG @ X_error @ scene.X_EG.inverse()
        self._channels = [
            _Channel("ROBOT_STATE", table["robot_state"], self._robot_state, random[7]),
            _Channel("HAND_STATE", table["hand_state"], self._hand_state, random[8]),
            _Channel("IMU", table["imu"], self._imu, random[9]),
            _Channel("FT_WRENCH", table["force_torque"], self._ft_wrench, random[10]),
        ]

    def sample(self, now_us: int, utime: int, wrench_O: Floats) -> list[Reading]:
        """Messages that arrive at `now_us` of simulated time; `wrench_O`: of the hand on the
        object at G, in O."""
        self._wrench_O = wrench_O
        readings = []
        for channel in self._channels:
            channel.sample(now_us, utime)
            readings += channel.due(now_us)
        return readings

    def _sensor_wrench(self) -> Floats:
        """Of the sensor on the hand, about the origin of S, in S: weight and inertia of the hand,
        and what the hand does to the object."""
        arm, payload = self._arm, self._arm.model.payload
        X_WS = arm.X_WE @ arm.model.X_ES
        to_sensor = X_WS.position - arm.X_WE.position
        lever = X_WS.rotation @ payload.centre
        force = payload.mass * (arm.acceleration_at(to_sensor + lever) - GRAVITY_W)
        moment = X_WS.rotation @ payload.inertia @ X_WS.rotation.T
        omega, alpha = arm.V_WE[3:], arm.A_WE[3:]
        torque = cross(lever, force) + moment @ alpha + cross(omega, moment @ omega)
        R_WO = self._scene.body.pose.rotation
        held = R_WO @ self._wrench_O[:3]
        to_grasp = arm.X_WE.of(self._scene.X_EG.position) - X_WS.position
        torque = torque + R_WO @ self._wrench_O[3:] + cross(to_grasp, held)
        R_SW = X_WS.rotation.T
        return np.concatenate([R_SW @ (force + held), R_SW @ torque])

    def _ft_wrench(self) -> ft_wrench_t:
        wrench = self._sensor_wrench()
        message = ft_wrench_t()
        message.wrench = [*self._force.measure(wrench[:3]), *self._torque.measure(wrench[3:])]
        return message

    def _imu(self) -> imu_t:
        arm = self._arm
        X_WI = arm.X_WE @ arm.model.X_EI
        acceleration = arm.acceleration_at(X_WI.position - arm.X_WE.position) - GRAVITY_W
        message = imu_t()
        message.acceleration = self._acceleration.measure(X_WI.rotation.T @ acceleration).tolist()
        turning = X_WI.rotation.T @ arm.V_WE[3:]
        message.angular_velocity = self._rotation.measure(turning).tolist()
        return message

    def _robot_state(self) -> robot_state_t:
        arm, count = self._arm, len(self._arm.q)
        q, dq = self._position.measure(arm.q), self._velocity.measure(arm.dq)
        X_WE, jacobian = arm.model.flange(q)
        X_reported = X_WE @ self._X_EE
        offset = X_reported.position - X_WE.position
        # Torque that holds the object: an ideal arm compensates the weight of its links.
        R_WO = self._scene.body.pose.rotation
        to_grasp = X_WE.rotation @ self._scene.X_EG.position
        held = R_WO @ self._wrench_O[:3]
        at_flange = np.concatenate([held, R_WO @ self._wrench_O[3:] + cross(to_grasp, held)])
        message = robot_state_t()
        message.joint_count = count
        message.q[:count], message.dq[:count] = q.tolist(), dq.tolist()
        message.tau[:count] = self._joint_torque.measure(jacobian.T @ at_flange).tolist()
        message.position = X_reported.position.tolist()
        message.quaternion = X_reported.quaternion()
        message.twist = twist_at(jacobian @ dq, offset).tolist()
        return message

    def _hand_state(self) -> hand_state_t:
        message = hand_state_t()
        message.grasp = hand_state_t.GRASP_HOLDING
        message.fingertip_quaternion = [[1.0, 0.0, 0.0, 0.0] for _ in range(5)]
        return message


def _reject_unsupported(scene: Scene, force_torque: dict[str, Any]) -> None:
    cable, warm_up = force_torque["cable"], force_torque["warm_up"]
    if any(cable.values()) or any(warm_up["wrench"]):
        raise SceneError(
            f"{scene.file}: sensors.force_torque: cable and warm_up are not supported by "
            "palpate-world; palpate-sim has them"
        )
