"""Obstacles as geoms of MuJoCo, with stiff contact.

MuJoCo's contact is a spring with damping, scaled by the mass that it acts on. Its time constant is
two steps, the least that MuJoCo takes, and its impedance, which sets the depth at rest, close to 1.
"""

from __future__ import annotations

from typing import Any, Sequence

import numpy as np
from obstacles import Capsule, Cuboid, Cylinder, HalfSpace, Obstacle, Sphere

RADIUS = 1e-5  # m, by which MuJoCo thickens the object's surface
FACETS = 4  # of the surface that touches, along a side of a cell
_IMPEDANCE = 0.9999
_HALF_INFINITE = 5.0  # m, of a cylinder without length
# Friction is held this much more stiffly than penetration, in an elliptic cone.
OPTIONS = 'cone="elliptic" impratio="10"'


def geoms(obstacles: Sequence[Obstacle], period: float) -> str:
    """MJCF for the world's body, whose frame is O; `period`: s, of a step."""
    return "\n    ".join(_geom(each, period) for each in obstacles)


def _geom(obstacle: Obstacle, period: float) -> str:
    kind, size = _kind_and_size(obstacle)
    w, x, y, z = obstacle.pose.quaternion()
    return (
        f'<geom type="{kind}" size="{words(size)}" '
        f'pos="{words(obstacle.pose.position)}" quat="{w:.12g} {x:.12g} {y:.12g} {z:.12g}" '
        f'friction="{obstacle.friction:.12g} 0 0" condim="3" priority="1" margin="0" '
        f'solref="{2 * period:g} 1" solimp="{_IMPEDANCE} {_IMPEDANCE} 0.001"/>'
    )


def _kind_and_size(obstacle: Obstacle) -> tuple[str, list[float]]:
    shape = obstacle.shape
    if isinstance(shape, HalfSpace):
        return "plane", [0, 0, 1]  # infinite
    if isinstance(shape, Cuboid):
        return "box", [float(side) / 2 for side in shape.size]
    if isinstance(shape, Sphere):
        return "sphere", [shape.radius]
    if isinstance(shape, Capsule):
        return "capsule", [shape.radius, shape.length / 2]
    assert isinstance(shape, Cylinder)
    half = _HALF_INFINITE if shape.length is None else shape.length / 2
    return "cylinder", [shape.radius, half]


def words(values: Any) -> str:
    """Numbers as MJCF wants them."""
    return " ".join(f"{value:.12g}" for value in np.ravel(values))
