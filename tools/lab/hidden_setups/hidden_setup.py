"""Draws a set-up whose errors only the simulator and the scoring know: changes of a scene, and the truth."""

from __future__ import annotations

import json
import os
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Optional

import numpy as np
import yaml
from distribution import Distribution, Floats, Range, SensorErrors, read_distribution
from payload import Links, payload_of

from palpate_common.frames import rotation_and_position
from palpate_common.pose import Pose, random_rotations
from palpate_common.rotations import exp_rotation, log_rotation, to_rpy, to_wxyz
from palpate_common.section import Section, read_configuration_section

SOURCE = Path(__file__).resolve().parents[3]
# What sim/sensors/sensors.yaml states of the delay until a message arrives: a late stamp is written at the arrival.
ARRIVAL = {"force_torque": 0.001, "imu": 0.003, "camera": 0.06}


@dataclass(frozen=True, eq=False)
class HiddenSetup:
    """changes: of the scene, as nested mappings. truth: as truth.json."""

    scene: Path
    changes: dict[str, Any]
    truth: dict[str, Any]

    def write(self, folder: Path) -> None:
        """scene.yaml, for palpate-sim alone, and truth.json, for the scoring alone. Raises OSError."""
        folder.mkdir(parents=True, exist_ok=True)
        document = {"base": os.path.relpath(self.scene.resolve(), folder.resolve()), **self.changes}
        header = "# A drawn set-up: what it states is hidden from every program but palpate-sim.\n"
        (folder / "scene.yaml").write_text(header + yaml.safe_dump(document, sort_keys=False, width=120))
        (folder / "truth.json").write_text(json.dumps(self.truth, indent=1) + "\n")


class _Draws:
    """Numbers of one seed, each from a stream of its own name: a parameter more changes no other."""

    def __init__(self, seed: int) -> None:
        self._seed = seed
        self.drawn: list[dict[str, Any]] = []

    def stream(self, name: str) -> np.random.Generator:
        return np.random.default_rng([self._seed, zlib.crc32(name.encode())])

    def note(self, name: str, unit: str, value: float, limits: Range) -> float:
        self.drawn.append({"name": name, "unit": unit, "value": value, "lower": limits[0], "upper": limits[1]})
        return value

    def uniform(self, name: str, unit: str, limits: Range) -> float:
        return self.note(name, unit, float(self.stream(name).uniform(*limits)), limits)

    def log_uniform(self, name: str, unit: str, limits: Range) -> float:
        return self.note(name, unit, float(np.exp(self.stream(name).uniform(*np.log(limits)))), limits)

    def vector(self, name: str, unit: str, lower: Floats, upper: Floats) -> Floats:
        return np.array([self.uniform(f"{name} {axis}", unit, (float(a), float(b)))
                         for axis, a, b in zip("xyz", lower, upper)])  # fmt: skip

    def direction(self, name: str) -> Floats:
        way: Floats = self.stream(name).normal(size=3)
        return way / float(np.linalg.norm(way))

    def turn(self, name: str, most: float) -> Floats:
        """Rotation vector, rad: any axis, an angle up to `most`."""
        angle = self.stream(name).uniform(0, most)
        self.note(f"{name}, angle", "rad", float(angle), (0.0, most))
        return float(angle) * self.direction(f"{name}, axis")


def draw_setup(scene: Path, distribution: str, seed: int) -> HiddenSetup:
    """The set-up of a seed, of a scene of palpate-sim. Raises InputError."""
    top, of = read_configuration_section(scene), read_distribution(distribution)
    draws, changes = _Draws(seed), {"seed": seed}
    truth: dict[str, Any] = {"seed": seed, "distribution": of.name, "scene": _named(scene)}
    _wrist(top, of, draws, changes, truth)
    _object(top.section("object"), of, draws, changes, truth)
    if top.has("camera"):
        _camera(top, of, draws, changes, truth)
    truth["drawn"] = draws.drawn
    return HiddenSetup(scene, changes, truth)


def _named(scene: Path) -> str:
    path = scene.resolve()
    return str(path.relative_to(SOURCE)) if path.is_relative_to(SOURCE) else str(scene)


def _numbers(values: Any) -> list[float]:
    return [float(value) for value in np.asarray(values, float).reshape(-1)]


def _pose(X: Pose) -> dict[str, list[float]]:
    return {"position": _numbers(X.p), "quaternion": _numbers(to_wxyz(X.R))}


def _in_scene(X: Pose, before: Section) -> dict[str, Any]:
    """A pose as a scene states it, over the one that it has."""
    made: dict[str, Any] = {"position": _numbers(X.p), "rpy_deg": _numbers(np.degrees(to_rpy(X.R)))}
    return {**made, "quaternion": None} if before.has("quaternion") else made


def _sensor(name: str, units: tuple[str, str], of: SensorErrors, draws: _Draws, truth: dict[str, Any]) -> dict[str, Any]:
    """Entries of one sensor below `sensors`, and its rotation, (3, 3), as `R`."""
    ones = np.ones(3)
    bias = np.concatenate([draws.vector(f"{name} bias {part}", unit, -most * ones, most * ones)
                           for part, unit, most in zip((1, 2), units, of.bias)])  # fmt: skip
    turn, late = draws.turn(f"{name} mounting", of.angle), draws.uniform(f"{name} stamp delay", "s", of.stamp_delay)
    truth.setdefault("stamp_delay", {})[name] = late
    return {"bias": _numbers(bias), "mounting_rotation_deg": _numbers(np.degrees(turn)), "stamp_delay": late,
            "delay": ARRIVAL[name] + late}  # fmt: skip


def _wrist(top: Section, of: Distribution, draws: _Draws, changes: dict[str, Any], truth: dict[str, Any]) -> None:
    robot = top.section("robot")
    frames = robot.optional("frames")
    links = Links(robot.file_of("urdf").parent / robot.text("urdf"))
    flange, sensor, imu = (frames.text(key, key) for key in ("flange", "sensor", "imu"))
    hand = {name: robot.section("initial_hand").number(name, -7, 7) for name in robot.optional("initial_hand").values}

    factor = draws.uniform("hand mass factor", "", of.hand_mass_factor)
    mass, center = draws.uniform("load mass", "kg", of.load_mass), draws.vector("load center", "m", *of.load_center)
    radii = [draws.uniform(f"load radius {axis}", "m", of.load_radius) for axis in "xyz"]
    axes = random_rotations(draws.stream("load axes"), 1)[0]
    squares = np.square(radii)
    about_center = mass * axes @ np.diag(squares.sum() - squares) @ axes.T
    i = about_center
    changes["robot"] = {
        "hand_mass_factor": factor,
        "load": {"mass": mass, "center_of_mass": _numbers(center),
                 "inertia": _numbers([i[0, 0], i[0, 1], i[0, 2], i[1, 1], i[1, 2], i[2, 2]])},
    }  # fmt: skip
    wrench = _sensor("force_torque", ("N", "N m"), of.force_torque, draws, truth)
    motion = _sensor("imu", ("m/s^2", "rad/s"), of.imu, draws, truth)
    changes["sensors"] = {"force_torque": wrench, "imu": motion}
    truth["bias"], truth["imu_bias"] = wrench["bias"], motion["bias"]
    for key, link, entries in (("sensor_in_flange", sensor, wrench), ("imu_in_flange", imu, motion)):
        R = exp_rotation(np.radians(entries["mounting_rotation_deg"]))
        X = links.pose(link, flange, {})
        if X is None:
            frames.fail(link, f"does not hang on {flange}")
        truth[key] = _pose(Pose(X.R @ R, X.p))
    R_LS = exp_rotation(np.radians(wrench["mounting_rotation_deg"]))
    total = links.payload(sensor, hand).times(factor).plus(payload_of(mass, center, about_center)).turned(R_LS)
    i = total.inertia
    truth["payload"] = {"mass": total.mass, "center_of_mass": _numbers(total.center),
                        "inertia": _numbers([i[0, 0], i[0, 1], i[0, 2], i[1, 1], i[1, 2], i[2, 2]])}  # fmt: skip


def _object(section: Section, of: Distribution, draws: _Draws, changes: dict[str, Any], truth: dict[str, Any]) -> None:
    nominal, center = Pose(*rotation_and_position(section.optional("pose"))), 0.5 * np.array(section.numbers("size", 3, 0, 100))
    ones = of.object_position * np.ones(3)
    middle = nominal.of(center) + draws.vector("object", "m", -ones, ones)
    R = exp_rotation(draws.turn("object", of.object_angle)) @ nominal.R
    X = Pose(R, middle - R @ center)
    material = section.section("material")
    factor = draws.log_uniform("modulus factor", "", (1 / of.modulus_factor, of.modulus_factor))
    modulus = factor * material.number("young_modulus", 1, 1e9)
    changes["object"] = {"pose": _in_scene(X, section.optional("pose")), "material": {"young_modulus": modulus}}
    truth["object_in_base"], truth["young_modulus"] = _pose(X), modulus
    for key, most in (("poisson_ratio", 0.49), ("density", 2e4)):
        truth[key] = material.number(key, 0, most)


def _camera(top: Section, of: Distribution, draws: _Draws, changes: dict[str, Any], truth: dict[str, Any]) -> None:
    section = top.section("camera")
    nominal = nominal_camera(top)
    shift = of.camera_distance * draws.direction("camera")
    X = Pose(exp_rotation(draws.turn("camera", of.camera_angle)) @ nominal.R, nominal.p + shift)
    late = draws.uniform("camera stamp delay", "s", of.camera_stamp_delay)
    pose = _in_scene(X, section.optional("pose"))
    changes["camera"] = {**{key: None for key in ("eye", "target") if section.has(key)}, "pose": pose}
    changes["sensors"]["camera"] = {"stamp_delay": late, "delay": ARRIVAL["camera"] + late}
    truth["camera_in_base"], truth["stamp_delay"]["camera"] = _pose(X), late
    truth["camera_error"] = {"distance": float(np.linalg.norm(shift)),
                             "angle": float(np.linalg.norm(log_rotation(X.R @ nominal.R.T)))}  # fmt: skip


def nominal_camera(top: Section, middle: Optional[Floats] = None) -> Pose:
    """X_WC of a scene's camera: of `pose`, or of `eye` and `target`, by default the object's middle."""
    camera, of_object = top.section("camera"), top.section("object")
    if camera.has("pose"):
        return Pose(*rotation_and_position(camera.section("pose")))
    if middle is None:
        X_WO = Pose(*rotation_and_position(of_object.optional("pose")))
        middle = X_WO.of(0.5 * np.array(of_object.numbers("size", 3, 0, 100)))
    eye, target = (np.array(camera.numbers(key, 3, -20, 20, otherwise)) for key, otherwise in (("eye", None), ("target", _numbers(middle))))
    z = (target - eye) / np.linalg.norm(target - eye)
    x = np.cross(z, [0, 0, 1])
    x /= np.linalg.norm(x)
    return Pose(np.column_stack([x, np.cross(z, x), z]), eye)
