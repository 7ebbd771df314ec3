"""Scenes of palpate-sim (sim/scenes) as palpate-world reads them: a YAML file, the files that it
names as its `base`, and overrides. Keys that a world cannot represent are rejected, never ignored.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Optional

import numpy as np
from obstacles import Obstacle
from rigid import Floats, Pose
from scene_obstacles import read_obstacles
from scene_reader import Box, Reader, load, merged, override

SOURCE = Path(__file__).resolve().parents[3]
SENSORS = SOURCE / "sim/sensors/sensors.yaml"


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
    obstacles: tuple[Obstacle, ...]

    @property
    def duration(self) -> Optional[float]:
        """Of the motion, s; None if the arm obeys commands."""
        if not self.legs:
            return None
        return self.start_delay + sum(leg.move + leg.hold for leg in self.legs)


def _read_object(reader: Reader) -> ObjectOptions:
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


def _read_legs(reader: Reader) -> tuple[float, tuple[Leg, ...]]:
    legs = []
    for index, item in enumerate(reader.items("poses")):
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
    document = load(file)
    for text in overrides:
        override(document, text)
    root = Reader(file, document)
    bus = root.section("bus", optional=True)
    access = root.section("access", optional=True)
    robot = root.section("robot")
    frames = robot.section("frames", optional=True)
    hand = robot.section("initial_hand", optional=True)
    sensors = load(SENSORS)
    start_delay: float = 0.0
    legs: tuple[Leg, ...] = ()
    if root.has("motion"):
        start_delay, legs = _read_legs(root.section("motion"))
    body = _read_object(root.section("object"))
    obstacles = root.items("obstacles") if root.has("obstacles") else []
    scene = Scene(
        file,
        int(root.number("seed", 0, 2**31 - 1, 1)),
        bus.value("control", "udpm://239.255.76.67:7667?ttl=0"),
        bus.value("housekeeping", "udpm://239.255.76.68:7668?ttl=0"),
        Path(access.value("key_file")) if access.has("key_file") else None,
        body,
        Path(robot.value("urdf")),
        robot.numbers("initial_joints", None),
        {name: hand.number(name, -7, 7) for name in document["robot"].get("initial_hand", {})},
        {name: frames.value(name, name) for name in ("flange", "sensor", "imu")},
        robot.pose("grasp_in_flange"),
        merged(sensors, root.value("sensors", {})),
        start_delay,
        legs,
        read_obstacles(obstacles, body.pose.inverse()),
    )
    for reader in (bus, access, frames, hand, robot, root):
        reader.end()
    return scene
