"""The robot's links as bodies to cast rays at, and its grasp, with kinematics of their own (not of tools/see)."""

from __future__ import annotations

import xml.etree.ElementTree as xml
from pathlib import Path

import numpy as np
from rays import Body, Floats
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

ARM = [f"joint_{i}" for i in range(1, 8)]
REACH = 0.30  # m, from the flange to the middle of the fingertips


class Model:
    """Of an expanded URDF with boxes, cylinders and spheres as visual geometry."""

    def __init__(self, path: Path) -> None:
        self._root = xml.parse(path).getroot()
        joints = self._root.iter("joint")
        self._joints = {joint.find("child").get("link"): joint for joint in joints}  # type: ignore[union-attr]

    def pose(self, link: str, angles: dict[str, float]) -> tuple[Floats, Floats]:
        """R, p of a link in W: from the link upwards to the base."""
        R, p = np.eye(3), np.zeros(3)
        while link in self._joints:
            joint = self._joints[link]
            axis = joint.find("axis")
            if axis is not None and joint.get("type") == "revolute":
                turn = Rotation.from_rotvec(angles.get(joint.get("name", ""), 0.0) * _words(axis.get("xyz"))).as_matrix()
                R, p = turn @ R, turn @ p
            origin = joint.find("origin")
            R_origin = Rotation.from_euler("xyz", _words(origin.get("rpy", "0 0 0"))).as_matrix()
            R, p = R_origin @ R, R_origin @ p + _words(origin.get("xyz", "0 0 0"))
            link = joint.find("parent").get("link")
        return R, p

    def bodies(self, angles: dict[str, float], label: int) -> list[Body]:
        """All visual geometry at these angles, rad."""
        found = []
        for link in self._root.iter("link"):
            for visual in link.iter("visual"):
                R, p = self.pose(link.get("name", ""), angles)
                place = _words(visual.find("origin").get("xyz", "0 0 0"))  # type: ignore[union-attr]
                shape = visual.find("geometry")[0]  # type: ignore[index]
                keys = {"box": ["size"], "cylinder": ["radius", "length"], "sphere": ["radius"]}[shape.tag]
                size = tuple(float(word) for key in keys for word in shape.get(key).split())  # type: ignore[union-attr]
                found.append(Body(shape.tag, size, R, R @ place + p, label))
        return found

    def grasp(self, R: Floats, middle: Floats) -> dict[str, float]:
        """Angles of the arm, rad, at which the flange has the rotation R, (3, 3), and the fingertips are about `middle`,
        (3,), m.

        Raises RuntimeError if the arm does not reach.
        """
        goal = middle - REACH * R[:, 2]

        def residual(q: Floats) -> Floats:
            found, p = self.pose("flange", dict(zip(ARM, q)))
            return np.concatenate([10 * (p - goal), Rotation.from_matrix(found.T @ R).as_rotvec()])

        limits = np.array([2.96, 2.09] * 4)[:7]
        for start in ([0, 1.0, 0, 1.4, 0, -1.0, 0], [0, -0.8, 0, -1.4, 0, 1.0, 0], [0.5, 1.2, -0.5, 1.0, 0.5, -0.5, 0.5],
                      [0, 0.3, 0, 1.9, 0, 1.2, 1.5], [0, -1.2, 3 - 0.1, 1.4, 0, -1.0, 0]):  # fmt: skip
            start = np.clip(start, 0.99 * -limits, 0.99 * limits)
            solved = least_squares(residual, start, bounds=(-limits, limits), max_nfev=200)
            if np.abs(solved.fun).max() < 1e-6:
                return dict(zip(ARM, solved.x))
        raise RuntimeError(f"the arm does not reach {np.round(goal, 3).tolist()}")


def _words(text: str | None) -> Floats:
    return np.array([float(word) for word in (text or "0 0 0").split()])
