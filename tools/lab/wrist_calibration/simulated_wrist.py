"""A wrist with a load, a force-torque sensor and an inertial unit, simulated without any code of the calibration.

The load's momentum and angular momentum about its centre of mass are differentiated in the base's frame W; the estimator
uses Newton-Euler equations about the sensor's origin in the sensor's frame. Noise and steps: sim/sensors/sensors.yaml.
"""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation, RotationSpline

GRAVITY = np.array([0.0, 0.0, -9.81])
DT = 1e-3  # s
NOISE = {"force": (0.025, 0.0125), "torque": (0.001, 0.0005), "acceleration": (0.03, 0.0098),
         "rate": (0.0024, 0.000153)}  # standard deviation, step
POSE_NOISE = 5e-6  # m and rad
RATE = {"pose": 500, "wrench": 1000, "imu": 300}  # Hz
LEAD = 0.5  # s before and after, of which no stream reports


@dataclass
class Truth:
    """What is to be found, and the drawing from which the search starts."""

    mass: float
    center: np.ndarray  # in S, m
    inertia: np.ndarray  # about S, in S, (3, 3)
    bias: np.ndarray  # in the middle of the recording, (6,)
    drift: np.ndarray  # over the recording, (6,)
    R_ES: Rotation
    p_ES: np.ndarray
    R_EI: Rotation
    p_EI: np.ndarray
    wrench_delay: float
    imu_delay: float
    drawn_R_ES: Rotation
    drawn_R_EI: Rotation
    drawn_p_ES: np.ndarray
    drawn_p_EI: np.ndarray
    cable: np.ndarray  # stiffness along x, y, z of W, N/m, and about them, N m/rad, (6,)
    play: tuple  # half the width of hysteresis, N and N m


def draw_truth(random, cables):
    """One set-up. The drawing is right to 1 mm for the sensor, 5 mm for the inertial unit and 3 degrees for both."""
    mass = random.uniform(0.5, 6)
    center = np.array([*random.uniform(-0.03, 0.03, 2), random.uniform(0.02, 0.15)])
    radii = random.uniform(0.03, 0.08, 3)  # of three boxes of mass about the centre
    axes = Rotation.random(random_state=random).as_matrix()
    squares = radii**2
    about_center = mass / 2 * axes @ np.diag(squares.sum() - squares) @ axes.T
    inertia = about_center + mass * (center @ center * np.eye(3) - np.outer(center, center))
    drawn = [Rotation.from_euler("z", 90 * random.integers(4), degrees=True),
             Rotation.from_euler("xz", 90 * random.integers(0, 4, 2), degrees=True)]  # fmt: skip
    off = [Rotation.from_rotvec(np.radians(random.normal(0, 3 / 1.7, 3))) for _ in drawn]
    p_ES, p_EI = np.array([0, 0, 0.04]), np.array([0, 0.055, 0.1])
    drift = random.normal(0, [0.1] * 3 + [0.005] * 3)
    return Truth(
        mass, center, inertia, np.concatenate([random.normal(0, 3, 3), random.normal(0, 0.1, 3)]), drift, drawn[0] * off[0],
        p_ES + random.normal(0, 1e-3 / 1.7, 3), drawn[1] * off[1], p_EI + random.normal(0, 5e-3 / 1.7, 3),
        random.uniform(-0.01, 0.03), random.uniform(-0.01, 0.03), drawn[0], drawn[1], p_ES, p_EI,
        np.concatenate([random.uniform(0, 5, 3), random.uniform(0, 0.3, 3)]) * cables, (0.05 * cables, 0.002 * cables))


def draw_motion(random, poses=12):
    """Rotations and positions of the flange, (t) -> values, that visit poses at up to 0.5 rad/s, with a small quick
    oscillation (0.04 rad, about 0.7 Hz) on top, as the gate of rt/config/examples allows."""
    turns = [Rotation.from_euler("yxz", random.uniform([-1.2, -1.2, -1.5], [1.2, 1.2, 1.5])) for _ in range(poses)]
    base = Rotation.from_euler("y", np.pi / 2)
    points = np.array([0.6, 0, 0.5]) + random.uniform(-0.12, 0.12, (poses, 3))
    times, rotations, places = [0.0], [base * turns[0]], [points[0]]
    for i in range(1, poses):
        angle = (turns[i - 1].inv() * turns[i]).magnitude()
        move = max(1.9 * angle / 0.5, 1.9 * np.linalg.norm(points[i] - points[i - 1]) / 0.08)
        for share in np.linspace(0.1, 1, 10):
            smooth = 10 * share**3 - 15 * share**4 + 6 * share**5
            between = Rotation.from_rotvec(smooth * (turns[i - 1].inv() * turns[i]).as_rotvec())
            rotations.append(base * turns[i - 1] * between)
            places.append(points[i - 1] + smooth * (points[i] - points[i - 1]))
        times += list(times[-1] + move * np.linspace(0.1, 1, 10))
        times.append(times[-1] + 0.8)
        rotations.append(rotations[-1])
        places.append(places[-1])
    phases, speeds = random.uniform(0, 2 * np.pi, 3), random.uniform(0.55, 0.85, 3)
    grid = np.arange(0, times[-1], DT)
    rough = RotationSpline(times, Rotation.concatenate(rotations))(grid)
    wave = Rotation.from_rotvec(0.04 * np.sin(2 * np.pi * speeds * grid[:, None] + phases))
    return grid, rough * wave, CubicSpline(times, places)(grid)


def derivative(values):
    return np.gradient(values, DT, axis=0, edge_order=2)


def with_play(values, half):
    """Hysteresis: the reading follows only once the true value has turned back by 2 * half."""
    if half == 0:
        return values
    out = values.copy()
    for i in range(1, len(values)):
        out[i] = np.clip(out[i - 1], values[i] - half, values[i] + half)
    return out


def true_signals(truth, motion):
    """Wrench in S, specific force and rate in I at the grid's times."""
    _, R_WE, p_WE = motion
    R_WS, R_WI = R_WE * truth.R_ES, R_WE * truth.R_EI
    center = p_WE + R_WE.apply(truth.p_ES) + R_WS.apply(truth.center)
    # Body rate from the derivative of the rotation matrix.
    m = R_WS.as_matrix()
    skew = np.einsum("nji,njk->nik", m, derivative(m.reshape(-1, 9)).reshape(-1, 3, 3))
    rate_S = np.stack([skew[:, 2, 1], skew[:, 0, 2], skew[:, 1, 0]], axis=1)
    c = truth.center
    about_center = truth.inertia - truth.mass * (c @ c * np.eye(3) - np.outer(c, c))
    spin_W = R_WS.apply(rate_S @ about_center)
    force_W = truth.mass * (derivative(derivative(center)) - GRAVITY)
    lever_W = R_WS.apply(np.broadcast_to(c, center.shape))
    torque_W = derivative(spin_W) + np.cross(lever_W, force_W)
    sensor = p_WE + R_WE.apply(truth.p_ES)
    force_W = force_W + truth.cable[:3] * (sensor - sensor[0])
    torque_W = torque_W + truth.cable[3:] * (R_WS * R_WS[0].inv()).as_rotvec()
    force, torque = R_WS.inv().apply(force_W), R_WS.inv().apply(torque_W)
    unit = p_WE + R_WE.apply(truth.p_EI)
    specific = R_WI.inv().apply(derivative(derivative(unit)) - GRAVITY)
    rate_I = (truth.R_EI.inv() * truth.R_ES).apply(rate_S)
    return with_play(force, truth.play[0]), with_play(torque, truth.play[1]), specific, rate_I


def measured(random, values, kind):
    noise, step = NOISE[kind]
    return step * np.round((values + random.normal(0, noise, values.shape)) / step)


def record(random, truth, motion):
    """(time, pose (n, 12)), (time, wrench (n, 6)), (time, acceleration, rate); the times are those that are reported."""
    grid, R_WE, p_WE = motion
    force, torque, specific, rate = true_signals(truth, motion)

    def rows(name, delay):
        """Indices of the grid at which a sensor samples."""
        times = np.arange(LEAD + random.uniform(0, 0.01), grid[-1] - LEAD, 1 / RATE[name])
        at = np.round(times / DT).astype(int)
        return at, grid[at] + delay

    at, pose_time = rows("pose", 0.0)
    reported = R_WE[at] * Rotation.from_rotvec(random.normal(0, POSE_NOISE, (len(at), 3)))
    pose = np.hstack([p_WE[at] + random.normal(0, POSE_NOISE, (len(at), 3)), reported.as_matrix().reshape(-1, 9)])
    at, wrench_time = rows("wrench", truth.wrench_delay)
    bias = truth.bias + (grid[at, None] / grid[-1] - 0.5) * truth.drift
    wrench = np.hstack([measured(random, force[at] + bias[:, :3], "force"),
                        measured(random, torque[at] + bias[:, 3:], "torque")])  # fmt: skip
    at, imu_time = rows("imu", truth.imu_delay)
    offset = random.normal(0, 0.05, 3)
    return ((pose_time, pose), (wrench_time, wrench),
            (imu_time, measured(random, specific[at] + offset, "acceleration"),
             measured(random, rate[at], "rate")))  # fmt: skip
