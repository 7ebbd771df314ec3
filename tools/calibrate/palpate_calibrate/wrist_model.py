"""What the sensors of a wrist read in a motion. Signs and frames are those of core/sensing/payload.hpp: the wrench that
the sensor exerts on its load, in S (Kubus, Kroeger and Wahl 2007)."""

from __future__ import annotations

import numpy as np

from palpate_calibrate.motion import Motion, MotionSample
from palpate_calibrate.parameters import WristParameters
from palpate_common.rotations import Array, cross, exp_rotation


def tilt_axes(gravity_W: Array) -> Array:
    """Two unit vectors at right angles to gravity and to each other, in W, (2, 3)."""
    down = gravity_W / np.linalg.norm(gravity_W)
    first = cross(down, np.array([1.0, 0, 0] if abs(down[0]) < 0.9 else [0, 1.0, 0]))
    first /= np.linalg.norm(first)
    return np.array([first, cross(down, first)])


def gravity_of(parameters: WristParameters, gravity_W: Array) -> Array:
    """Gravity in W, turned by the tilt about tilt_axes(), m/s^2."""
    return np.asarray(exp_rotation(parameters.gravity_tilt @ tilt_axes(gravity_W)) @ gravity_W)


def _at_point(sample: MotionSample, gravity_W: Array, point: Array) -> Array:
    """Specific force at a point of the flange, in E, (n, 3)."""
    force = sample.specific_force(gravity_W)
    return np.asarray(force + cross(sample.angular_acceleration, point) + _centripetal(sample.rate_products, point))


def _centripetal(products: Array, point: Array) -> Array:
    """omega x (omega x point)."""
    return np.asarray(products @ point - np.trace(products, axis1=1, axis2=2)[:, None] * point)


def _gyroscopic(products: Array, inertia: Array) -> Array:
    """omega x (inertia omega)."""
    m = inertia @ products
    return np.stack([m[:, 2, 1] - m[:, 1, 2], m[:, 0, 2] - m[:, 2, 0], m[:, 1, 0] - m[:, 0, 1]], axis=1)


def load_wrench(parameters: WristParameters, sample: MotionSample, gravity_W: Array) -> tuple[Array, Array]:
    """Force and torque of the load alone, N and N m, (n, 3) each."""
    R_ES, mc = parameters.R_ES, parameters.moment
    f = _at_point(sample, gravity_of(parameters, gravity_W), parameters.sensor_position) @ R_ES
    alpha, products = sample.angular_acceleration @ R_ES, R_ES.T @ sample.rate_products @ R_ES
    xx, xy, xz, yy, yz, zz = parameters.inertia
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return (parameters.mass * f + cross(alpha, mc) + _centripetal(products, mc),
            cross(mc, f) + alpha @ inertia + _gyroscopic(products, inertia))  # fmt: skip


def predict_wrench(parameters: WristParameters, motion: Motion, gravity_W: Array) -> tuple[Array, Array]:
    """Force and torque at the grid's times, N and N m, (n, 3) each."""
    force, torque = load_wrench(parameters, motion.at(parameters.wrench_delay), gravity_W)
    span = motion.time[-1] - motion.time[0]
    phase = ((motion.time - motion.time[0]) / span - 0.5)[:, None] if span > 0 else np.zeros((len(force), 1))
    R_SW = np.swapaxes(motion.rotation_WE @ parameters.R_ES, 1, 2)
    force = force + np.einsum("nij,nj->ni", R_SW, parameters.cable_stiffness * motion.travel)
    torque = torque + np.einsum("nij,nj->ni", R_SW, parameters.cable_torsion * motion.turn)
    force = force + parameters.force_bias + phase * parameters.force_drift
    torque = torque + parameters.torque_bias + phase * parameters.torque_drift
    return (force - motion.directions[:, :3] * parameters.force_hysteresis,
            torque - motion.directions[:, 3:] * parameters.torque_hysteresis)  # fmt: skip


def predict_inertial(parameters: WristParameters, motion: Motion, gravity_W: Array) -> tuple[Array, Array]:
    """Specific force and angular velocity in I at the grid's times, m/s^2 and rad/s, (n, 3) each."""
    sample = motion.at(parameters.imu_delay)
    in_E = _at_point(sample, gravity_of(parameters, gravity_W), parameters.imu_position)
    return (in_E @ parameters.R_EI + parameters.acceleration_bias,
            sample.angular_velocity @ parameters.R_EI + parameters.rate_bias)  # fmt: skip


def predict(parameters: WristParameters, motion: Motion, gravity_W: Array, groups: list[str]) -> dict[str, Array]:
    """The readings of these groups, (n, 3) each."""
    out: dict[str, Array] = {}
    if "force" in groups:
        out["force"], out["torque"] = predict_wrench(parameters, motion, gravity_W)
    if "acceleration" in groups or "angular_velocity" in groups:
        out["acceleration"], out["angular_velocity"] = predict_inertial(parameters, motion, gravity_W)
    return {name: out[name] for name in groups}
