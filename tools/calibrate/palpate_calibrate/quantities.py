"""Results in users' units, with 95 % intervals."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import stdtrit

from palpate_calibrate.fit import WristFit
from palpate_common.rotations import Array, to_rpy


@dataclass(frozen=True)
class Quantity:
    """`half_width` of the 95 % interval, in `unit`. `is_determined`: see observability."""

    name: str
    value: float
    half_width: float
    unit: str
    is_determined: bool


# block, name of the result, unit, factor from SI
_PLAIN = (
    ("mass", "mass", "kg", 1),
    ("moment", "center_of_mass", "mm", 1e3),
    ("inertia", "inertia", "kg m^2", 1),
    ("force_bias", "force_bias", "N", 1),
    ("torque_bias", "torque_bias", "N m", 1),
    ("force_drift", "force_drift", "N", 1),
    ("torque_drift", "torque_drift", "N m", 1),
    ("force_hysteresis", "force_hysteresis", "N", 1),
    ("torque_hysteresis", "torque_hysteresis", "N m", 1),
    ("cable_stiffness", "cable_stiffness", "N/m", 1),
    ("cable_torsion", "cable_torsion", "N m/rad", 1),
    ("sensor_rotation", "sensor_rotation", "deg", np.degrees(1)),
    ("gravity_tilt", "gravity_tilt", "deg", np.degrees(1)),
    ("wrench_delay", "wrench_delay", "ms", 1e3),
    ("imu_rotation", "imu_rotation", "deg", np.degrees(1)),
    ("acceleration_bias", "acceleration_bias", "m/s^2", 1),
    ("rate_bias", "rate_bias", "rad/s", 1),
    ("imu_delay", "imu_delay", "ms", 1e3),
)
# Positions stay those of the drawing: slow motions hardly depend on them. They are free in the fit, within their deviation,
# so that the intervals of the others allow for them.
FROM_DRAWING = ("sensor_position", "imu_position")
# Largest ratio of the standard deviations after and before the recording of a parameter that counts as determined.
LEARNT = 0.3


def deviations(fit: WristFit, block: str) -> Array:
    """Standard deviations of a block's entries; of `moment` those of the centre of mass, m."""
    rows = fit.rows[block]
    if block != "moment" or fit.parameters.mass <= 0:
        return np.asarray(np.sqrt(np.diag(fit.covariance)[rows]))
    c, mass = fit.parameters.center_of_mass, fit.parameters.mass
    together = [fit.rows["mass"].start, *range(rows.start, rows.stop)]
    derivative = np.hstack([-c[:, None], np.eye(3)]) / mass
    return np.asarray(np.sqrt(np.diag(derivative @ fit.covariance[np.ix_(together, together)] @ derivative.T)))


def half_widths(fit: WristFit, block: str) -> Array:
    """Of the 95 % intervals of a block's entries, by Student's distribution."""
    return np.asarray(stdtrit(fit.freedom[fit.rows[block]], 0.975) * deviations(fit, block))


def is_determined(fit: WristFit, block: str) -> Array:
    """Of each entry, whether the recording determines it: its deviation has fallen, and a mass exceeds its interval."""
    rows = fit.rows[block]
    ratio = np.sqrt(np.diag(fit.covariance)[rows]) / fit.prior[rows]
    mass = fit.rows["mass"].start
    has_mass = fit.parameters.mass > 2 * np.sqrt(fit.covariance[mass, mass])
    return np.asarray((ratio < LEARNT) & (has_mass or block not in ("mass", "moment", "inertia")))


def _values(fit: WristFit, block: str) -> Array:
    p = fit.parameters
    if block == "moment":
        return p.center_of_mass
    if block in ("sensor_rotation", "imu_rotation"):
        return to_rpy(p.R_ES if block == "sensor_rotation" else p.R_EI)
    return np.atleast_1d(getattr(p, block))


def quantities(fit: WristFit) -> list[Quantity]:
    """All results. Rotations are roll, pitch and yaw as in a configuration; their intervals are those of small rotations
    about x, y and z of the sensor. Biases refer to the middle of the recording, drifts are those over it."""
    out = []
    for block in fit.blocks:
        if block.name in FROM_DRAWING:
            continue
        name, unit, factor = next(row[1:] for row in _PLAIN if row[0] == block.name)
        ends = [label[len(block.name) :] for label in block.labels]
        if block.name in ("sensor_rotation", "imu_rotation"):
            ends = ["_roll", "_pitch", "_yaw"]
        entries = zip(ends, _values(fit, block.name), half_widths(fit, block.name), is_determined(fit, block.name))
        for end, value, half_width, known in entries:
            out.append(Quantity(name + end, float(factor * value), float(factor * half_width), unit, bool(known)))
    return out
