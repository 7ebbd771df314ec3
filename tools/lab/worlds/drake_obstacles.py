"""Obstacles as geometry of Drake's world, for contact with its deformable body.

Drake tests the object's tetrahedra against a surface of triangles, which only geometry with rigid
hydroelastic properties has, and a half space never. A contact is near-rigid: no stiffness is set.
"""

from __future__ import annotations

from typing import Any, Sequence

import pydrake.geometry as geometry
from obstacles import Capsule, Cuboid, Cylinder, HalfSpace, Obstacle, Sphere
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import CoulombFriction

_EDGE = 0.12  # of the radius, edges of the triangles: flat by 0.2 % of the radius at most
_LARGE = 2.0  # m, edge lengths of the box in place of a half space; length of an infinite cylinder


def object_properties(obstacles: Sequence[Obstacle]) -> Any:
    """Of the deformable body."""
    properties = geometry.ProximityProperties()
    _add_friction(properties, _object_friction(obstacles))
    return properties


def add_obstacles(plant: Any, obstacles: Sequence[Obstacle]) -> None:
    """To the world body, whose frame is O, before the plant is finalised."""
    of_object = _object_friction(obstacles)
    for obstacle in obstacles:
        shape, offset, edge = _shape(obstacle)
        properties = geometry.ProximityProperties()
        geometry.AddRigidHydroelasticProperties(edge, properties)
        _add_friction(properties, counterpart(obstacle.friction, of_object))
        pose = RigidTransform(RotationMatrix(obstacle.pose.rotation), obstacle.pose.position)
        plant.RegisterCollisionGeometry(
            plant.world_body(), pose @ RigidTransform(offset), shape, obstacle.name, properties
        )


def counterpart(friction: float, of_object: float) -> float:
    """The coefficient that makes Drake's harmonic mean with `of_object` equal `friction`, which is
    at most `of_object`."""
    return friction * of_object / (2 * of_object - friction) if friction > 0 else 0.0


def _object_friction(obstacles: Sequence[Obstacle]) -> float:
    return max((each.friction for each in obstacles), default=0.0)


def _add_friction(properties: Any, coefficient: float) -> None:
    friction = CoulombFriction(coefficient, coefficient)
    geometry.AddContactMaterial(properties=properties, friction=friction)


def _shape(obstacle: Obstacle) -> tuple[Any, list[float], float]:
    """With the place of its middle in the obstacle's frame, and the length of its edges, m."""
    shape, middle = obstacle.shape, [0.0, 0.0, 0.0]
    if isinstance(shape, HalfSpace):
        return geometry.Box(_LARGE, _LARGE, _LARGE), [0.0, 0.0, -_LARGE / 2], _LARGE
    if isinstance(shape, Cuboid):
        return geometry.Box(*shape.size), middle, float(max(shape.size))
    edge = _EDGE * shape.radius
    if isinstance(shape, Sphere):
        return geometry.Sphere(shape.radius), middle, edge
    if isinstance(shape, Capsule):
        return geometry.Capsule(shape.radius, shape.length), middle, edge
    assert isinstance(shape, Cylinder)
    length = _LARGE if shape.length is None else shape.length
    return geometry.Cylinder(shape.radius, length), middle, edge
