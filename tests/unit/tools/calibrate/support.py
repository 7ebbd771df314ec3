"""Puts the modules of palpate-calibrate and of its studies on the path, and makes recordings for tests."""

import os
import pathlib
import sys

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
SOURCE = pathlib.Path(os.environ["PALPATE_SOURCE_DIR"])
sys.path[:0] = [str(SOURCE / "tools" / folder) for folder in ("calibrate", "common", "lab/wrist_calibration", "lab/camera_calibration")]

import numpy as np  # noqa: E402

from palpate_calibrate.recording import Recording, Stream  # noqa: E402
from palpate_common.rotations import exp_rotation  # noqa: E402

GRAVITY = np.array([0, 0, -9.81])


def random_rotations(random, count, axis=None):
    """Up to 100 degrees about random axes, or about one."""
    out = []
    for angle in random.uniform(-1.75, 1.75, count):
        about = random.normal(size=3) if axis is None else np.asarray(axis, float)
        out.append(exp_rotation(angle * about / np.linalg.norm(about)))
    return np.array(out)


def at_rest(rotations, mass, center, R_ES, bias, noise=(0.02, 1e-3), polarity=1, random=None):
    """Readings of a load at rest, written out for each pose: weight in the sensor's frame and its moment."""
    random = random or np.random.default_rng(5)
    rows = []
    for R_WE in rotations:
        upwards = -mass * (R_WE @ R_ES).T @ GRAVITY
        wrench = np.concatenate([upwards, np.cross(center, upwards)]) + bias
        rows.append(polarity * wrench + random.normal(0, [noise[0]] * 3 + [noise[1]] * 3))
    n = len(rotations)
    pose = np.hstack([np.zeros((n, 3)), np.reshape(rotations, (n, 9))])
    return Recording("poses", Stream("pose", np.arange(n), pose), Stream("wrench", np.arange(n), np.array(rows)), at_rest=True)
