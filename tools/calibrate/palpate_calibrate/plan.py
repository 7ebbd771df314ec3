"""Poses of the flange that determine a wrist's load best: chosen one after the other so that the determinant of the
information grows most (D-optimal design, Fedorov 1972)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate_calibrate.motion import Motion
from palpate_calibrate.parameters import BLOCKS, WristParameters, point_inertia
from palpate_calibrate.recording import Recording, Stream
from palpate_calibrate.wrist_model import predict
from palpate_common.rotations import Array, exp_rotation, log_rotation

# Deviations of a mean over one pose: what no rigid payload explains, not the noise of single readings.
ERRORS = {"force": 0.1, "torque": 0.005, "acceleration": 0.05}
PLANNED = ("mass", "moment", "force_bias", "torque_bias", "sensor_rotation", "imu_rotation", "acceleration_bias")


@dataclass(frozen=True)
class Room:
    """Where the flange may go: within a box in W, and turned by at most `tilt` (rad) from the start."""

    start_position: Array  # m
    start_rotation: Array  # R_WE, (3, 3)
    lower: Array  # m
    upper: Array
    tilt: float

    def holds(self, position: Array) -> bool:
        return bool(np.all(position >= self.lower) and np.all(position <= self.upper))


@dataclass
class Plan:
    positions: Array  # of the flange in W, in order, the first again at the end, (n, 3)
    rotations: Array  # R_WE, (n, 3, 3)
    expected: dict[str, Array]  # standard deviation of each block's entries


def candidates(room: Room, count: int, seed: int) -> tuple[Array, Array]:
    """Random poses of the room, the start first."""
    random = np.random.default_rng(seed)
    axes = random.normal(size=(count, 3))
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    angles = room.tilt * random.uniform(0, 1, count) ** (1 / 3)  # most of them far from the start
    rotations = np.array([room.start_rotation @ exp_rotation(angle * axis) for angle, axis in zip(angles, axes)])
    positions = random.uniform(room.lower, room.upper, (count, 3))
    rotations[0], positions[0] = room.start_rotation, room.start_position
    return positions, rotations


def _sensitivities(rotations: Array, load: WristParameters, gravity: Array, has_imu: bool) -> tuple[Array, Array]:
    """Rows of the information of each pose, divided by ERRORS, (n, rows, parameters), and the priors."""
    n = len(rotations)
    time = np.arange(n, dtype=float)
    pose = Stream("poses", time, np.hstack([np.zeros((n, 3)), rotations.reshape(n, 9)]))
    motion = Motion(Recording("plan", pose, Stream("wrench", time, np.zeros((n, 6))), gravity=gravity, at_rest=True))
    blocks = [block for block in BLOCKS if block.name in PLANNED and (has_imu or block.concerns("force"))]
    groups = ["force", "torque"] + (["acceleration"] if has_imu else [])
    prior = np.concatenate([np.full(block.size, block.deviation) for block in blocks])
    columns = []
    for k in range(len(prior)):
        step = 1e-4 * np.eye(len(prior))[k]
        plus = predict(load.plus(blocks, step), motion, gravity, groups)
        minus = predict(load.plus(blocks, -step), motion, gravity, groups)
        columns.append(np.hstack([(plus[g] - minus[g]) / 2e-4 / ERRORS[g] for g in groups]))
    return np.stack(columns, axis=2), prior


def plan_poses(room: Room, count: int, mass: float, center: Array, R_ES: Array, gravity: Array, has_imu: bool = True,
               most: int = 400, seed: int = 1) -> Plan:  # fmt: skip
    """`count` poses for a load of about this mass (kg) and centre (in S, m); `most` candidates are compared."""
    load = WristParameters(mass=mass, moment=mass * center, inertia=point_inertia(mass, mass * center), R_ES=R_ES)
    positions, rotations = candidates(room, most, seed)
    rows, prior = _sensitivities(rotations, load, gravity, has_imu)
    information = np.diag(1 / prior**2) + rows[0].T @ rows[0]
    chosen = [0]
    while len(chosen) < count:
        inverse = np.linalg.inv(information)
        gains = np.linalg.slogdet(np.eye(rows.shape[1]) + rows @ inverse @ np.swapaxes(rows, 1, 2))[1]
        gains[chosen] = -np.inf
        best = int(np.argmax(gains))
        chosen.append(best)
        information = information + rows[best].T @ rows[best]
    order = _short_way(positions[chosen], rotations[chosen])
    chosen = [chosen[i] for i in order] + [0]
    deviations = np.sqrt(np.diag(np.linalg.inv(information)))
    expected, first = {}, 0
    for block in BLOCKS:
        if block.name in PLANNED and (has_imu or block.concerns("force")):
            expected[block.name] = deviations[first : first + block.size]
            first += block.size
    expected["moment"] = expected["moment"] / mass  # of the centre of mass
    return Plan(positions[chosen], rotations[chosen], expected)


def _short_way(positions: Array, rotations: Array) -> list[int]:
    """From the first to the nearest that is left, by angle and 0.5 rad per 0.1 m."""
    left, way = set(range(1, len(positions))), [0]
    while left:
        here = way[-1]
        angles = {i: np.linalg.norm(log_rotation(rotations[here].T @ rotations[i])) for i in left}
        distances = {i: angles[i] + 5 * np.linalg.norm(positions[i] - positions[here]) for i in left}
        way.append(min(distances, key=lambda i: (distances[i], i)))
        left.remove(way[-1])
    return way
