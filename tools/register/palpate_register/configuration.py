"""The parts of palpated's configuration that a registration needs."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Optional

import numpy as np
from numpy.typing import NDArray

from palpate_common.frames import rotation_and_position
from palpate_common.mesh_files import read_surface
from palpate_common.pose import Pose
from palpate_common.section import Section, read_configuration_section
from palpate_common.surface import Surface, box_surface

Floats = NDArray[np.float64]
SIZE = (0.001, 10.0)  # m, of an edge of the box
FILTER = "pose_wrench_filter"  # the estimator that has a prior of the pose


@dataclass(frozen=True, eq=False)
class Configuration:
    """Of one file and those that it is based on."""

    path: Path
    surface: Surface
    object_in_base: Optional[Pose]  # as configured
    grasp: Optional[Floats]  # (3,), m, in O: where the hand holds the object
    fixed: Optional[tuple[Floats, Floats]]  # m, in O: corners of the box of the clamped nodes
    component: str  # of `estimation`
    pose_position_deviation: float  # m, as configured or the default
    pose_rotation_deviation: float  # rad


def _surface(mesh: Section) -> Surface:
    if mesh.has("box") == mesh.has("file"):
        mesh.fail("file", "exactly one of box and file is needed")
    if mesh.has("box"):
        return box_surface(mesh.section("box").numbers("size", 3, *SIZE))
    return read_surface(mesh.file_of("file").parent / mesh.text("file"))


def _box(section: Section) -> Optional[tuple[Floats, Floats]]:
    if not (section.has("lower") and section.has("upper")):
        return None
    return np.array(section.numbers("lower", 3, -100, 100)), np.array(section.numbers("upper", 3, -100, 100))


def _grasp(of_object: Section) -> Optional[Floats]:
    at_rest = of_object.optional("grasp_at_rest")
    if at_rest.has("position"):
        return np.array(at_rest.numbers("position", 3, -100, 100))
    box = _box(of_object.optional("grasp_box"))
    return None if box is None else 0.5 * (box[0] + box[1])


def read_configuration(path: Path) -> Configuration:
    """Raises InputError with file, line, key, value and what is allowed."""
    top = read_configuration_section(path)
    of_object, estimation = top.optional("object"), top.optional("estimation")
    pose = top.optional("frames", "object_in_base")
    return Configuration(
        path,
        _surface(of_object.optional("mesh")),
        Pose(*rotation_and_position(pose)) if pose.values else None,
        _grasp(of_object),
        _box(of_object.optional("fixed_box")),
        estimation.text("component", ""),
        estimation.number("pose_position_deviation", 1e-6, 0.1, 0.001),
        estimation.number("pose_rotation_deviation", 1e-6, 1.0, 0.009),
    )
