"""Poses of a robot's links by the angles of its joints."""

from __future__ import annotations

from typing import Mapping

import numpy as np

from palpate_common.joint_tree import SLIDING, TURNING, Joint, JointTree
from palpate_common.pose import Pose
from palpate_common.rotations import exp_rotation


def link_poses(robot: JointTree, angles: Mapping[str, float]) -> dict[str, Pose]:
    """X_WL of every link L, where W is the frame of the root link. angles: rad, or m of a sliding joint, by name; a
    joint that is not among them is at zero."""
    poses = {robot.root: Pose(np.eye(3), np.zeros(3))}
    for joint in robot.joints:
        poses[joint.child] = poses[joint.parent].times(joint.X).times(_motion(joint, _angle(joint, angles)))
    return poses


def _angle(joint: Joint, angles: Mapping[str, float]) -> float:
    if joint.mimic is None:
        return angles.get(joint.name, 0.0)
    followed, factor, offset = joint.mimic
    return factor * angles.get(followed, 0.0) + offset


def _motion(joint: Joint, angle: float) -> Pose:
    R = exp_rotation(angle * joint.axis) if joint.kind in TURNING else np.eye(3)
    return Pose(R, angle * joint.axis if joint.kind in SLIDING else np.zeros(3))
