"""The parts of palpated's configuration that a registration needs."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Optional

import numpy as np
import yaml
from numpy.typing import NDArray

from registration.errors import InputError
from registration.mesh_files import read_surface
from registration.pose import Pose, from_quaternion, from_roll_pitch_yaw
from registration.surface import Surface, box_surface

Floats = NDArray[np.float64]
DEEPEST = 16  # files that name each other as their base
SIZE = (0.001, 10.0)  # m, of an edge of the box
FILTER = "pose_wrench_filter"  # the estimator that has a prior of the pose


@dataclass(frozen=True, eq=False)
class Configuration:
    """Of one file and those that it is based on."""

    path: Path
    surface: Surface
    object_in_base: Optional[Pose]  # as configured
    grasp: Optional[Floats]  # (3,), m, in O: where the hand holds the object
    fixed: Optional[tuple[Floats, Floats]]  # m, in O: corners of the box of the clamped nodes
    component: str  # of `estimation`
    pose_position_deviation: float  # m, as configured or the default
    pose_rotation_deviation: float  # rad


class _Entry:
    """A value with the file and line that state it."""

    def __init__(self, path: Path, line: int, key: str, value: Any) -> None:
        self.path, self.line, self.key, self.value = path, line, key, value

    def wrong(self, allowed: str) -> InputError:
        return InputError(f"{self.path}:{self.line}: {self.key}: {self.value!r}; allowed: {allowed}")

    def numbers(self, count: int, low: float, high: float) -> Floats:
        """A list of that many numbers within the range."""
        allowed = f"{count} numbers, {low:g} to {high:g}"
        try:
            # PyYAML takes 30e3 for text.
            values = np.array([float(value) for value in self.value])
        except (TypeError, ValueError):
            raise self.wrong(allowed) from None
        if len(values) != count or not ((low <= values) & (values <= high)).all():
            raise self.wrong(allowed)
        return values

    def number(self, low: float, high: float) -> float:
        """One number within the range."""
        return float(_Entry(self.path, self.line, self.key, [self.value]).numbers(1, low, high)[0])


def _flattened(path: Path, node: yaml.Node, prefix: str, into: dict[str, _Entry]) -> None:
    """Adds the leaves of a YAML node by their dotted keys."""
    if isinstance(node, yaml.MappingNode):
        for key, value in node.value:
            _flattened(path, value, f"{prefix}.{key.value}".lstrip("."), into)
        return
    value: Any = yaml.safe_load(yaml.serialize(node))
    into[prefix] = _Entry(path, node.start_mark.line + 1, prefix, value)


def _entries(path: Path, depth: int = 0) -> dict[str, _Entry]:
    if depth > DEEPEST:
        raise InputError(f"{path}: base: more than {DEEPEST} files deep")
    try:
        root = yaml.compose(path.read_text(encoding="utf-8"), Loader=yaml.SafeLoader)
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from error
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        mark = getattr(error, "problem_mark", None)
        raise InputError(f"{path}{f':{mark.line + 1}' if mark else ''}: {getattr(error, 'problem', None) or error}") from error
    if not isinstance(root, yaml.MappingNode):
        raise InputError(f"{path}: is not a section of keys")
    own: dict[str, _Entry] = {}
    _flattened(path, root, "", own)
    base = own.pop("base", None)
    if base is None:
        return own
    result = _entries(path.parent / str(base.value), depth + 1)
    for key, entry in own.items():
        # Of keys that exclude each other, the one of the changing file counts.
        for other in _EXCLUDING.get(key, ()):
            result = {name: old for name, old in result.items() if not name.startswith(other)}
        if entry.value is None:  # `key: ~` removes what the base states
            result = {name: old for name, old in result.items() if name != key and not name.startswith(f"{key}.")}
        else:
            result[key] = entry
    return result


_ORIENTATION = "frames.object_in_base."
_EXCLUDING = {
    "object.mesh.file": ("object.mesh.box",),
    "object.mesh.box.size": ("object.mesh.file",),
    _ORIENTATION + "quaternion": (_ORIENTATION + "rpy_deg",),
    _ORIENTATION + "rpy_deg": (_ORIENTATION + "quaternion",),
}


def _pose(entries: dict[str, _Entry], key: str) -> Optional[Pose]:
    position = entries.get(f"{key}.position")
    q, rpy = entries.get(f"{key}.quaternion"), entries.get(f"{key}.rpy_deg")
    if position is None and q is None and rpy is None:
        return None
    p = np.zeros(3) if position is None else position.numbers(3, -100, 100)
    if q is not None:
        values = q.numbers(4, -1.001, 1.001)
        if abs(np.linalg.norm(values) - 1) > 1e-3:
            raise q.wrong("a unit quaternion, w first")
        return Pose(from_quaternion(values / np.linalg.norm(values)), p)
    return Pose(np.eye(3) if rpy is None else from_roll_pitch_yaw(rpy.numbers(3, -360, 360)), p)


def _surface(path: Path, entries: dict[str, _Entry]) -> Surface:
    size, file = entries.get("object.mesh.box.size"), entries.get("object.mesh.file")
    if (size is None) == (file is None):
        raise InputError(f"{path}: object.mesh: exactly one of box.size and file is needed")
    if size is not None:
        return box_surface(size.numbers(3, *SIZE))
    assert file is not None
    return read_surface(file.path.parent / str(file.value))


def _box(entries: dict[str, _Entry], key: str) -> Optional[tuple[Floats, Floats]]:
    lower, upper = entries.get(f"{key}.lower"), entries.get(f"{key}.upper")
    if lower is None or upper is None:
        return None
    return lower.numbers(3, -100, 100), upper.numbers(3, -100, 100)


def _grasp(entries: dict[str, _Entry]) -> Optional[Floats]:
    at_rest = entries.get("object.grasp_at_rest.position")
    if at_rest is not None:
        return at_rest.numbers(3, -100, 100)
    box = _box(entries, "object.grasp_box")
    return None if box is None else 0.5 * (box[0] + box[1])


def read_configuration(path: Path) -> Configuration:
    """Raises InputError with file, line, key, value and what is allowed."""
    entries = _entries(path)
    component = entries.get("estimation.component")

    def deviation(name: str, default: float, high: float) -> float:
        entry = entries.get(f"estimation.{name}")
        return default if entry is None else entry.number(1e-6, high)

    return Configuration(
        path,
        _surface(path, entries),
        _pose(entries, "frames.object_in_base"),
        _grasp(entries),
        _box(entries, "object.fixed_box"),
        "" if component is None else str(component.value),
        deviation("pose_position_deviation", 0.001, 0.1),
        deviation("pose_rotation_deviation", 0.009, 1.0),
    )
