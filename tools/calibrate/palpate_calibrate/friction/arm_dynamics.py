"""Rigid-body dynamics of an arm from its URDF: d/dt (M dq) = tau + C^T dq - g + tau_ext, as core/kinematics/chain_dynamics.hpp."""

from __future__ import annotations

import xml.etree.ElementTree as xml
from dataclasses import dataclass, field
from pathlib import Path
from typing import Optional

import numpy as np

from palpate_common.input_error import InputError
from palpate_common.joint_tree import SLIDING, Joint, numbers_of, parse_urdf, pose_of, tree_of
from palpate_common.pose import Pose
from palpate_common.rotations import Array, cross_matrix, exp_rotations


@dataclass
class Body:
    """Inertia about the origin of a frame, in its axes: kg, kg m, kg m^2."""

    mass: float = 0.0
    moment: Array = field(default_factory=lambda: np.zeros(3))
    inertia: Array = field(default_factory=lambda: np.zeros((3, 3)))

    def moved(self, X: Pose) -> Body:
        """The same body about the origin of A; X: X_AB, this one is in B."""
        turned = X.R @ self.moment
        inertia = X.R @ self.inertia @ X.R.T + self.mass * _product(X.p, X.p) + 2 * _product(X.p, turned)
        return Body(self.mass, turned + self.mass * X.p, inertia)

    def __add__(self, other: Body) -> Body:
        return Body(self.mass + other.mass, self.moment + other.moment, self.inertia + other.inertia)


def _product(r: Array, s: Array) -> Array:
    return np.asarray(r @ s * np.eye(3) - 0.5 * (np.outer(r, s) + np.outer(s, r)))


@dataclass(frozen=True, eq=False)
class ArmDynamics:
    """joints: those that move, from the base on; origins: X_PJ of each in the previous one at zero; links: what each
    moves rigidly, in its frame."""

    joints: list[Joint]
    origins: list[Pose]
    links: list[Body]
    gravity: Array  # in W, m/s^2

    def evaluate(self, q: Array, dq: Array) -> tuple[Array, Array, Array]:
        """Momentum M dq, C^T dq and g, (m, n) each, at positions and velocities, (m, n)."""
        count = len(q)
        R, p = np.broadcast_to(np.eye(3), (count, 3, 3)), np.zeros((count, 3))
        omega, v = np.zeros((count, 3)), np.zeros((count, 3))  # v: of the point at the origin of W
        axes, rates, momenta, weights = [], [], [], []
        for i, (joint, X, link) in enumerate(zip(self.joints, self.origins, self.links)):
            p, R = p + R @ X.p, R @ X.R
            along = R @ joint.axis
            if joint.kind in SLIDING:
                p = p + q[:, i, None] * along
                axis = (along, np.zeros((count, 3)))
            else:
                R = R @ exp_rotations(q[:, i, None] * joint.axis)
                axis = (np.cross(p, along), along)
            rates.append((np.cross(omega, axis[0]) + np.cross(v, axis[1]), np.cross(omega, axis[1])))
            axes.append(axis)
            v, omega = v + dq[:, i, None] * axis[0], omega + dq[:, i, None] * axis[1]
            turned = R @ link.moment
            moment = turned + link.mass * p
            P, S = cross_matrix(p), cross_matrix(turned)
            inertia = R @ link.inertia @ R.transpose(0, 2, 1) - link.mass * P @ P - P @ S - S @ P
            momenta.append((link.mass * v + np.cross(omega, moment),
                            (inertia @ omega[:, :, None])[:, :, 0] + np.cross(moment, v)))  # fmt: skip
            weights.append((np.broadcast_to(link.mass * self.gravity, (count, 3)), np.cross(moment, self.gravity)))
        return _of_joints(axes, momenta), _of_joints(rates, momenta), -_of_joints(axes, weights)


def _of_joints(axes: list[tuple[Array, Array]], wrenches: list[tuple[Array, Array]]) -> Array:
    """Each axis times the sum of the wrenches of its link and all beyond it."""
    out = np.empty((len(axes[0][0]), len(axes)))
    force, torque = np.zeros_like(axes[0][0]), np.zeros_like(axes[0][0])
    for i in reversed(range(len(axes))):
        force, torque = force + wrenches[i][0], torque + wrenches[i][1]
        out[:, i] = (axes[i][0] * force).sum(axis=1) + (axes[i][1] * torque).sum(axis=1)
    return out


def read_arm(path: Path, flange: str, gravity: Array, load: Optional[Body]) -> ArmDynamics:
    """`load`: beyond the flange, in its frame; None: what the file has there, with its joints at zero. Raises InputError."""
    root = parse_urdf(path)
    tree = tree_of(path, root)
    chain = tree.chain(flange)
    moving = [joint for joint in chain if joint.is_free]
    if not moving:
        raise InputError(f"{path}: no joint moves between the base and {flange!r}")
    bodies = {link.attrib["name"]: _inertia_of(path, link) for link in root.findall("link")}
    children: dict[str, list[Joint]] = {}
    for joint in tree.joints:
        children.setdefault(joint.parent, []).append(joint)

    def branch(link: str, ends: set[str]) -> Body:
        body = bodies[link]
        for joint in children.get(link, []):
            if joint.child not in ends:
                body = body + branch(joint.child, ends).moved(joint.X)
        return body

    beyond = {joint.child for joint in children.get(flange, [])}
    ends = {joint.child for joint in moving} | beyond
    links = [branch(joint.child, ends) for joint in moving]
    origins, since = [], Pose(np.eye(3), np.zeros(3))
    for joint in chain:
        since = since.times(joint.X)
        if joint.is_free:
            origins.append(since)
            since = Pose(np.eye(3), np.zeros(3))
    if load is None:
        load = sum((branch(j.child, set()).moved(j.X) for j in children.get(flange, [])), Body())
    links[-1] = links[-1] + load.moved(since)
    return ArmDynamics(moving, origins, links, gravity)


def _inertia_of(path: Path, link: xml.Element) -> Body:
    inertial = link.find("inertial")
    if inertial is None:
        return Body()
    try:
        mass, tensor = inertial.find("mass"), inertial.find("inertia")
        if mass is None or tensor is None:
            raise ValueError("inertial: has no mass or no inertia")
        values = {key: float(tensor.attrib[key]) for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")}
        kilograms = numbers_of(mass.attrib["value"], 1, "mass")[0]
        X = pose_of(inertial.find("origin"))
    except (KeyError, ValueError) as error:
        raise InputError(f"{path}: link {link.attrib['name']}: {error}") from error
    about_centre = np.array([[values["ixx"], values["ixy"], values["ixz"]], [values["ixy"], values["iyy"], values["iyz"]],
                             [values["ixz"], values["iyz"], values["izz"]]])  # fmt: skip
    return Body(kilograms, np.zeros(3), about_centre).moved(X)
