"""Reads a scene's YAML file, the files that it names as its `base`, and overrides, key by key. Keys
that nothing reads are rejected, never ignored.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Optional

import numpy as np
import yaml
from rigid import Floats, Pose
from scipy.spatial.transform import Rotation

# Keys that change only palpate-sim's own discretisation, or what no world has.
_WITHOUT_EFFECT = {
    "bus.pictures",
    "object.elements",
    "object.grading",
    "object.damping",
    "object.viscosity",
    "object.pads",
}


class SceneError(ValueError):
    """A wrong scene: file, key, value and what is allowed."""


@dataclass(frozen=True)
class Box:
    """Axis-aligned, in O at rest, m; closed at both ends."""

    lower: Floats
    upper: Floats

    def contains(self, points: Floats) -> Any:
        """(n,) whether each point lies inside or within 1 um."""
        return ((points >= self.lower - 1e-6) & (points <= self.upper + 1e-6)).all(axis=-1)


def merged(base: Any, over: Any) -> Any:
    """`over` on top of `base`: mappings entry by entry, everything else as a whole."""
    if not (isinstance(base, dict) and isinstance(over, dict)):
        return over
    return {**base, **{key: merged(base.get(key), value) for key, value in over.items()}}


def load(file: Path) -> dict[str, Any]:
    try:
        document = yaml.safe_load(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise SceneError(f"{file}: {error.strerror}") from None
    except yaml.YAMLError as error:
        raise SceneError(f"{file}: {error}") from None
    if not isinstance(document, dict):
        raise SceneError(f"{file}: is not a mapping of keys")
    for section, key in (("robot", "urdf"), ("object", "mesh"), ("access", "key_file")):
        entries = document.get(section)
        if isinstance(entries, dict) and isinstance(entries.get(key), str):
            entries[key] = str(file.parent / entries[key])  # relative to the file that names it
    base = document.pop("base", None)
    return document if base is None else merged(load(file.parent / base), document)


def override(document: dict[str, Any], text: str) -> None:
    path, equals, value = text.partition("=")
    if not equals:
        raise SceneError(f"--set {text}: expected path.to.key=value")
    *sections, last = path.split(".")
    place = document
    for section in sections:
        place = place.setdefault(section, {})
        if not isinstance(place, dict):
            raise SceneError(f"--set {text}: {section} is not a mapping of keys")
    if value == "~":
        place.pop(last, None)
    else:
        place[last] = yaml.safe_load(value)


class Reader:
    """Reads keys of a mapping and remembers which; the rest is rejected at the end."""

    def __init__(self, file: Path, entries: Any, path: str = "") -> None:
        if not isinstance(entries, dict):
            raise SceneError(f"{file}: {path or 'the scene'}: is not a mapping of keys")
        self._file, self._entries, self._path = file, entries, path
        self._used: set[str] = set()

    def fail(self, key: str, why: str) -> SceneError:
        place = f"{self._path}.{key}" if self._path else key
        return SceneError(f"{self._file}: {place}: {why}")

    def has(self, key: str) -> bool:
        return key in self._entries

    def value(self, key: str, default: Any = None) -> Any:
        self._used.add(key)
        if key in self._entries:
            return self._entries[key]
        if default is None:
            raise self.fail(key, "is missing")
        return default

    def section(self, key: str, optional: bool = False) -> "Reader":
        path = f"{self._path}.{key}" if self._path else key
        return Reader(self._file, self.value(key, {} if optional else None), path)

    def items(self, key: str) -> list["Reader"]:
        """Of a list of mappings."""
        entries = self.value(key)
        if not isinstance(entries, list):
            raise self.fail(key, f"{entries!r} is not a list")
        path = f"{self._path}.{key}" if self._path else key
        return [Reader(self._file, item, f"{path}.{index}") for index, item in enumerate(entries)]

    def number(self, key: str, low: float, high: float, default: Any = None) -> float:
        value = self.value(key, default)
        if isinstance(value, str):  # YAML 1.1 reads 30e3 as text
            try:
                value = float(value)
            except ValueError:
                pass
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise self.fail(key, f"{value!r} is not a number")
        if not low <= value <= high:
            raise self.fail(key, f"{value!r} is out of range; allowed: {low:g} to {high:g}")
        return float(value)

    def numbers(self, key: str, count: Optional[int], default: Any = None) -> Floats:
        value = self.value(key, default)
        try:
            numbers = np.array([float(x) for x in value])
        except (TypeError, ValueError):
            raise self.fail(key, f"{value!r} is not a list of numbers") from None
        if count is not None and len(numbers) != count:
            raise self.fail(key, f"has {len(numbers)} numbers; allowed: {count}")
        return numbers

    def box(self, key: str) -> Box:
        part = self.section(key)
        box = Box(part.numbers("lower", 3), part.numbers("upper", 3))
        part.end()
        return box

    def pose(self, key: str, optional: bool = False) -> Pose:
        part = self.section(key, optional)
        angles = part.numbers("rpy_deg", 3, [0, 0, 0])
        position = part.numbers("position", 3, [0, 0, 0])
        part.end()
        return Pose(Rotation.from_euler("xyz", angles, degrees=True).as_matrix(), position)

    def end(self) -> None:
        """Raises SceneError if the mapping has keys that have not been read."""
        for key in self._entries:
            path = f"{self._path}.{key}" if self._path else key
            if key not in self._used and path not in _WITHOUT_EFFECT:
                raise self.fail(key, "palpate-world does not support this key; palpate-sim may")
