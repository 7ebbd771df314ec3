"""The key `obstacles` of a scene: `plane` and `cylinder` in O as palpate-sim reads them
(sim/scenes/obstacles.cpp), and `shape` in W as the daemon's configuration describes them.
"""

from __future__ import annotations

from typing import Sequence

import numpy as np
from obstacles import Capsule, Cuboid, Cylinder, HalfSpace, Obstacle, Shape, Sphere
from rigid import Floats, Pose
from scene_reader import Reader

_FAR = 100.0  # m
_FRICTION = 0.5
_SHAPES = ("half_space", "box", "sphere", "cylinder", "capsule")


def read_obstacles(items: Sequence[Reader], X_OW: Pose) -> tuple[Obstacle, ...]:
    """Raises SceneError."""
    obstacles: list[Obstacle] = []
    for index, item in enumerate(items):
        forms = [form for form in ("plane", "cylinder", "shape") if item.has(form)]
        if len(forms) != 1:
            raise item.fail("shape", "one of plane, cylinder and shape is needed, and no other")
        if forms == ["shape"]:
            shape, pose = _in_world(item, X_OW)
        elif forms == ["plane"]:
            shape, pose = _plane(item.section("plane"))
        else:
            shape, pose = _cylinder(item.section("cylinder"))
        if forms != ["shape"]:
            item.value("stiffness", 0)  # of palpate-sim's own contact: without effect here
            item.value("damping", 0)
        name = str(item.value("name", f"{forms[0]} {index + 1}"))
        if name in (each.name for each in obstacles):
            raise item.fail("name", f"{name!r} is the name of another obstacle")
        obstacles.append(Obstacle(name, shape, pose, item.number("friction", 0, 10, _FRICTION)))
        item.end()
    return tuple(obstacles)


def _plane(reader: Reader) -> tuple[Shape, Pose]:
    normal = _direction(reader, "normal")
    pose = Pose(_with_z_along(normal), reader.numbers("point", 3))
    reader.end()
    return HalfSpace(), pose


def _cylinder(reader: Reader) -> tuple[Shape, Pose]:
    pose = Pose(_with_z_along(_direction(reader, "axis")), reader.numbers("point", 3))
    length = reader.number("length", 1e-3, _FAR) if reader.has("length") else None
    shape = Cylinder(reader.number("radius", 1e-3, _FAR), length)
    reader.end()
    return shape, pose


def _in_world(item: Reader, X_OW: Pose) -> tuple[Shape, Pose]:
    kind = item.value("shape")
    if kind not in _SHAPES:
        raise item.fail("shape", f"{kind!r} is not supported; allowed: {', '.join(_SHAPES)}")
    pose = X_OW @ item.pose("pose", optional=True)
    if kind == "half_space":
        return HalfSpace(), pose
    if kind == "box":
        size = item.numbers("size", 3)
        if not size.min() >= 1e-4:
            raise item.fail("size", f"{size.tolist()} has a side below 0.0001 m")
        return Cuboid(size), pose
    radius = item.number("radius", 1e-4, _FAR)
    if kind == "sphere":
        return Sphere(radius), pose
    if kind == "cylinder" and not item.has("length"):
        return Cylinder(radius, None), pose
    length = item.number("length", 1e-4, _FAR)
    return Cylinder(radius, length) if kind == "cylinder" else Capsule(radius, length), pose


def _direction(reader: Reader, key: str) -> Floats:
    direction = reader.numbers(key, 3)
    length = float(np.linalg.norm(direction))
    if length < 1e-6:
        raise reader.fail(key, "is zero; allowed: any other vector")
    return np.asarray(direction / length)


def _with_z_along(direction: Floats) -> Floats:
    """A rotation whose third column is the unit vector."""
    other = np.eye(3)[int(np.argmin(np.abs(direction)))]
    x = np.cross(other, direction)
    x = x / np.linalg.norm(x)
    return np.column_stack([x, np.cross(direction, x), direction])
