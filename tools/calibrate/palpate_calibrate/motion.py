"""Motion of the flange, as experienced by what it carries."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Callable

import numpy as np
from scipy.ndimage import gaussian_filter1d

from palpate_calibrate.recording import Recording, Stream
from palpate_calibrate.smoothing import REACH, smooth, spline
from palpate_common.input_error import InputError
from palpate_common.rotations import Array, cross, log_rotation, to_wxyz

FIRST_DEVIATION = 0.02  # s, of the kernel that is applied to the poses before they are differentiated
DEVIATION = 0.06  # s, of the kernel that is applied to every signal: 3 dB at 2.2 Hz
LARGEST_DELAY = 0.15  # s, of a stream relative to the pose, of either sign
STEP = 0.02  # s, of the table of motions
SHORTEST = 3.0  # s
REST_DEVIATION = 0.3  # s, of the kernel that is applied to what the load does not explain
LEAST_LAG = 1e-5  # smallest amplitude of hysteresis, as a share of a reading's range
SLOW = 0.05  # rate of a reading, as a share of its root mean square, below which its direction is unclear


@dataclass
class MotionSample:
    """At n times, all in E: the acceleration of its origin, and the rotations that carry gravity into it."""

    acceleration: Array  # (n, 3), m/s^2
    angular_velocity: Array  # (n, 3), rad/s
    angular_acceleration: Array  # (n, 3), rad/s^2
    rate_products: Array  # angular_velocity times itself transposed, averaged as the signals are, (n, 3, 3)
    rotation_EW: Array  # (n, 3, 3), low-passed as the signals are, hence not exactly orthonormal

    def specific_force(self, gravity_W: Array) -> Array:
        """a - g at the origin of E, in E, (n, 3)."""
        return self.acceleration - self.rotation_EW @ gravity_W


class Motion:
    """At rest the samples are the recorded poses. In motion at(delay) gives those at the grid's times minus the delay:
    a stream with this delay stamps at time t what happened at t - delay, by the clock of the poses."""

    def __init__(self, recording: Recording, most_samples: int = 100) -> None:
        self.at_rest = recording.at_rest
        rotations = recording.pose.values[:, 3:].reshape(-1, 3, 3)
        if self.at_rest:
            self.time = recording.pose.time
            self.position, self.rotation_WE = recording.pose.values[:, :3], rotations
            zero = np.zeros_like(self.position)
            self.travel = self.turn = zero
            self.directions = np.zeros((len(self.time), 6))
            self._still = MotionSample(zero, zero, zero, np.zeros_like(rotations), np.swapaxes(rotations, 1, 2))
            return
        streams = [recording.pose, recording.wrench]
        streams += [s for s in (recording.acceleration, recording.angular_velocity) if s is not None]
        margin = REACH * (DEVIATION + FIRST_DEVIATION) + LARGEST_DELAY
        begin = max(s.time[0] for s in streams) + margin
        end = min(s.time[-1] for s in streams) - margin
        if end - begin < SHORTEST:
            raise InputError(f"{recording.name}: {max(0.0, end - begin):.1f} s in which all of "
                             f"{', '.join(s.name for s in streams)} arrive; allowed: {SHORTEST:g} s or more")  # fmt: skip
        self.time = np.linspace(begin, end, min(most_samples, int((end - begin) / (1.5 * DEVIATION)) + 1))
        self._table(recording.pose, rotations, begin - LARGEST_DELAY, end + LARGEST_DELAY)
        self.position = self._positions(self.time)
        self.rotation_WE = np.swapaxes(self.at(0.0).rotation_EW, 1, 2)
        # From the first pose, in W: translation and rotation vector, m and rad.
        self.travel = self.position - self.position[0]
        self.turn = np.array([log_rotation(R @ self.rotation_WE[0].T) for R in self.rotation_WE])
        self._fine = np.arange(self.time[0] - REACH * DEVIATION, self.time[-1] + REACH * DEVIATION, STEP)
        self._wrench = smooth(recording.wrench, self._fine, FIRST_DEVIATION)
        self._lag = np.zeros_like(self._wrench)  # N and N m, by the latest estimate
        # Of each axis of the wrench: by how much of the hysteresis' amplitude the reading lags, -1 to 1, averaged as the
        # signals are. Until the load is known: 1 where the reading rises, -1 where it falls.
        rate = np.gradient(self._wrench, STEP, axis=0)
        unclear = SLOW * np.maximum(np.sqrt((rate**2).mean(axis=0)), 1e-12)
        self.directions = self._averaged(np.tanh(rate / unclear))

    def _table(self, pose: Stream, rotations: Array, begin: float, end: float) -> None:
        """Splines of what at() returns, from poses smoothed once before and once after differentiation."""
        margin = REACH * DEVIATION
        fine = np.arange(begin - margin, end + margin, STEP)
        quaternions = to_wxyz(rotations)
        signs = np.sign((quaternions[1:] * quaternions[:-1]).sum(axis=1))
        quaternions[1:] *= np.cumprod(np.where(signs == 0, 1, signs))[:, None]
        both = Stream(pose.name, pose.time, np.hstack([pose.values, quaternions]))
        smoothed = smooth(both, fine, FIRST_DEVIATION)
        q = smoothed[:, 12:] / np.linalg.norm(smoothed[:, 12:], axis=1, keepdims=True)
        position, quaternion = spline(fine, smoothed[:, :3]), spline(fine, q)
        rate = quaternion(fine, 1)
        w, v = q[:, :1], q[:, 1:]
        # Body rate of q: 2 conj(q) q', vector part.
        omega = 2 * (w * rate[:, 1:] - rate[:, :1] * v - cross(v, rate[:, 1:]))
        alpha = spline(fine, omega)(fine, 1)
        # Averaged as the readings are; normalised they would show more gravity than an averaged reading does.
        rotation_EW = np.swapaxes(smoothed[:, 3:12].reshape(-1, 3, 3), 1, 2)
        acceleration = np.einsum("nij,nj->ni", rotation_EW, position(fine, 2))
        products = omega[:, :, None] * omega[:, None, :]
        table = np.hstack([acceleration, omega, alpha, products.reshape(-1, 9), rotation_EW.reshape(-1, 9)])
        second = np.sqrt(DEVIATION**2 - FIRST_DEVIATION**2)
        self._motions = spline(fine, gaussian_filter1d(table, second / STEP, axis=0, truncate=REACH))
        self._positions = position

    def _averaged(self, fine: Array) -> Array:
        averaged = gaussian_filter1d(fine, DEVIATION / STEP, axis=0, truncate=REACH)
        return np.asarray(spline(self._fine, averaged)(self.time))

    def update_directions(self, load: Callable[[MotionSample], Array], delay: float, polarity: int, amplitude: Array) -> None:
        """`load`: wrench of the load in a motion, (n, 6). A reading follows the wrench only once that has turned back by
        twice the amplitude, (6,) (play, Krasnosel'skii and Pokrovskii 1989). What the load does not explain is taken from
        the readings, but for its quick part, in which they lag."""
        if self.at_rest:
            return
        explained = load(self._at(self._fine, delay))
        rest = gaussian_filter1d(polarity * self._wrench + self._lag - explained, REST_DEVIATION / STEP, axis=0)
        wrench = explained + rest
        half = np.maximum(np.abs(amplitude), LEAST_LAG * np.ptp(wrench, axis=0) + 1e-12)
        reading = wrench.copy()
        for i in range(1, len(wrench)):
            reading[i] = np.clip(reading[i - 1], wrench[i] - half, wrench[i] + half)
        self._lag = wrench - reading
        self.directions = self._averaged(self._lag / half)

    def at(self, delay: float) -> MotionSample:
        return self._still if self.at_rest else self._at(self.time, delay)

    def _at(self, time: Array, delay: float) -> MotionSample:
        table = self._motions(time - delay)
        products, rotation_EW = (table[:, k : k + 9].reshape(-1, 3, 3) for k in (9, 18))
        return MotionSample(table[:, :3], table[:, 3:6], table[:, 6:9], products, rotation_EW)

    def signal(self, stream: Stream) -> Array:
        """Values of a stream at the grid's times, (n, channels)."""
        return stream.values if self.at_rest else smooth(stream, self.time, DEVIATION)
