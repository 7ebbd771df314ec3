"""Shapes of the obstacles of palpated's configuration."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Optional

import numpy as np

from palpate_common.frames import rotation_and_position
from palpate_common.mesh_files import read_surface
from palpate_common.pose import Pose
from palpate_common.section import Section
from palpate_see.shapes import Box, Capsule, Cylinder, HalfSpace, Mesh, Shape, Sphere

KINDS = ["half_space", "box", "sphere", "cylinder", "capsule", "mesh"]
SMALLEST, LARGEST = 1e-4, 100.0  # m


@dataclass(frozen=True, eq=False)
class Obstacle:
    """X: pose of the shape's frame in W, or in `link`. is_moved: by messages, which are not followed. position_deviation,
    rotation_deviation: standard deviations of that pose in any direction, m and rad."""

    name: str
    shape: Shape
    X: Pose
    link: Optional[str]
    is_moved: bool
    position_deviation: float
    rotation_deviation: float


def read_obstacles(top: Section, deviation: float) -> list[Obstacle]:
    """Of a configuration of palpated, which itself checks the keys that are not used here.

    deviation: least standard deviation of an obstacle's position, m. Raises InputError, also for a mesh's file.
    """
    return [_obstacle(item, deviation) for item in top.sections("obstacles", [])]


def _obstacle(item: Section, deviation: float) -> Obstacle:
    X = Pose(*rotation_and_position(item.optional("pose")))
    link = item.text("link") if item.has("link") else None
    stated = item.optional("pose_deviation")
    position = max(deviation, *stated.numbers("position", 3, 0, 0.1, [0, 0, 0]))
    rotation = float(np.radians(max(stated.numbers("rotation_deg", 3, 0, 30, [0, 0, 0]))))
    return Obstacle(item.text("name"), _shape(item), X, link, item.flag("moved", False), position, rotation)


def _shape(item: Section) -> Shape:
    kind = item.choice("shape", KINDS)
    if kind == "half_space":
        return HalfSpace()
    if kind == "box":
        x, y, z = item.numbers("size", 3, SMALLEST, LARGEST)
        return Box((x, y, z))
    if kind == "mesh":
        return Mesh(read_surface(Path(item.file_of("file").parent, item.text("file"))))
    radius = item.number("radius", SMALLEST, LARGEST)
    if kind == "sphere":
        return Sphere(radius)
    if kind == "capsule":
        return Capsule(radius, item.number("length", SMALLEST, LARGEST))
    return Cylinder(radius, item.number("length", SMALLEST, LARGEST) if item.has("length") else np.inf)
