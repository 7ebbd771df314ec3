"""The arm and hand of a URDF: forward kinematics, Jacobian, and the hand as one rigid payload."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from typing import Optional

import numpy as np
from rigid import Floats, Pose, cross, exp_rotation
from scene import Scene
from scene_reader import SceneError
from scipy.spatial.transform import Rotation


@dataclass(frozen=True)
class _Joint:
    name: str
    parent: str
    origin: Pose  # of the joint in its parent link
    axis: Optional[Floats]  # None: fixed
    limits: Floats  # lower, upper, rad; velocity, rad/s


@dataclass(frozen=True)
class Payload:
    """What the sensor carries, as one rigid body: kg, m in S, kg m^2 about the centre of mass."""

    mass: float
    centre: Floats
    inertia: Floats


def _numbers(element: Optional[ElementTree.Element], name: str) -> Floats:
    text = "0 0 0" if element is None else element.get(name, "0 0 0")
    return np.array([float(word) for word in text.split()])


def _origin(element: ElementTree.Element) -> Pose:
    origin = element.find("origin")
    rotation = Rotation.from_euler("xyz", _numbers(origin, "rpy")).as_matrix()
    return Pose(rotation, _numbers(origin, "xyz"))


def _joint(element: ElementTree.Element) -> _Joint:
    name = element.get("name", "")
    parent = element.find("parent")
    link = "" if parent is None else parent.get("link", "")
    if element.get("type") == "fixed":
        return _Joint(name, link, _origin(element), None, np.zeros(3))
    if element.get("type") != "revolute":
        raise ValueError(f"joint {name} is neither revolute nor fixed")
    axis, limit = element.find("axis"), element.find("limit")
    if limit is None:
        raise ValueError(f"joint {name} has no limit")
    limits = [float(limit.get(key, "0")) for key in ("lower", "upper", "velocity")]
    direction = np.array([1.0, 0, 0]) if axis is None else _numbers(axis, "xyz")
    return _Joint(name, link, _origin(element), direction, np.array(limits))


class RobotModel:
    """The serial arm from the root to the flange E; the hand keeps its initial joints."""

    def __init__(self, scene: Scene) -> None:
        """Raises SceneError."""
        try:
            root = ElementTree.parse(scene.urdf).getroot()
            self._joints = {}  # by child link
            for element in root.findall("joint"):
                child = element.find("child")
                self._joints["" if child is None else child.get("link", "")] = _joint(element)
        except (OSError, ElementTree.ParseError, ValueError) as error:
            raise SceneError(f"{scene.urdf}: {error}") from None
        self._links = {link.get("name", ""): link for link in root.findall("link")}
        for name in scene.frames.values():
            if name not in self._links:
                raise SceneError(f"{scene.urdf}: has no link {name}, which the scene names")
        self._chain = self._path(scene.frames["flange"])
        moving = [joint for joint in self._chain if joint.axis is not None]
        if len(moving) != len(scene.initial_joints):
            raise SceneError(
                f"{scene.file}: robot.initial_joints: has {len(scene.initial_joints)} numbers; "
                f"the arm has {len(moving)} joints"
            )
        self.lower, self.upper, self.speed = np.array([joint.limits for joint in moving]).T
        self._hand = scene.initial_hand
        flange = scene.frames["flange"]
        self.X_ES = self._fixed(flange, scene.frames["sensor"])
        self.X_EI = self._fixed(flange, scene.frames["imu"])
        self.payload = self._payload(scene.frames["sensor"])

    def _path(self, link: str) -> list[_Joint]:
        """Joints from the root to the link."""
        path: list[_Joint] = []
        while link in self._joints:
            path.insert(0, self._joints[link])
            link = path[0].parent
        return path

    def _step(self, joint: _Joint) -> Pose:
        """Over a joint of the hand, at its initial position."""
        if joint.axis is None:
            return joint.origin
        angle = self._hand.get(joint.name, 0.0)
        return joint.origin @ Pose(exp_rotation(angle * joint.axis))

    def _fixed(self, base: str, link: str) -> Pose:
        """Pose of a link of the hand in a link that carries it."""
        pose = Pose()
        while link != base:
            if link not in self._joints:
                raise SceneError(f"link {link} of the robot is not carried by {base}")
            pose = self._step(self._joints[link]) @ pose
            link = self._joints[link].parent
        return pose

    def _payload(self, sensor: str) -> Payload:
        masses, centres, inertias = [], [], []
        for name, link in self._links.items():
            inertial = link.find("inertial")
            if inertial is None or sensor not in self._ancestors(name):
                continue
            mass, moments = inertial.find("mass"), inertial.find("inertia")
            place = self._fixed(sensor, name) @ _origin(inertial)
            masses.append(0.0 if mass is None else float(mass.get("value", "0")))
            centres.append(place.position)
            keys = ("ixx", "ixy", "ixz", "ixy", "iyy", "iyz", "ixz", "iyz", "izz")
            values = [0.0 if moments is None else float(moments.get(key, "0")) for key in keys]
            inertias.append(place.rotation @ np.reshape(values, (3, 3)) @ place.rotation.T)
        total = sum(masses)
        if total <= 0:
            return Payload(0.0, np.zeros(3), np.zeros((3, 3)))
        centre = np.asarray(sum(m * c for m, c in zip(masses, centres)) / total)
        inertia = np.zeros((3, 3))
        for m, c, about_own in zip(masses, centres, inertias):
            r = c - centre
            inertia += about_own + m * (r @ r * np.eye(3) - np.outer(r, r))
        return Payload(total, centre, inertia)

    def _ancestors(self, link: str) -> list[str]:
        found = [link]
        while link in self._joints:
            link = self._joints[link].parent
            found.append(link)
        return found

    def flange(self, q: Floats) -> tuple[Pose, Floats]:
        """X_WE, and its Jacobian, (6, joints): linear rows first, origin of E, in W."""
        rotation, position = np.eye(3), np.zeros(3)
        axes, places, index = [], [], 0
        for joint in self._chain:
            position = rotation @ joint.origin.position + position
            rotation = rotation @ joint.origin.rotation
            if joint.axis is not None:
                axes.append(rotation @ joint.axis)
                places.append(position)
                rotation = rotation @ _about(joint.axis, q[index])
                index += 1
        columns = [
            np.concatenate([cross(axis, position - place), axis])
            for axis, place in zip(axes, places)
        ]
        return Pose(rotation, position), np.array(columns).T


def _about(axis: Floats, angle: float) -> Floats:
    """Rodrigues' formula for a unit axis; scipy's is slow for single ones."""
    x, y, z = axis
    s, c = np.sin(angle), 1 - np.cos(angle)
    return np.array(
        [
            [1 - c * (y * y + z * z), c * x * y - s * z, c * x * z + s * y],
            [c * x * y + s * z, 1 - c * (x * x + z * z), c * y * z - s * x],
            [c * x * z - s * y, c * y * z + s * x, 1 - c * (x * x + y * y)],
        ]
    )
