"""Joints of a URDF file: a tree of links, and the motion of its links by the joints' angles."""

from __future__ import annotations

import xml.etree.ElementTree as xml
from dataclasses import dataclass
from pathlib import Path
from typing import Optional

import numpy as np
from numpy.typing import NDArray

from palpate_common.input_error import InputError
from palpate_common.pose import Pose
from palpate_common.rotations import from_rpy

Floats = NDArray[np.float64]
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
class JointTree:
    """joints: each after that of its parent."""

    path: Path
    root: str
    joints: list[Joint]

    def chain(self, flange: str) -> list[Joint]:
        """All joints from the root to the link `flange`. Raises InputError if there is no such link."""
        by_child = {joint.child: joint for joint in self.joints}
        if flange != self.root and flange not in by_child:
            raise InputError(f"{self.path}: link {flange!r}; allowed: {', '.join([self.root, *by_child])}")
        joints = []
        while flange in by_child:
            joints.append(by_child[flange])
            flange = joints[-1].parent
        return joints[::-1]

    def arm_joints(self, flange: str) -> list[str]:
        """The free joints from the root to the link `flange`. Raises InputError if there is no such link."""
        return [joint.name for joint in self.chain(flange) if joint.is_free]

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


def parse_urdf(path: Path) -> xml.Element:
    """The element <robot>. Raises InputError."""
    try:
        root = xml.parse(path).getroot()
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from error
    except xml.ParseError as error:
        raise InputError(f"{path}: {error}") from error
    if root.tag != "robot":
        raise InputError(f"{path}: begins with <{root.tag}>; allowed: <robot>")
    return root


def read_joint_tree(path: Path) -> JointTree:
    """Raises InputError for a file that is no expanded URDF."""
    return tree_of(path, parse_urdf(path))


def tree_of(path: Path, robot: xml.Element) -> JointTree:
    """The joints of an element <robot>. Raises InputError."""
    try:
        links = [str(link.attrib["name"]) for link in robot.findall("link")]
        joints = [_joint(item) for item in robot.findall("joint")]
    except (KeyError, ValueError) as error:
        raise InputError(f"{path}: {error}") from error
    return JointTree(path, *_ordered(path, links, joints))


def _ordered(path: Path, links: list[str], joints: list[Joint]) -> tuple[str, list[Joint]]:
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
    return roots[0], ordered


def numbers_of(text: str, count: int, what: str) -> list[float]:
    """Of an attribute. Raises ValueError."""
    values = [float(word) for word in text.split()]
    if len(values) != count or not np.isfinite(values).all():
        raise ValueError(f"{what}={text!r}; allowed: {count} numbers")
    return values


def pose_of(element: Optional[xml.Element]) -> Pose:
    """Of an element <origin>. Raises ValueError."""
    words = {} if element is None else element.attrib
    rpy, xyz = (np.array(numbers_of(words.get(key, "0 0 0"), 3, key)) for key in ("rpy", "xyz"))
    return Pose(from_rpy(rpy), xyz)


def _joint(item: xml.Element) -> Joint:
    name, kind = item.attrib["name"], item.attrib["type"]
    if kind not in TURNING + SLIDING + FIXED:
        raise ValueError(f"joint {name}: type {kind!r}; allowed: {', '.join(TURNING + SLIDING + FIXED)}")
    parent, child, axis = item.find("parent"), item.find("child"), item.find("axis")
    if parent is None or child is None:
        raise ValueError(f"joint {name}: has no parent or no child")
    along = np.array(numbers_of("1 0 0" if axis is None else axis.get("xyz", "1 0 0"), 3, "axis"))
    length = float(np.linalg.norm(along))
    if length < 1e-9 and kind not in FIXED:
        raise ValueError(f"joint {name}: axis {along.tolist()}; allowed: a length above 0")
    followed, limit = item.find("mimic"), item.find("limit")
    mimic = None
    if followed is not None:
        mimic = (followed.attrib["joint"], float(followed.get("multiplier", 1)), float(followed.get("offset", 0)))
    has_limits = limit is not None and float(limit.get("velocity", 0)) > 0 and float(limit.get("effort", 0)) > 0
    return Joint(name, kind, parent.attrib["link"], child.attrib["link"], pose_of(item.find("origin")),
                 along / max(length, 1e-9), mimic, has_limits)  # fmt: skip
