"""Estimation of a wrist's parameters: generalised least squares, iterated with the covariance of the residuals."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial

import numpy as np

from palpate_calibrate.freedom import degrees_of_freedom
from palpate_calibrate.motion import LARGEST_DELAY, Motion, MotionSample
from palpate_calibrate.noise_model import Deviations, Group, Information, Kernels
from palpate_calibrate.parameters import BLOCKS, Block, WristParameters, point_inertia
from palpate_calibrate.recording import Mounting, Recording
from palpate_calibrate.start import start_values
from palpate_calibrate.wrist_model import load_wrench, predict
from palpate_common.input_error import InputError
from palpate_common.rotations import Array

SMALLEST_STEP = 0.02  # standard deviations; the iteration ends below it
MOST_STEPS = 12
ROUNDS = 3  # of the covariance and the weights
FEWEST_POSES = 4
# Prior deviation of the inertia about that of a point mass at the centre: mass times the square of this radius.
GYRATION = 0.3  # m


@dataclass(frozen=True)
class Options:
    drift: str = "linear"  # of the biases: "none", "linear" or "walk"
    pose_errors: bool = True  # whether residuals may depend on the pose, as with cables
    gravity_tilt: bool = False  # whether gravity's direction in W is unknown
    # "generalised" weighs by the covariance of the residuals, "ordinary" each sample alike, with intervals that allow
    # for that covariance; "auto": ordinary for poses at rest.
    weights: str = "auto"
    most_samples: int = 100  # of a recording in motion


@dataclass
class WristFit:
    """Result. Increments, and hence covariance and prior, are ordered as `blocks`."""

    parameters: WristParameters
    blocks: list[Block]
    covariance: Array
    prior: Array  # standard deviations before the recording
    polarity: int
    motion: Motion
    measured: dict[str, Array]  # signals at the grid's times, multiplied by the polarity, (n, 3) each
    residuals: dict[str, Array]  # measured minus model, (n, 3) each
    deviations: dict[str, Deviations]
    outliers: int  # samples with reduced weight
    freedom: Array  # of the variance of each increment, for Student's distribution
    options: Options
    recording: Recording
    iterations: int = 0
    rows: dict[str, slice] = field(default_factory=dict)  # of each block

    def __post_init__(self) -> None:
        first = 0
        for block in self.blocks:
            self.rows[block.name] = slice(first, first + block.size)
            first += block.size

    def rms(self, group: str) -> Array:
        """Root mean square of the residuals per axis, (3,)."""
        return np.asarray(np.sqrt((self.residuals[group] ** 2).mean(axis=0)))


def _signals(recording: Recording, motion: Motion) -> dict[str, Array]:
    wrench = motion.signal(recording.wrench)
    signals = {"force": wrench[:, :3], "torque": wrench[:, 3:]}
    for name, stream in (("acceleration", recording.acceleration), ("angular_velocity", recording.angular_velocity)):
        if stream is not None:
            signals[name] = motion.signal(stream)
    return signals


def _blocks(signals: dict[str, Array], motion: Motion, options: Options, mounting: Mounting) -> list[Block]:
    left_out = set()
    if options.drift != "linear":
        left_out |= {"force_drift", "torque_drift"}
    if mounting.sensor_rotation_is_exact:
        left_out |= {"sensor_rotation"}
    if motion.at_rest:
        left_out |= {"force_hysteresis", "torque_hysteresis"}
    if motion.at_rest or not options.pose_errors:
        left_out |= {"cable_stiffness", "cable_torsion"}
    if not options.gravity_tilt:
        left_out |= {"gravity_tilt"}
    if "acceleration" not in signals:
        left_out |= {"acceleration_bias", "imu_position"}
    if "angular_velocity" not in signals or motion.at_rest:
        left_out |= {"rate_bias"}
    if not {"acceleration", "angular_velocity"} & set(signals):
        left_out |= {"imu_rotation", "imu_delay"}
    return [block for block in BLOCKS if block.name not in left_out]


def _prior(blocks: list[Block], mounting: Mounting, start: WristParameters) -> Array:
    of = {"sensor_position": mounting.sensor_position_deviation, "imu_position": mounting.imu_position_deviation,
          "inertia": max(start.mass, 0.1) * GYRATION**2}  # fmt: skip
    return np.concatenate([np.full(block.size, of.get(block.name, block.deviation)) for block in blocks])


class _Problem:
    """Residuals and derivatives of one recording."""

    def __init__(self, motion: Motion, signals: dict[str, Array], gravity: Array, blocks: list[Block],
                 start: WristParameters, prior: Array) -> None:  # fmt: skip
        self.motion, self.signals, self.gravity, self.blocks = motion, signals, gravity, blocks
        self.start, self.prior = start, prior

    def residuals(self, parameters: WristParameters) -> dict[str, Array]:
        predicted = predict(parameters, self.motion, self.gravity, list(self.signals))
        return {name: self.signals[name] - predicted[name] for name in self.signals}

    def derivatives(self, parameters: WristParameters) -> dict[str, Array]:
        """Of the predictions, (n, 3, parameters), by central differences."""
        count = sum(block.size for block in self.blocks)
        out = {name: np.zeros(values.shape + (count,)) for name, values in self.signals.items()}
        owners = [block for block in self.blocks for _ in range(block.size)]
        for k, block in enumerate(owners):
            step = np.zeros(count)
            step[k] = 1e-4 * min(self.prior[k], 1.0)
            groups = [name for name in self.signals if block.concerns(name)]
            plus = predict(parameters.plus(self.blocks, step), self.motion, self.gravity, groups)
            minus = predict(parameters.plus(self.blocks, -step), self.motion, self.gravity, groups)
            for name in groups:
                out[name][:, :, k] = (plus[name] - minus[name]) / (2 * step[k])
        return out

    def prior_information(self, parameters: WristParameters) -> Information:
        """About the current values; the prior of positions is about the drawing, of the inertia about a point mass,
        of rotations about the values of the start."""
        vector, first = np.zeros(len(self.prior)), 0
        center = {"sensor_position": self.start.sensor_position, "imu_position": self.start.imu_position,
                  "inertia": point_inertia(parameters.mass, parameters.moment)}  # fmt: skip
        for block in self.blocks:
            rows = slice(first, first + block.size)
            first += block.size
            if block.name in center:
                vector[rows] = (center[block.name] - getattr(parameters, block.name)) / self.prior[rows] ** 2
        return Information(np.diag(1 / self.prior**2), vector)


def _sum(parts: list[Information]) -> Information:
    return Information(sum((p.matrix for p in parts[1:]), parts[0].matrix),
                       sum((p.vector for p in parts[1:]), parts[0].vector))  # fmt: skip


def _solve(prior: Information, groups: list[Group], ordinary: bool) -> tuple[Array, Array]:
    """Increment and covariance."""
    if ordinary:
        parts = [group.plain_information() for group in groups]
        total = _sum([prior] + [information for information, _ in parts])
    else:
        total = _sum([prior] + [group.information() for group in groups])
    scale = 1 / np.sqrt(np.diag(total.matrix))
    inverse = np.linalg.inv(total.matrix * np.outer(scale, scale)) * np.outer(scale, scale)
    covariance = inverse
    if ordinary:
        covariance = inverse @ (prior.matrix + sum(spread for _, spread in parts)) @ inverse
    return inverse @ total.vector, covariance


def _load(parameters: WristParameters, gravity: Array, sample: MotionSample) -> Array:
    return np.hstack(load_wrench(parameters, sample, gravity))


def fit_wrist(recording: Recording, mounting: Mounting, options: Options = Options()) -> WristFit:
    """Raises InputError where the recording is too short or holds too few poses."""
    if recording.at_rest and len(recording.pose.time) < FEWEST_POSES:
        raise InputError(f"{recording.name}: {len(recording.pose.time)} poses; allowed: {FEWEST_POSES} or more")
    motion = Motion(recording, options.most_samples)
    signals = _signals(recording, motion)
    if recording.at_rest:
        signals.pop("angular_velocity", None)
    start, polarity = start_values(motion, signals, recording.gravity, mounting, options.gravity_tilt)
    signals["force"], signals["torque"] = polarity * signals["force"], polarity * signals["torque"]
    motion.directions *= polarity
    blocks = _blocks(signals, motion, options, mounting)
    problem = _Problem(motion, signals, recording.gravity, blocks, start, _prior(blocks, mounting, start))
    parameters = start

    parts = 3 if options.pose_errors else 2 if options.drift == "walk" else 1
    ordinary = options.weights == "ordinary" or (options.weights == "auto" and recording.at_rest)
    groups = {}
    for name, residuals in problem.residuals(parameters).items():
        size = max(1.4826 * float(np.median(np.abs(residuals))), 1e-9)
        kernels = Kernels(motion, motion.rotation_WE @ (start.R_ES if name in ("force", "torque") else start.R_EI))
        groups[name] = Group(kernels, Deviations(size, 0, 0, kernels.shortest), parts)
    steps = 0
    for turn in range(ROUNDS + 1):
        if turn > 0:
            motion.update_directions(partial(_load, parameters, recording.gravity), parameters.wrench_delay, polarity,
                                     np.concatenate([parameters.force_hysteresis, parameters.torque_hysteresis]))  # fmt: skip
        for _ in range(MOST_STEPS):
            steps += 1
            residuals, derivatives = problem.residuals(parameters), problem.derivatives(parameters)
            for name, group in groups.items():
                group.set_residuals(residuals[name], derivatives[name])
            increment, covariance = _solve(problem.prior_information(parameters), list(groups.values()), ordinary)
            parameters = parameters.plus(blocks, increment)
            if np.max(np.abs(increment) / np.sqrt(np.diag(covariance))) < SMALLEST_STEP:
                break
        residuals = problem.residuals(parameters)
        for name, group in groups.items():
            group.set_residuals(residuals[name], derivatives[name])
        if turn == ROUNDS:
            break
        prior = problem.prior_information(parameters)
        for name, group in groups.items():
            if turn == 0:
                size = max(float(np.sqrt((residuals[name] ** 2).mean())), 1e-9)
                group.deviations = Deviations(size, size / 2 * (parts > 1), size / 2 * (parts > 2),
                                              4 * group.kernels.shortest)
            group.estimate(_sum([prior] + [g.information() for other, g in groups.items() if other != name]))
            if turn > 0:
                group.update_weights()
    for name, delay in (("wrench", parameters.wrench_delay), ("imu", parameters.imu_delay)):
        if not motion.at_rest and abs(delay) > LARGEST_DELAY:
            raise InputError(f"{recording.name}: the delay of {name} is {delay:.3f} s; allowed: {-LARGEST_DELAY} to "
                             f"{LARGEST_DELAY} s; are the clocks of the streams the same?")  # fmt: skip
    outliers = int(sum((group.weights < 0.5).sum() for group in groups.values()))
    most = max(3.0 * len(motion.time) * len(groups) - len(problem.prior), 3.0)
    freedom = np.full(len(problem.prior), most)
    if not ordinary:
        freedom = degrees_of_freedom(list(groups.values()), problem.prior_information(parameters), most)
    return WristFit(parameters, blocks, covariance, problem.prior, polarity, motion, signals, residuals,
                    {name: group.deviations for name, group in groups.items()}, outliers, freedom, options, recording,
                    steps)  # fmt: skip
