"""Poses as recordings write them: quaternions in either order, rotation vectors, matrices, joint angles."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Callable, NoReturn, Optional

import numpy as np
from numpy.typing import NDArray

from palpate_common.input_error import InputError
from palpate_common.joint_tree import JointTree, read_joint_tree
from palpate_common.rotations import exp_rotations, from_wxyz, to_wxyz
from palpate_common.section import Section
from palpate_import.chain import chain_motion
from palpate_import.input_values import Names, Rows, Value, column_of, expanded, value_of
from palpate_import.units import Dimension

Floats = NDArray[np.float64]
FORMS = ("quaternion", "rotation_vector", "rpy_deg", "matrix", "joints")
_COUNTS = {"quaternion": 4, "rotation_vector": 3, "rpy_deg": 3, "matrix": 16}
_DIMENSIONS = {
    "quaternion": Dimension.NONE,
    "rotation_vector": Dimension.ANGLE,
    "rpy_deg": Dimension.NONE,
    "joints": Dimension.ANGLE,
}
ROTATION_TOLERANCE = 1e-3  # of R^T R - 1, and of the squared length of a quaternion, as the messages' readers have it


@dataclass
class Poses:
    """quaternion: (n, 4), w first; None where the form has it as a matrix. velocity: (n, 6), of a form of joints with their
    speeds: linear, angular, of the flange. offset: (n, 3), from what is recorded to the flange's origin, in the base's axes; None:
    zero."""

    position: Floats
    quaternion: Optional[Floats]
    rotation: Optional[Floats] = None
    velocity: Optional[Floats] = None
    offset: Optional[Floats] = None

    def R(self) -> Floats:
        """(n, 3, 3)."""
        if self.rotation is not None:
            return self.rotation
        assert self.quaternion is not None
        return from_wxyz(self.quaternion)

    def wxyz(self) -> Floats:
        """(n, 4)."""
        return self.quaternion if self.quaternion is not None else to_wxyz(self.R())


@dataclass
class PoseForm:
    """One way to write a pose. entries: texts as of a field: column, unit, sign, or constant."""

    kind: str
    entries: list[str]
    position: list[str]
    order: str
    section: Section
    tree: Optional[JointTree] = None
    flange: str = ""
    in_flange: Optional["PoseForm"] = None  # pose of what is recorded in the flange
    speeds: list[str] = field(default_factory=list)

    @property
    def columns(self) -> list[str]:
        """All that a table must have."""
        own = [column for text in [*self.entries, *self.position, *self.speeds] if (column := column_of(text)) is not None]
        return own + (self.in_flange.columns if self.in_flange else [])

    def _values(self, texts: list[str], dimension: Dimension, names: Names) -> list[Value]:
        try:
            return [value_of(text, dimension, names) for text in texts]
        except InputError as error:
            raise InputError(f"{self.section.path}: {error}", error.exit_code) from error

    def _position_values(self, names: Names) -> list[Value]:
        return self._values(self.position, Dimension.LENGTH, names)

    def poses(self, names: Names, rows: Rows, place: Callable[[int], str]) -> Poses:
        """(n,) poses of the flange. place(row) names a row in messages. Raises InputError for what is no rotation."""
        made = self._recorded(names, rows, place)
        if self.in_flange is None:
            return made
        inner = self.in_flange.poses(names, rows, place)
        R = made.R() @ np.swapaxes(inner.R(), -1, -2)
        offset = -np.einsum("nij,nj->ni", R, inner.position)
        velocity = made.velocity
        if velocity is not None:
            velocity = np.hstack([velocity[:, :3] + np.cross(velocity[:, 3:], offset), velocity[:, 3:]])
        return Poses(made.position + offset, None, R, velocity, offset)

    def _recorded(self, names: Names, rows: Rows, place: Callable[[int], str]) -> Poses:
        if self.kind == "joints":
            return self._of_joints(names, rows)
        if self.kind == "matrix":
            return self._of_matrix(names, rows, place)
        position = stacked(self._position_values(names), rows)
        numbers = stacked(self._values(self.entries, _DIMENSIONS[self.kind], names), rows)
        if self.kind == "quaternion":
            quaternion = numbers if self.order == "wxyz" else np.ascontiguousarray(numbers[:, [3, 0, 1, 2]])
            check_quaternions(quaternion, place)
            return Poses(position, quaternion)
        if self.kind == "rotation_vector":
            half = 0.5 * np.linalg.norm(numbers, axis=1, keepdims=True)
            return Poses(position, np.hstack([np.cos(half), 0.5 * np.sinc(half / np.pi) * numbers]))
        roll, pitch, yaw = (exp_rotations(np.radians(numbers[:, i, None]) * np.eye(3)[i]) for i in range(3))
        return Poses(position, None, yaw @ pitch @ roll)

    def _of_matrix(self, names: Names, rows: Rows, place: Callable[[int], str]) -> Poses:
        dimensions = np.full((4, 4), Dimension.NONE)
        dimensions[:3, 3] = Dimension.LENGTH
        in_order = (dimensions if self.order == "row_major" else dimensions.T).ravel()
        values = [self._values([text], dimension, names)[0] for text, dimension in zip(self.entries, in_order)]
        matrices = stacked(values, rows).reshape(-1, 4, 4)
        if self.order == "column_major":
            matrices = np.swapaxes(matrices, 1, 2)
        R, bottom = matrices[:, :3, :3], matrices[:, 3]
        error = np.abs(np.swapaxes(R, 1, 2) @ R - np.eye(3)).max(axis=(1, 2)) if len(R) else np.zeros(0)
        wrong = np.flatnonzero((error > ROTATION_TOLERANCE) | (np.linalg.det(R) < 0)
                               | (np.abs(bottom - [0, 0, 0, 1]).max(axis=1) > ROTATION_TOLERANCE))  # fmt: skip
        if wrong.size:
            raise InputError(f"{place(wrong[0])}: the matrix {np.round(matrices[wrong[0]], 4).tolist()} is no pose; allowed: a rotation, "
                             f"a position, a last row 0 0 0 1; the order is {self.order}")  # fmt: skip
        return Poses(np.ascontiguousarray(matrices[:, :3, 3]), None, np.ascontiguousarray(R))

    def _of_joints(self, names: Names, rows: Rows) -> Poses:
        assert self.tree is not None
        q = stacked(self._values(self.entries, Dimension.ANGLE, names), rows)
        dq = stacked(self._values(self.speeds, Dimension.ANGULAR_SPEED, names), rows) if self.speeds else None
        position, rotation, velocity = chain_motion(self.tree, self.flange, q, dq)
        return Poses(position, None, rotation, velocity)


def stacked(values: list[Value], rows: Rows) -> Floats:
    """(n, values), SI."""
    return np.array([value.of(rows) for value in values], float).reshape(len(values), rows.count).T


def check_quaternions(quaternions: Floats, place: Callable[[int], str]) -> None:
    """Raises InputError for one that is not of unit length."""
    squared = (quaternions**2).sum(axis=1)
    wrong = np.flatnonzero(~(np.abs(squared - 1) <= ROTATION_TOLERANCE))
    if wrong.size:
        raise InputError(f"{place(wrong[0])}: the quaternion is not of unit length: {np.sqrt(squared[wrong[0]]):.4g}")


def _texts(section: Section, key: str) -> list[str]:
    """Columns, or numbers as constants, of a list or of one text with a range."""
    raw: Any = section.raw(key)
    items = raw if isinstance(raw, list) else [raw]
    texts = []
    for item in items:
        is_constant = isinstance(item, (int, float)) and not isinstance(item, bool)
        texts += [f"={item!r}"] if is_constant else expanded(str(item))
    return texts


def _fail_count(section: Section, key: str, texts: list[str], count: int) -> NoReturn:
    section.fail(key, f"{len(texts)} entries; allowed: {count} columns or numbers, or one text such as q[{{0..{count - 1}}}]")


def read_form(section: Section, folder: Path, urdf: Optional[Path], flange: str) -> PoseForm:
    """urdf, flange: of the command line, where the section has none. Raises InputError."""
    given = [kind for kind in FORMS if section.has(kind)]
    if len(given) != 1:
        section.fail(
            given[1] if given else FORMS[0], f"{', '.join(given) or 'nothing'} is given; allowed: one of {', '.join(FORMS)}"
        )
    kind = given[0]
    orders = ["column_major", "row_major"] if kind == "matrix" else ["wxyz", "xyzw"]
    form = PoseForm(kind, _texts(section, kind), [], "", section)
    if kind in ("quaternion", "matrix"):
        form.order = section.choice("order", orders, orders[0])
    if kind == "joints":
        file = section.text("urdf", "")
        form.flange = section.text("flange", flange)
        if section.has("speeds"):
            form.speeds = _texts(section, "speeds")
        path = folder / file if file else urdf
        if path is None or not form.flange:
            section.fail(
                "joints",
                "needs a URDF file and the link of the flange; remedy: --urdf and --flange, or the keys urdf and flange",
            )
        form.tree = read_joint_tree(path)
        free = form.tree.arm_joints(form.flange)
        for key, texts in (("joints", form.entries), ("speeds", form.speeds or form.entries)):
            if len(texts) != len(free):
                section.fail(key, f"{len(texts)} entries; allowed: {len(free)}, of {', '.join(free)} in {path}")
    elif len(form.entries) != _COUNTS[kind]:
        _fail_count(section, kind, form.entries, _COUNTS[kind])
    if kind not in ("matrix", "joints"):
        form.position = _texts(section, "position") if section.has("position") else ["=0.0"] * 3
        if len(form.position) != 3:
            _fail_count(section, "position", form.position, 3)
    if section.has("in_flange"):
        form.in_flange = read_form(section.section("in_flange"), folder, urdf, flange)
    section.check_unused()
    return form
