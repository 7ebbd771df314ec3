"""What a wrist's sensor carries, from a URDF's masses; kinematics and sums of its own, not the simulator's."""

from __future__ import annotations

import xml.etree.ElementTree as xml
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

from palpate_common.pose import Pose
from palpate_common.rotations import exp_rotation, from_rpy

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Payload:
    """mass, kg; center, (3,), m; inertia about the frame's origin, (3, 3), kg m^2, all in one frame."""

    mass: float
    center: Floats
    inertia: Floats

    def plus(self, other: "Payload") -> "Payload":
        mass = self.mass + other.mass
        center = (self.mass * self.center + other.mass * other.center) / mass if mass > 0 else self.center
        return Payload(mass, center, self.inertia + other.inertia)

    def times(self, factor: float) -> "Payload":
        """Of a body of another density."""
        return Payload(factor * self.mass, self.center, factor * self.inertia)

    def turned(self, R: Floats) -> "Payload":
        """The same in axes of which R, (3, 3), turns vectors into the present ones."""
        return Payload(self.mass, R.T @ self.center, R.T @ self.inertia @ R)


def payload_of(mass: float, center: Floats, about_center: Floats) -> Payload:
    """Of a body whose inertia about its centre of mass, (3, 3), has the axes of the frame."""
    return Payload(mass, center, about_center + mass * (center @ center * np.eye(3) - np.outer(center, center)))


class Links:
    """The tree of an expanded URDF's links."""

    def __init__(self, path: Path) -> None:
        root = xml.parse(path).getroot()
        self._links = {str(link.get("name")): link for link in root.findall("link")}
        self._joints = {_named(joint, "child"): joint for joint in root.findall("joint")}

    def pose(self, link: str, ancestor: str, angles: dict[str, float]) -> Optional[Pose]:
        """Of a link in another one that it hangs on, with the joints at `angles`, rad, else 0; None if it does not."""
        X = Pose(np.eye(3), np.zeros(3))
        while link != ancestor:
            joint = self._joints.get(link)
            if joint is None:
                return None
            axis = joint.find("axis")
            turn = angles.get(str(joint.get("name")), 0.0) * (np.zeros(3) if axis is None else _numbers(axis.get("xyz")))
            X = _pose(joint.find("origin")).times(Pose(exp_rotation(turn), np.zeros(3))).times(X)
            link = _named(joint, "parent")
        return X

    def payload(self, beyond: str, angles: dict[str, float]) -> Payload:
        """Of all links that hang on `beyond`, and itself, in its frame."""
        total = Payload(0.0, np.zeros(3), np.zeros((3, 3)))
        for name, link in self._links.items():
            X, inertial = self.pose(name, beyond, angles), link.find("inertial")
            if X is None or inertial is None:
                continue
            at = X.times(_pose(inertial.find("origin")))
            i = {key: float(value) for key, value in inertial.find("inertia").attrib.items()}  # type: ignore[union-attr]
            moment = np.array([[i["ixx"], i["ixy"], i["ixz"]], [i["ixy"], i["iyy"], i["iyz"]], [i["ixz"], i["iyz"], i["izz"]]])
            mass = float(inertial.find("mass").get("value"))  # type: ignore[union-attr, arg-type]
            total = total.plus(payload_of(mass, at.p, at.R @ moment @ at.R.T))
        return total


def _named(joint: xml.Element, tag: str) -> str:
    return str(joint.find(tag).get("link"))  # type: ignore[union-attr]


def _numbers(text: Any) -> Floats:
    return np.array([float(word) for word in (text or "0 0 0").split()])


def _pose(origin: Optional[xml.Element]) -> Pose:
    if origin is None:
        return Pose(np.eye(3), np.zeros(3))
    return Pose(from_rpy(_numbers(origin.get("rpy"))), _numbers(origin.get("xyz")))
