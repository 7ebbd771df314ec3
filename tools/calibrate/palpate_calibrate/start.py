"""Values from which the least squares start: delays by trial, rotations by matching directions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate_calibrate.motion import LARGEST_DELAY, Motion
from palpate_calibrate.parameters import WristParameters, point_inertia
from palpate_calibrate.recording import Mounting
from palpate_calibrate.wrist_model import gravity_of, tilt_axes
from palpate_common.rotations import Array, cross_matrix, fit_rotation

TRIAL = 0.01  # s, between two trial delays
# A sensor of the other polarity fits better by this factor, or it is not assumed.
CLEARLY = 0.8


@dataclass
class _Match:
    delay: float
    rotation: Array
    scale: float
    error: float


def _match(signal: Array, of_motion: list[Array], delays: Array, start: Array | None,
           is_known: bool = False) -> _Match:  # fmt: skip
    """Delay, rotation from E and positive factor with which a part of the motion explains a signal, both without
    their means, (n, 3)."""
    best = None
    centred = signal - signal.mean(axis=0)
    for delay, moved in zip(delays, of_motion):
        source = moved - moved.mean(axis=0)
        rotation = start if is_known and start is not None else fit_rotation(source, centred, start)
        turned = source @ rotation.T
        scale = max(float((turned * centred).sum() / max((source**2).sum(), 1e-12)), 0.0)
        error = float(((centred - scale * turned) ** 2).sum())
        if best is None or error < best.error:
            best = _Match(float(delay), rotation, scale, error)
    assert best is not None
    return best


def gravity_tilt(motion: Motion, force: Array, gravity: Array, R_ES: Array) -> Array:
    """Tilt of gravity's direction from readings with a known rotation of the sensor: F = bias - R_SW (m g) is linear in
    the weight in W and the bias in S. Of the two directions that a sensor of unknown polarity allows, the smaller tilt."""
    R_SW = np.einsum("ji,njk->nik", R_ES, motion.at(0.0).rotation_EW)
    rows = np.concatenate([-R_SW, np.broadcast_to(np.eye(3), R_SW.shape)], axis=2).reshape(-1, 6)
    weight = np.linalg.lstsq(rows, force.reshape(-1), rcond=1e-6)[0][:3]
    down = gravity / np.linalg.norm(gravity)
    weight = weight / max(np.linalg.norm(weight), 1e-12) * (1 if weight @ down >= 0 else -1)
    axis = np.cross(down, weight)
    angle = np.arctan2(np.linalg.norm(axis), down @ weight)
    return np.asarray(tilt_axes(gravity) @ axis * angle / max(np.linalg.norm(axis), 1e-12))


def start_values(motion: Motion, signals: dict[str, Array], gravity: Array, mounting: Mounting, is_tilted: bool,
                 ) -> tuple[WristParameters, int]:  # fmt: skip
    """Starting values, and the sensor's polarity: -1 where it reports what its load exerts on it."""
    tilt = np.zeros(2)
    if is_tilted:
        R_ES = np.eye(3) if mounting.sensor_rotation is None else mounting.sensor_rotation
        tilt = gravity_tilt(motion, signals["force"], gravity, R_ES)
        gravity = gravity_of(WristParameters(gravity_tilt=tilt), gravity)
    delays = np.zeros(1) if motion.at_rest else np.arange(-LARGEST_DELAY, LARGEST_DELAY + 1e-9, TRIAL)
    samples = [motion.at(delay) for delay in delays]
    forces = [sample.specific_force(gravity) for sample in samples]
    nominal = None if mounting.sensor_rotation is None else mounting.sensor_rotation.T
    # With an unknown direction of gravity the rotation of the mounting is the reference.
    is_known = is_tilted or mounting.sensor_rotation_is_exact
    upright = _match(signals["force"], forces, delays, nominal, is_known)
    reversed_ = _match(-signals["force"], forces, delays, nominal, is_known)
    polarity = -1 if reversed_.error < CLEARLY * upright.error else 1
    force = upright if polarity == 1 else reversed_
    R_SE = force.rotation
    f = forces[int(np.argmin(np.abs(delays - force.delay)))] @ R_SE.T
    measured_force, measured_torque = polarity * signals["force"], polarity * signals["torque"]
    moment, torque_bias = _moment(f, measured_torque)
    inertia = point_inertia(force.scale, moment)
    values = dict(mass=force.scale, moment=moment, inertia=inertia, torque_bias=torque_bias, R_ES=R_SE.T,
                  force_bias=(measured_force - force.scale * f).mean(axis=0), wrench_delay=force.delay, gravity_tilt=tilt,
                  sensor_position=mounting.sensor_position, imu_position=mounting.imu_position)  # fmt: skip
    if "angular_velocity" in signals and not motion.at_rest:
        known = None if mounting.imu_rotation is None else mounting.imu_rotation.T
        turn = _match(signals["angular_velocity"], [s.angular_velocity for s in samples], delays, known)
        values.update(R_EI=turn.rotation.T, imu_delay=turn.delay)
    elif "acceleration" in signals:
        known = None if mounting.imu_rotation is None else mounting.imu_rotation.T
        tilt = _match(signals["acceleration"], forces, delays, known)
        values.update(R_EI=tilt.rotation.T, imu_delay=tilt.delay)
    return WristParameters(**values), polarity


def _moment(f: Array, torque: Array) -> tuple[Array, Array]:
    """First moment and bias of T = mc x f + bias by least squares."""
    rows = np.concatenate([-cross_matrix(f), np.broadcast_to(np.eye(3), (len(f), 3, 3))], axis=2).reshape(-1, 6)
    solution = np.linalg.lstsq(rows, torque.reshape(-1), rcond=1e-6)[0]
    return solution[:3], solution[3:]
