"""Joints and collision geometry of a URDF file."""

from __future__ import annotations

import xml.etree.ElementTree as xml
from dataclasses import dataclass
from pathlib import Path
from typing import Optional

import numpy as np

from palpate_common.input_error import InputError
from palpate_common.joint_tree import JointTree, numbers_of, parse_urdf, pose_of, tree_of
from palpate_common.mesh_files import read_surface
from palpate_common.pose import Pose
from palpate_common.surface import Surface
from palpate_see.cloud import Floats
from palpate_see.shapes import Box, Capsule, Cylinder, Mesh, Shape, Sphere


@dataclass(frozen=True, eq=False)
class LinkShape:
    """X_LS: pose of the shape's frame in the link."""

    link: str
    shape: Shape
    X_LS: Pose


@dataclass(frozen=True, eq=False)
class Robot(JointTree):
    """shapes: the links' collision geometry; of a link without it, its visual one."""

    shapes: list[LinkShape]


def read_robot(path: Path) -> Robot:
    """Raises InputError for a file that is no expanded URDF, or names meshes that cannot be read (.stl and .obj can)."""
    robot = parse_urdf(path)
    tree = tree_of(path, robot)
    try:
        shapes = [shape for link in robot.findall("link") for shape in _shapes(str(link.attrib["name"]), link, path.parent)]
    except (KeyError, ValueError, InputError) as error:
        raise InputError(f"{path}: {error}") from error
    return Robot(path, tree.root, tree.joints, shapes)


def _shapes(link: str, element: xml.Element, folder: Path) -> list[LinkShape]:
    found = element.findall("collision") or element.findall("visual")
    return [LinkShape(link, _shape(link, item.find("geometry"), folder), pose_of(item.find("origin"))) for item in found]


def _shape(link: str, geometry: Optional[xml.Element], folder: Path) -> Shape:
    item = None if geometry is None or len(geometry) == 0 else geometry[0]
    if item is None:
        raise ValueError(f"link {link}: a geometry is empty")
    if item.tag == "box":
        x, y, z = numbers_of(item.attrib["size"], 3, "size")
        return Box((x, y, z))
    if item.tag == "sphere":
        return Sphere(float(item.attrib["radius"]))
    if item.tag in ("cylinder", "capsule"):
        radius, length = float(item.attrib["radius"]), float(item.attrib["length"])
        if item.tag == "cylinder":
            return Cylinder(radius, length)
        return Capsule(radius, length)
    if item.tag == "mesh":
        surface = read_surface(_located(item.attrib["filename"], folder))
        scale = np.array(numbers_of(item.get("scale", "1 1 1"), 3, "scale"))
        return Mesh(Surface(surface.nodes * scale, surface.triangles))
    raise ValueError(f"link {link}: geometry {item.tag!r}; allowed: box, sphere, cylinder, capsule, mesh")


def _located(name: str, folder: Path) -> Path:
    """File of a mesh; that of package://NAME/REST is sought as NAME/REST and REST in the URDF's folder and those above."""
    kind, found, rest = name.partition("://")
    if not found:
        return folder / name
    if kind == "file":
        return Path(rest)
    candidates = [above / part for above in (folder, *folder.resolve().parents) for part in (rest, rest.partition("/")[2])]
    return next((path for path in candidates if path.is_file()), folder / rest)
