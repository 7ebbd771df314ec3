"""Step object: mesh, clamp, grasp, mass and the controlled point."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

from palpate_common.input_error import InputError
from palpate_common.mesh_files import read_surface
from palpate_common.surface import Surface, box_surface
from palpate_setup.project import Project
from palpate_setup.questions import CHOICE, NUMBER, NUMBERS, TEXT, Question
from palpate_setup.step import Result, Setting, Step, Work

Floats = NDArray[np.float64]
FACES = ("x-", "x+", "y-", "y+", "z-", "z+")
# Nodes of the quadratic mesh: of the loop, in real time, and of the fit, which has no time limit.
LOOP_NODES, FIT_NODES = 200, 650
MESHES = (".msh",)
SURFACES = (".stl", ".obj")
OTHER_SIDE = {face: face[0] + ("+" if face[1] == "-" else "-") for face in FACES}


def cells_of(size: Floats, nodes: int) -> list[int]:
    """Cells along each edge of a box, about cubic, with as many quadratic nodes as possible up to this number."""
    edges = np.geomspace(float(size.max()) / 50, float(size.max()), 400)[:, None]
    cells = np.maximum(1, np.concatenate([np.round(size / edges), np.ceil(size / edges - 1e-9)])).astype(int)
    count = np.prod(2 * cells + 1, axis=1)
    best = cells[np.where(count <= nodes, count, 0).argmax()]
    return [int(number) for number in best] if count.min() <= nodes else [1, 1, 1]


def face_box(lower: Floats, upper: Floats, face: str, depth: float) -> dict[str, list[float]]:
    """Box of the nodes within `depth`, m, of a face of the bounding box."""
    low, high = lower.copy(), upper.copy()
    axis = "xyz".index(face[0])
    if face[1] == "-":
        high[axis] = lower[axis] + depth
    else:
        low[axis] = upper[axis] - depth
    return {"lower": _rounded(low), "upper": _rounded(high)}


def _rounded(values: Any) -> list[float]:
    return [round(float(value), 6) + 0.0 for value in values]


def _is_box(answers: Any) -> bool:
    return bool(answers["mesh"] == "box")


def controlled_point(surface: Surface) -> list[float]:
    """The middle of the upper side, in O."""
    lower, upper = surface.corners.reshape(-1, 3).min(axis=0), surface.corners.reshape(-1, 3).max(axis=0)
    above = np.array([*(0.5 * (lower + upper))[:2], upper[2]])
    return _rounded(surface.closest(above[None])[0][0])


class Object(Step):
    name = "object"
    title = "Object"
    about = "Mesh, what is clamped and what is held, mass, and the point that is controlled."
    needs = ("machine",)

    def questions(self, project: Project) -> list[Question]:
        return [
            Question("mesh", "Mesh: a box, a file (.msh, .stl, .obj), or a scan (a cloud)", CHOICE, default="box",
                     choices=("box", "file", "scan")),
            Question("size", "Edges of the box; its frame O has its origin in a corner, z up", NUMBERS, "m", low=0.001, high=10,
                     when=_is_box),
            Question("file", "Its file, in m", TEXT, when=lambda a: not _is_box(a)),
            Question("edge", "Length that the edges of its tetrahedra should have (empty: by size)", NUMBER, "m", None, 1e-4, 1,
                     when=lambda a: a["mesh"] == "file" and Path(a["file"]).suffix.lower() in SURFACES),
            Question("mass", "Mass of the object, weighed", NUMBER, "kg", low=1e-4, high=1000),
            Question("clamped", "What is clamped: a face of the bounding box in O, a named group of the file (group), or none",
                     CHOICE, default="x-", choices=(*FACES, "group", "none")),
            Question("clamped_group", "Name of the group", TEXT, when=lambda a: a["clamped"] == "group"),
            Question("clamped_depth", "Depth of the clamp from that face on; 0: the face alone", NUMBER, "m", 0.0, 0, 10,
                     when=lambda a: a["clamped"] in FACES),
            Question("held", "Where the hand holds it: a face of the bounding box, or a group", CHOICE, default="x+",
                     choices=(*FACES, "group")),
            Question("held_group", "Name of the group", TEXT, when=lambda a: a["held"] == "group"),
            Question("held_depth", "Depth of the jaws from that face on", NUMBER, "m", 0.05, 1e-4, 10,
                     when=lambda a: a["held"] in FACES),
            Question("grasp", "Origin of the grasp frame in O (empty: the middle of what is held)", NUMBERS, "m", None, -10, 10),
            Question("grasp_stiffness", "Stiffness of the pads between hand and object, together", NUMBER, "N/m", 1e5, 1, 1e9),
            Question("point", "Point that is controlled, at rest in O (empty: the middle of the upper side)", NUMBERS, "m", None, -10, 10),
        ]  # fmt: skip

    def questions_to_skip(self, project: Project) -> list[Question]:
        return self.questions(project)

    def run(self, work: Work) -> Result:
        answers, result = work.answers, Result()
        surface, file = self._mesh(work, result)
        corners = surface.corners.reshape(-1, 3)
        lower, upper = corners.min(axis=0), corners.max(axis=0)
        density = answers["mass"] / surface.volume
        if not 0.1 <= density <= 1e5:
            raise InputError(f"mass: {answers['mass']:g} kg of {1e6 * surface.volume:.4g} cm^3 are {density:.4g} kg/m^3; allowed: 0.1 "
                             "to 100000; the mesh has to be in m")  # fmt: skip
        result.settings += [
            Setting("object.order", "quadratic"),
            Setting("object.gravity", True),
            Setting("object.material.density", round(density, 3),
                    f"{answers['mass']:g} kg, weighed, of {1e6 * surface.volume:.4g} cm^3 of the mesh"),
            Setting("object.grasp_stiffness", answers["grasp_stiffness"], "N/m, of the pads, typed"),
        ]  # fmt: skip
        self._hold(answers, lower, upper, result)
        self._check_apart(answers, lower, upper)
        point = answers["point"] or controlled_point(surface)
        distance = float(np.linalg.norm(surface.closest(np.array(point)[None])[0][0] - point))
        inside = bool((np.array(point) >= lower).all() and (np.array(point) <= upper).all())
        if distance > 0.01 and not inside:
            raise InputError(f"point: {point} is {1e3 * distance:.1f} mm outside the object")
        result.settings += _control(point)
        result.lines += [f"{1e3 * (upper - lower)[0]:.1f} x {1e3 * (upper - lower)[1]:.1f} x {1e3 * (upper - lower)[2]:.1f} mm, "
                         f"{1e6 * surface.volume:.4g} cm^3, {density:.4g} kg/m^3",
                         f"controlled point {point} in O"]  # fmt: skip
        result.data.update(point=point, volume=surface.volume, density=density, file=file)
        return result

    def skip(self, work: Work) -> Result:
        return self.run(work)

    def _mesh(self, work: Work, result: Result) -> tuple[Surface, Optional[str]]:
        """The surface, and the mesh file relative to the project's folder; None: a box."""
        answers = work.answers
        if _is_box(answers):
            size = np.array(answers["size"])
            coarse, fine = cells_of(size, LOOP_NODES), cells_of(size, FIT_NODES)
            result.settings.append(Setting("object.mesh.box", {"size": answers["size"], "cells": coarse}, "typed; frame O in a corner"))
            result.data["fine_mesh"] = {"box": {"size": answers["size"], "cells": fine}}
            result.lines.append(f"box of {' x '.join(map(str, coarse))} cells for the loop, {' x '.join(map(str, fine))} for the fit")
            return box_surface(answers["size"]), None
        source = work.file("file")
        result.files.append(source)
        path = self._tetrahedra(work, source)
        report = work.programs.run("palpate-mesh", "check", path, "--picture", work.folder / "mesh.png", say=work.person.say)
        result.lines += report.strip().splitlines()[:12]
        if (work.folder / "mesh.png").exists():
            result.pictures.append(work.shown("mesh.png"))
        name = str(path.relative_to(work.project.folder)) if path.is_relative_to(work.project.folder) else str(path)
        result.settings.append(Setting("object.mesh.file", name, f"of {source.name}, in m"))
        result.data["fine_mesh"] = {"file": name}
        return read_surface(path), name

    def _tetrahedra(self, work: Work, source: Path) -> Path:
        suffix = source.suffix.lower()
        if work.answers["mesh"] == "scan":
            path = work.project.folder / "scan.msh"
            work.programs.run("palpate-mesh", "scan", source, path, say=work.person.say)
            return path
        if suffix in MESHES:
            return source
        if suffix not in SURFACES:
            raise InputError(f"file: {source.name}; allowed: {', '.join((*MESHES, *SURFACES))}; palpate-mesh convert writes the first")
        edge = work.answers["edge"] or self._edge_of(read_surface(source))
        path = work.project.folder / (source.stem + ".msh")
        work.programs.run("palpate-mesh", "surface", source, path, "--edge", edge, say=work.person.say)
        return path

    @staticmethod
    def _edge_of(surface: Surface) -> float:
        """About 100 linear nodes, which are some 600 quadratic ones."""
        return float(np.cbrt(surface.volume / 60))

    def _hold(self, answers: Any, lower: Floats, upper: Floats, result: Result) -> None:
        if answers["clamped"] == "group":
            result.settings.append(Setting("object.fixed_group", answers["clamped_group"], "a group of the mesh file"))
        elif answers["clamped"] != "none":
            box = face_box(lower, upper, answers["clamped"], answers["clamped_depth"])
            result.settings.append(Setting("object.fixed_box", box, f"face {answers['clamped']} is clamped, typed"))
            result.data["fixed_box"] = box
        grasp = answers["grasp"]
        if answers["held"] == "group":
            result.settings.append(Setting("object.grasp_group", answers["held_group"], "a group of the mesh file"))
        else:
            box = face_box(lower, upper, answers["held"], answers["held_depth"])
            result.settings.append(Setting("object.grasp_box", box, f"the hand holds face {answers['held']}, typed"))
            result.data["grasp_box"] = box
        if grasp is not None:
            result.settings.append(Setting("object.grasp_at_rest", {"position": grasp}, "X_OG, typed"))

    @staticmethod
    def _check_apart(answers: Any, lower: Floats, upper: Floats) -> None:
        size = upper - lower
        for part in ("clamped", "held"):
            face = answers[part]
            if face in FACES and answers[f"{part}_depth"] > size["xyz".index(face[0])]:
                raise InputError(f"{part}_depth: {answers[f'{part}_depth']:g} m; allowed: up to the object's "
                                 f"{size['xyz'.index(face[0])]:.4g} m")  # fmt: skip
        if answers["clamped"] in FACES and answers["clamped"] == answers["held"]:
            raise InputError(f"held: {answers['held']}; allowed: another face than the clamped one, such as {OTHER_SIDE[answers['held']]}")


def _control(point: list[float]) -> list[Setting]:
    """Of the other slots: one point, steered through the wrist's grasp."""
    return [
        Setting("contact", [{"name": "grasp", "component": "wrench_patch", "sources": "wrist", "on_grasp": True}]),
        Setting("estimation.component", "pose_wrench_filter", "pose and wrench of the hand, fused"),
        Setting("deformation.component", "corotational_quasistatic"),
        Setting("feature", {"component": "point", "rest_points": [point]}, "what a target moves: a point of the object, at rest in O"),
        Setting("control", {"provider": "fem", "law": "proportional_twist", "gain": 1.0}),
    ]  # fmt: skip
