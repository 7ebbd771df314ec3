"""Links, joints and collision geometry of a URDF file."""

from __future__ import annotations

import xml.etree.ElementTree as xml
from dataclasses import dataclass
from pathlib import Path
from typing import Optional

import numpy as np

from palpate_common.input_error import InputError
from palpate_common.mesh_files import read_surface
from palpate_common.pose import Pose
from palpate_common.rotations import from_rpy
from palpate_common.surface import Surface
from palpate_see.cloud import Floats
from palpate_see.shapes import Box, Capsule, Cylinder, Mesh, Shape, Sphere

TURNING, SLIDING, FIXED = ("revolute", "continuous"), ("prismatic",), ("fixed",)


@dataclass(frozen=True, eq=False)
class Joint:
    """X: pose of the child link in the parent link at zero. axis: (3,), unit, in the child. mimic: the joint that it
    follows, with factor and offset. has_limits: of speed and effort."""

    name: str
    kind: str
    parent: str
    child: str
    X: Pose
    axis: Floats
    mimic: Optional[tuple[str, float, float]]
    has_limits: bool

    @property
    def is_free(self) -> bool:
        """Whether it has an angle of its own."""
        return self.kind not in FIXED and self.mimic is None


@dataclass(frozen=True, eq=False)
class LinkShape:
    """X_LS: pose of the shape's frame in the link."""

    link: str
    shape: Shape
    X_LS: Pose


@dataclass(frozen=True, eq=False)
class Robot:
    """joints: each after that of its parent. shapes: the links' collision geometry; of a link without it, its visual one."""

    path: Path
    root: str
    joints: list[Joint]
    shapes: list[LinkShape]

    def arm_joints(self, flange: str) -> list[str]:
        """The free joints from the root to the link `flange`. Raises InputError if there is no such link."""
        by_child = {joint.child: joint for joint in self.joints}
        if flange != self.root and flange not in by_child:
            raise InputError(f"{self.path}: link {flange!r}; allowed: {', '.join([self.root, *by_child])}")
        names = []
        while flange in by_child:
            joint = by_child[flange]
            if joint.is_free:
                names.append(joint.name)
            flange = joint.parent
        return names[::-1]

    def hand_joints(self, flange: str) -> list[str]:
        """The free joints with limits beyond the flange, in the order of the file, as palpate-sim has them."""
        beyond, names = {flange}, []
        for joint in self.joints:
            if joint.parent in beyond:
                beyond.add(joint.child)
                if joint.is_free and joint.has_limits:
                    names.append(joint.name)
        order = {joint.name: i for i, joint in enumerate(self.joints)}
        return sorted(names, key=order.__getitem__)


def read_robot(path: Path) -> Robot:
    """Raises InputError for a file that is no expanded URDF, or names meshes that cannot be read (.stl and .obj can)."""
    try:
        root = xml.parse(path).getroot()
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from error
    except xml.ParseError as error:
        raise InputError(f"{path}: {error}") from error
    if root.tag != "robot":
        raise InputError(f"{path}: begins with <{root.tag}>; allowed: <robot>")
    try:
        links = {str(link.attrib["name"]): link for link in root.findall("link")}
        joints = [_joint(item) for item in root.findall("joint")]
        shapes = [shape for name, link in links.items() for shape in _shapes(name, link, path.parent)]
    except (KeyError, ValueError, InputError) as error:
        raise InputError(f"{path}: {error}") from error
    return _ordered(path, list(links), joints, shapes)


def _ordered(path: Path, links: list[str], joints: list[Joint], shapes: list[LinkShape]) -> Robot:
    children = {joint.child for joint in joints}
    roots = [link for link in links if link not in children]
    for joint in joints:
        for link in (joint.parent, joint.child):
            if link not in links:
                raise InputError(f"{path}: joint {joint.name}: link {link!r} is missing")
        if joint.mimic is not None and joint.mimic[0] not in {other.name for other in joints if other.is_free}:
            raise InputError(f"{path}: joint {joint.name}: mimics {joint.mimic[0]!r}, which has no angle of its own")
    if len(roots) != 1 or len(children) != len(joints):
        raise InputError(f"{path}: its links form no tree with one root")
    placed, rest = {roots[0]}, list(joints)
    ordered: list[Joint] = []
    while rest:
        ready = [joint for joint in rest if joint.parent in placed]
        if not ready:
            raise InputError(f"{path}: joint {rest[0].name} is part of a circle")
        first = ready[0]
        ordered.append(first)
        rest.remove(first)
        placed.add(first.child)
    return Robot(path, roots[0], ordered, shapes)


def _numbers(text: str, count: int, what: str) -> list[float]:
    values = [float(word) for word in text.split()]
    if len(values) != count or not np.isfinite(values).all():
        raise ValueError(f"{what}={text!r}; allowed: {count} numbers")
    return values


def _pose(element: Optional[xml.Element]) -> Pose:
    words = {} if element is None else element.attrib
    rpy, xyz = (np.array(_numbers(words.get(key, "0 0 0"), 3, key)) for key in ("rpy", "xyz"))
    return Pose(from_rpy(rpy), xyz)


def _joint(item: xml.Element) -> Joint:
    name, kind = item.attrib["name"], item.attrib["type"]
    if kind not in TURNING + SLIDING + FIXED:
        raise ValueError(f"joint {name}: type {kind!r}; allowed: {', '.join(TURNING + SLIDING + FIXED)}")
    parent, child, axis = item.find("parent"), item.find("child"), item.find("axis")
    if parent is None or child is None:
        raise ValueError(f"joint {name}: has no parent or no child")
    along = np.array(_numbers("1 0 0" if axis is None else axis.get("xyz", "1 0 0"), 3, "axis"))
    length = float(np.linalg.norm(along))
    if length < 1e-9 and kind not in FIXED:
        raise ValueError(f"joint {name}: axis {along.tolist()}; allowed: a length above 0")
    followed, limit = item.find("mimic"), item.find("limit")
    mimic = None
    if followed is not None:
        mimic = (followed.attrib["joint"], float(followed.get("multiplier", 1)), float(followed.get("offset", 0)))
    has_limits = limit is not None and float(limit.get("velocity", 0)) > 0 and float(limit.get("effort", 0)) > 0
    return Joint(name, kind, parent.attrib["link"], child.attrib["link"], _pose(item.find("origin")),
                 along / max(length, 1e-9), mimic, has_limits)  # fmt: skip


def _shapes(link: str, element: xml.Element, folder: Path) -> list[LinkShape]:
    found = element.findall("collision") or element.findall("visual")
    return [LinkShape(link, _shape(link, item.find("geometry"), folder), _pose(item.find("origin"))) for item in found]


def _shape(link: str, geometry: Optional[xml.Element], folder: Path) -> Shape:
    item = None if geometry is None or len(geometry) == 0 else geometry[0]
    if item is None:
        raise ValueError(f"link {link}: a geometry is empty")
    if item.tag == "box":
        x, y, z = _numbers(item.attrib["size"], 3, "size")
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
        scale = np.array(_numbers(item.get("scale", "1 1 1"), 3, "scale"))
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
