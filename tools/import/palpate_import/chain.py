"""Motion of a link by the angles of the joints that lead to it, of many rows at once."""

from __future__ import annotations

from typing import Optional

import numpy as np
from numpy.typing import NDArray

from palpate_common.joint_tree import TURNING, JointTree
from palpate_common.rotations import exp_rotations

Floats = NDArray[np.float64]


def chain_motion(tree: JointTree, link: str, q: Floats, dq: Optional[Floats]) -> tuple[Floats, Floats, Optional[Floats]]:
    """Position (n, 3), m, rotation (n, 3, 3) and, with dq, twist (n, 6), linear first, m/s and rad/s, of a link in the root, in the
    root's axes. q, dq: (n, k), rad and rad/s, of tree.arm_joints(link)."""
    count = len(q)
    R, p = np.broadcast_to(np.eye(3), (count, 3, 3)), np.zeros((count, 3))
    free = {name: i for i, name in enumerate(tree.arm_joints(link))}
    motions = []  # (whether it turns, axis (n, 3), a point of it (n, 3), rate (n,))
    for joint in tree.chain(link):
        p = p + np.einsum("nij,j->ni", R, joint.X.p)
        R = R @ joint.X.R
        name, factor, offset = (joint.name, 1.0, 0.0) if joint.mimic is None else joint.mimic
        if name not in free:
            continue
        angle = factor * q[:, free[name]] + offset
        axis = np.einsum("nij,j->ni", R, joint.axis)
        is_turning = joint.kind in TURNING
        if is_turning:
            motions.append((True, axis, p, factor, free[name]))
            R = R @ exp_rotations(angle[:, None] * joint.axis)
        else:
            p = p + angle[:, None] * axis
            motions.append((False, axis, p, factor, free[name]))
    if dq is None:
        return p, R, None
    twist = np.zeros((count, 6))
    for is_turning, axis, at, factor, index in motions:
        rate = factor * dq[:, index, None]
        if is_turning:
            twist[:, :3] += rate * np.cross(axis, p - at)
            twist[:, 3:] += rate * axis
        else:
            twist[:, :3] += rate * axis
    return p, R, twist
