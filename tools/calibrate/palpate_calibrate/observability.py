"""What a recording does not determine, and which motion would."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate_calibrate.fit import WristFit
from palpate_calibrate.quantities import FROM_DRAWING, is_determined
from palpate_common.rotations import Array

SHARE = 0.5  # of the largest component of a weak direction, above which a parameter is named with it

_ADVICE = {
    "mass": "turn the hand by 60 degrees or more about two horizontal axes",
    "moment": "turn the hand by 60 degrees or more about two horizontal axes",
    "inertia": "record while moving, with quick turns to and fro about each axis of the sensor (1 rad/s^2 or more)",
    "force_bias": "turn the hand upside down, so that weight and bias separate",
    "torque_bias": "turn the hand upside down, so that weight and bias separate",
    "force_drift": "return to the first pose at the end",
    "torque_drift": "return to the first pose at the end",
    "force_hysteresis": "record while moving, with turns to and fro of 0.2 rad/s or more",
    "torque_hysteresis": "record while moving, with turns to and fro of 0.2 rad/s or more",
    "cable_stiffness": "move the flange by 0.2 m or more, along the vertical, too",
    "cable_torsion": "turn the hand about the vertical, too",
    "sensor_rotation": "turn the hand about two axes at an angle to each other; about one axis does not suffice",
    "gravity_tilt": "turn the hand about two axes at an angle to each other",
    "wrench_delay": "record while moving, with turns to and fro of 0.2 rad/s or more",
    "imu_rotation": "turn the hand about two axes at an angle to each other",
    "acceleration_bias": "turn the hand by 60 degrees or more about two horizontal axes",
    "rate_bias": "record for 10 s or more",
    "imu_delay": "record while moving, with turns to and fro of 0.2 rad/s or more",
}


@dataclass(frozen=True)
class Weakness:
    """Parameters that the recording does not determine, alone or as a sum of which only other sums are known."""

    parameters: tuple[str, ...]
    advice: str


def _labels(fit: WristFit) -> list[tuple[str, str]]:
    return [(block.name, label.replace("moment", "center_of_mass")) for block in fit.blocks for label in block.labels]


def information_ratio(fit: WristFit) -> tuple[Array, Array]:
    """Eigenvalues of the covariance in units of the prior's (0: fully determined, 1: nothing learnt) and eigenvectors."""
    scaled = fit.covariance / np.outer(fit.prior, fit.prior)
    values, vectors = np.linalg.eigh(scaled)
    return values, vectors


def weaknesses(fit: WristFit) -> list[Weakness]:
    """Directions of the parameters in which the recording taught little, the weakest first."""
    labels = _labels(fit)
    known = np.concatenate([is_determined(fit, block.name) | (block.name in FROM_DRAWING) for block in fit.blocks])
    values, vectors = information_ratio(fit)
    found: list[Weakness] = []
    named: set[int] = set()
    for k in np.argsort(-values):
        direction = np.abs(vectors[:, k])
        members = [int(i) for i in np.flatnonzero((direction > SHARE * direction.max()) & ~known) if i not in named]
        if not members:
            continue
        named.update(members)
        groups = {labels[i][0] for i in members}
        advice = [_ADVICE[block.name] for block in fit.blocks if block.name in groups]
        found.append(Weakness(tuple(labels[i][1] for i in sorted(members)), "; ".join(dict.fromkeys(advice))))
    left = [i for i in np.flatnonzero(~known) if i not in named]
    found += [Weakness((labels[i][1],), _ADVICE[labels[i][0]]) for i in left]
    by_advice: dict[str, list[str]] = {}
    for weakness in found:
        by_advice.setdefault(weakness.advice, []).extend(weakness.parameters)
    return [Weakness(tuple(names), advice) for advice, names in by_advice.items()]
