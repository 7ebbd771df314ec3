"""Rotations that map a surface to itself, found by trial and named in words."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate_common.pose import Pose, angle_of
from palpate_common.rotations import exp_rotation
from palpate_common.surface import Surface

Floats = NDArray[np.float64]
TOLERANCE = 0.004  # of the largest side: rotations that move the surface less are symmetries
SAMPLES = 400
ORDERS = (2, 3, 4, 5, 6, 8)
ANY = 24  # steps of a full turn that stand for a rotation by any angle
TURNS = {2: "half a turn", 3: "a third of a turn", 4: "a quarter turn", 5: "a fifth of a turn",
         6: "a sixth of a turn", 8: "an eighth of a turn", ANY: "any turn"}  # fmt: skip
MOST = 240  # rotations of a group


@dataclass(frozen=True, eq=False)
class Axis:
    """An axis of symmetry through the centre."""

    direction: Floats  # (3,), unit, in O
    order: int  # a turn by 2 pi / order is a symmetry; ANY: every turn is
    name: str  # in words


@dataclass(frozen=True, eq=False)
class Symmetries:
    """Rotations about the centre in O that map the surface to itself."""

    rotations: Floats  # (n, 3, 3), the identity first
    axes: list[Axis]
    center: Floats  # (3,), m, in O

    @property
    def text(self) -> str:
        """In words."""
        if not self.axes:
            return "no rotation maps the object to itself"
        by_turn: dict[int, list[str]] = {}
        for axis in self.axes:
            by_turn.setdefault(axis.order, []).append(axis.name)
        parts = [f"{TURNS[order]} about {_joined(names)}" for order, names in sorted(by_turn.items(), reverse=True)]
        return "the same after " + ", ".join(parts)

    def equivalents(self, pose: Pose) -> list[Pose]:
        """All poses with the same surface, the given one first."""
        return [self._turned(pose, S) for S in self.rotations]

    def nearest(self, pose: Pose, to: Pose) -> Pose:
        """The equivalent pose whose rotation is nearest to another pose's."""
        angles = [angle_of(pose.R @ S @ to.R.T) for S in self.rotations]
        return self._turned(pose, self.rotations[int(np.argmin(angles))])

    def free_axis(self) -> Floats | None:
        """(3,), unit, in O: the axis about which every turn is a symmetry, if there is one."""
        return next((axis.direction for axis in self.axes if axis.order == ANY), None)

    def _turned(self, pose: Pose, S: Floats) -> Pose:
        return Pose(pose.R @ S, pose.of(self.center[None])[0] - pose.R @ S @ self.center)


def _joined(names: list[str]) -> str:
    if len(names) > 4:
        return f"{len(names)} axes ({', '.join(names[:3])}, ...)"
    return ", ".join(names[:-1]) + (" and " if len(names) > 1 else "") + names[-1]


def _candidate_axes(surface: Surface) -> Floats:
    """Principal axes, directions of faces, of corners and of pairs of them, (n, 3), unit."""
    points, of = surface.samples(4000)
    points = points - surface.center
    principal = np.linalg.eigh(points.T @ points)[1].T
    # Exact ones first: an axis that is near an earlier one is left out.
    found: list[Floats] = []
    # Faces: normals by their area, the largest first.
    normals, areas = surface.normals, surface.areas.copy()
    for _ in range(12):
        i = int(np.argmax(areas))
        if areas[i] <= 0:
            break
        group = normals @ normals[i] > 0.99
        if areas[group].sum() > 0.02 * surface.areas.sum():
            found.append(normals[i])
        areas[group] = 0
    faces = found[:]
    # Corners: what is farthest from the centre.
    nodes = np.unique(np.round(surface.corners.reshape(-1, 3), 9), axis=0) - surface.center
    size = np.linalg.norm(nodes, axis=1)
    far = nodes[size > 0.97 * size.max()]
    if len(far) <= 24:
        found += list(far)
        found += [a + b for i, a in enumerate(far) for b in far[:i] if np.linalg.norm(a + b) > 0.3 * size.max()]
    found += [a + b for i, a in enumerate(faces) for b in faces[:i] if np.linalg.norm(a + b) > 0.3]
    found += list(principal)
    unique: list[Floats] = []
    for axis in found:
        axis = axis / np.linalg.norm(axis)
        if all(abs(axis @ other) < 0.9995 for other in unique):
            unique.append(axis)
    return np.array(unique)


def _is_symmetry(surface: Surface, points: Floats, R: Floats) -> bool:
    turned = (points - surface.center) @ R.T + surface.center
    limit = TOLERANCE * surface.largest_side
    few = turned[:: max(1, len(turned) // 40)]
    for chosen in (few, turned):
        if np.linalg.norm(surface.closest(chosen)[0] - chosen, axis=1).max() > limit:
            return False
    return True


def _name(direction: Floats, surface: Surface) -> str:
    """By the axis of O that it follows, and by the object's length."""
    along = int(np.argmax(np.abs(direction)))
    if abs(direction[along]) < 0.999:
        return "(" + " ".join(f"{value:.2f}" for value in np.round(direction, 2) + 0.0) + ")"
    order = np.argsort(-surface.sides)
    if along == order[0] and surface.sides[order[0]] > 1.1 * surface.sides[order[1]]:
        return f"its long axis ({'xyz'[along]})"
    if along == order[2] and surface.sides[order[2]] < 0.9 * surface.sides[order[1]]:
        return f"its short axis ({'xyz'[along]})"
    return f"{'xyz'[along]}"


def find_symmetries(surface: Surface) -> Symmetries:
    """Tries turns about candidate axes through the centre and completes the group.

    A solid's axes of symmetry pass through its centre of volume and are principal axes or join it
    to middles of faces, edges or corners; these are the candidates.
    """
    points = surface.samples(SAMPLES, seed=1)[0]
    corners = np.unique(surface.corners.reshape(-1, 3), axis=0)
    points = np.concatenate([points, corners[:: max(1, len(corners) // SAMPLES)]])
    axes = []
    for direction in _candidate_axes(surface):
        holds = [n for n in (*ORDERS, ANY) if _is_symmetry(surface, points, exp_rotation(2 * np.pi / n * direction))]
        if holds:
            axes.append(Axis(direction, max(holds), _name(direction, surface)))
    axes.sort(key=lambda axis: (-axis.order, axis.name.startswith("(")))
    group = np.eye(3)[None]
    generators = [exp_rotation(2 * np.pi / axis.order * axis.direction) for axis in axes]
    tried = 0
    while tried < len(group) < MOST:
        for S in generators:
            new = group[tried] @ S
            if (np.tensordot(group, new) < 3 - 1e-4).all():  # traces of new and each old one transposed
                group = np.concatenate([group, new[None]])
        tried += 1
    return Symmetries(group[:MOST], axes, surface.center)
