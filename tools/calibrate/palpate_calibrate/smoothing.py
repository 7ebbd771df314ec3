"""Low-pass filtering of irregularly sampled streams with one kernel, so that no stream lags another."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline

from palpate_calibrate.recording import Stream
from palpate_common.input_error import InputError
from palpate_common.rotations import Array

REACH = 4.0  # of the kernel, standard deviations


def smooth(stream: Stream, at: Array, deviation: float) -> Array:
    """Values at the times `at`: local linear regression with Gaussian weights of this deviation (s), which for
    even samples is a convolution. Raises InputError where fewer than three samples are near."""
    begin = np.searchsorted(stream.time, at - REACH * deviation)
    end = np.searchsorted(stream.time, at + REACH * deviation)
    out = np.empty((len(at), stream.values.shape[1]))
    for i, (t, a, b) in enumerate(zip(at, begin, end)):
        if b - a < 3:
            raise InputError(f"{stream.name}: no samples within {REACH * deviation:.3g} s of {t:.3f} s; a gap in the "
                             "recording, or a rate below that allowed (20 Hz)")  # fmt: skip
        offset = stream.time[a:b] - t
        weight = np.exp(-0.5 * (offset / deviation) ** 2)
        s0, s1, s2 = weight.sum(), weight @ offset, weight @ offset**2
        spread = s0 * s2 - s1 * s1
        if spread < 1e-12 * s0 * s0 * deviation**2:
            raise InputError(f"{stream.name}: all samples near {t:.3f} s have one time")
        out[i] = (weight * (s2 - s1 * offset) / spread) @ stream.values[a:b]
    return out


def spline(time: Array, values: Array) -> CubicSpline:
    return CubicSpline(time, values, axis=0)
