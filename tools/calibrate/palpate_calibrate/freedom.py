"""Degrees of freedom of the estimated standard deviations (Satterthwaite 1946, as in Kenward and Roger 1997).

The covariance of the residuals is estimated, too: where a part of which a recording holds few independent values, such as the
errors by pose, determines a parameter's deviation, this is uncertain, and the interval is that of Student's distribution.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from palpate_calibrate.noise_model import Group, Information
from palpate_common.rotations import Array

STEP = 0.05  # of the logarithm of a deviation
# Standard deviation of the logarithm of a deviation before the recording: of which nothing is learnt from it.
UNKNOWN = 1.0
FEWEST = 3.0


def degrees_of_freedom(groups: list[Group], prior: Information, most: float) -> Array:
    """Of each parameter's variance, FEWEST to `most`. The groups hold residuals and derivatives at the estimate."""
    informations = [group.information() for group in groups]
    total = prior.matrix + sum(information.matrix for information in informations)
    variance = _variances(total)
    spread = np.zeros(len(variance))
    for k, group in enumerate(groups):
        others = Information(total - informations[k].matrix,
                             prior.vector + sum(i.vector for j, i in enumerate(informations) if j != k))  # fmt: skip
        d = group.deviations
        middle = group.likelihood(others, d)
        for name in ("white", "slow", "pose", "reach")[: (1, 2, 4)[group.parts - 1]]:
            low, high = (replace(d, **{name: getattr(d, name) * np.exp(sign * STEP)}) for sign in (-1, 1))
            curvature = (group.likelihood(others, high) - 2 * middle + group.likelihood(others, low)) / STEP**2
            uncertainty = 1 / (max(curvature, 0) / 2 + 1 / UNKNOWN**2)
            change = (_variances(others.matrix + group.information(high).matrix)
                      - _variances(others.matrix + group.information(low).matrix)) / (2 * STEP)  # fmt: skip
            spread += change**2 * uncertainty
    return np.clip(2 * variance**2 / np.maximum(spread, 1e-300), FEWEST, most)


def _variances(matrix: Array) -> Array:
    scale = 1 / np.sqrt(np.diag(matrix))
    return np.asarray(np.diag(np.linalg.inv(matrix * np.outer(scale, scale))) * scale**2)
