"""Scenes of palpate-sim (sim/scenes) as palpate-world reads them: a YAML file, the files that it
names as its `base`, and overrides. Keys that a world cannot represent are rejected, never ignored.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Optional

import numpy as np
import yaml
from rigid import Floats, Pose
from scipy.spatial.transform import Rotation

SOURCE = Path(__file__).resolve().parents[3]
SENSORS = SOURCE / "sim/sensors/sensors.yaml"

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


@dataclass(frozen=True)
class Leg:
    """A pose of the grasp relative to the first one, in O, and how it is reached."""

    name: str
    move: float  # s
    hold: float  # s
    translation: Floats  # m
    rotation: Floats  # rotation vector, rad


@dataclass(frozen=True)
class ObjectOptions:
    """The soft object: a box with a corner in O, or a mesh of tetrahedra."""

    size: Optional[Floats]  # m
    mesh: Optional[Path]  # .msh, in O
    young_modulus: float  # Pa
    poisson_ratio: float
    density: float  # kg/m^3
    pose: Pose  # X_WO
    clamp_box: Box
    grasp_box: Box
    gravity: bool


@dataclass(frozen=True)
class Scene:
    """What palpate-world needs of a scene."""

    file: Path
    seed: int
    control_url: str
    housekeeping_url: str
    key_file: Optional[Path]
    body: ObjectOptions
    urdf: Path
    initial_joints: Floats  # rad
    initial_hand: dict[str, float]  # rad
    frames: dict[str, str]  # links that are E (flange), S (sensor) and I (imu)
    X_EG: Pose
    sensors: dict[str, Any]  # sim/sensors/sensors.yaml with the scene's entries
    start_delay: float  # s
    legs: tuple[Leg, ...]  # empty: the arm obeys commands

    @property
    def duration(self) -> Optional[float]:
        """Of the motion, s; None if the arm obeys commands."""
        if not self.legs:
            return None
        return self.start_delay + sum(leg.move + leg.hold for leg in self.legs)


def merged(base: Any, over: Any) -> Any:
    """`over` on top of `base`: mappings entry by entry, everything else as a whole."""
    if not (isinstance(base, dict) and isinstance(over, dict)):
        return over
    return {**base, **{key: merged(base.get(key), value) for key, value in over.items()}}


def _load(file: Path) -> dict[str, Any]:
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
    return document if base is None else merged(_load(file.parent / base), document)


def _override(document: dict[str, Any], text: str) -> None:
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


class _Reader:
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

    def section(self, key: str, optional: bool = False) -> "_Reader":
        path = f"{self._path}.{key}" if self._path else key
        return _Reader(self._file, self.value(key, {} if optional else None), path)

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


def _read_object(reader: _Reader) -> ObjectOptions:
    if reader.value("kind", "hyperelastic") != "hyperelastic":
        raise reader.fail("kind", "allowed: hyperelastic, which a world replaces by its own")
    mesh = Path(reader.value("mesh")) if reader.has("mesh") else None
    size = reader.numbers("size", 3) if reader.has("size") else None
    if mesh is None and size is None:
        raise reader.fail("size", "is missing; or mesh, a .msh file")
    material = reader.section("material")
    options = ObjectOptions(
        size,
        mesh,
        material.number("young_modulus", 1, 1e9),
        material.number("poisson_ratio", 0, 0.49),
        material.number("density", 1, 2e4),
        reader.pose("pose"),
        reader.box("clamp_box"),
        reader.box("grasp_box"),
        bool(reader.value("gravity", True)),
    )
    material.end()
    reader.end()
    return options


def _read_legs(reader: _Reader, file: Path) -> tuple[float, tuple[Leg, ...]]:
    legs = []
    for index, entries in enumerate(reader.value("poses")):
        item = _Reader(file, entries, f"motion.poses.{index}")
        legs.append(
            Leg(
                str(item.value("name", f"pose {index + 1}")),
                item.number("move", 0.01, 600),
                item.number("hold", 0, 3600),
                item.numbers("translation", 3, [0, 0, 0]),
                np.radians(item.numbers("rotation_deg", 3, [0, 0, 0])),
            )
        )
        item.end()
    delay = reader.number("start_delay", 0, 3600, 1)
    reader.end()
    return delay, tuple(legs)


def read_scene(file: Path, overrides: list[str]) -> Scene:
    """Raises SceneError."""
    document = _load(file)
    for text in overrides:
        _override(document, text)
    root = _Reader(file, document)
    bus = root.section("bus", optional=True)
    access = root.section("access", optional=True)
    robot = root.section("robot")
    frames = robot.section("frames", optional=True)
    hand = robot.section("initial_hand", optional=True)
    sensors = _load(SENSORS)
    start_delay: float = 0.0
    legs: tuple[Leg, ...] = ()
    if root.has("motion"):
        start_delay, legs = _read_legs(root.section("motion"), file)
    scene = Scene(
        file,
        int(root.number("seed", 0, 2**31 - 1, 1)),
        bus.value("control", "udpm://239.255.76.67:7667?ttl=0"),
        bus.value("housekeeping", "udpm://239.255.76.68:7668?ttl=0"),
        Path(access.value("key_file")) if access.has("key_file") else None,
        _read_object(root.section("object")),
        Path(robot.value("urdf")),
        robot.numbers("initial_joints", None),
        {name: hand.number(name, -7, 7) for name in document["robot"].get("initial_hand", {})},
        {name: frames.value(name, name) for name in ("flange", "sensor", "imu")},
        robot.pose("grasp_in_flange"),
        merged(sensors, root.value("sensors", {})),
        start_delay,
        legs,
    )
    for reader in (bus, access, frames, hand, robot, root):
        reader.end()
    return scene
