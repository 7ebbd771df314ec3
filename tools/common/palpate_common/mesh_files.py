"""Surfaces of mesh files: Gmsh (.msh 2.2 and 4.1, text), STL and OBJ, in m."""

from __future__ import annotations

import re
import struct
from pathlib import Path
from typing import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from palpate_common.input_error import InputError
from palpate_common.surface import Surface

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
TETRAHEDRA = {4: 4, 11: 10}  # Gmsh's element types: nodes of each
FACES = ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))  # of a tetrahedron, outward


def read_surface(path: Path) -> Surface:
    """The closed surface of a mesh file. Raises InputError."""
    readers = {".msh": _read_msh, ".stl": _read_stl, ".obj": _read_obj}
    reader = readers.get(path.suffix.lower())
    if reader is None:
        raise InputError(f"{path}: reads {', '.join(readers)}; palpate-mesh convert {path.name} {path.stem}.msh writes the first")
    try:
        nodes, triangles = reader(path)
        return Surface(nodes, triangles)
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from error
    except (ValueError, IndexError, struct.error) as error:
        raise InputError(f"{path}: {error}; palpate-mesh check {path.name} says what is wrong with it") from error


def boundary(tetrahedra: Ints) -> Ints:
    """Faces, (k, 3), outward, that belong to one tetrahedron, (m, 4 or more), only."""
    faces = np.concatenate([tetrahedra[:, list(face)] for face in FACES])
    _, index, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    result: Ints = faces[np.sort(index[count == 1])]
    return result


def _sections(text: str) -> dict[str, list[str]]:
    return {name: body.split("\n") for name, body in re.findall(r"\$(\w+)\n(.*?)\n\$End\1", text, re.S)}


def _read_msh(path: Path) -> tuple[Floats, Ints]:
    data = path.read_bytes()
    sections = _sections(data.decode("ascii", "replace").replace("\r\n", "\n"))
    try:
        version, binary = sections["MeshFormat"][0].split()[:2]
        if binary != "0":
            raise ValueError(f"is binary; palpate-mesh convert {path.name} text.msh writes text")
        read = {"2.2": _msh_2, "4.1": _msh_4}.get(version)
        if read is None:
            raise ValueError(f"Gmsh's version {version}; reads 2.2 and 4.1")
        nodes, elements = read(sections)
    except KeyError as error:
        raise ValueError(f"section ${error.args[0]} is missing") from error
    if not elements:
        raise ValueError("has no tetrahedra")
    number = {tag: i for i, tag in enumerate(nodes)}
    try:
        tetrahedra = np.array([[number[tag] for tag in element[:4]] for element in elements], np.int64)
    except KeyError as error:
        raise ValueError(f"an element names node {error.args[0]}, which is missing") from error
    places = np.array(list(nodes.values()))
    edges = places[tetrahedra[:, 1:]] - places[tetrahedra[:, :1]]
    flipped = np.linalg.det(edges) < 0
    tetrahedra[flipped, :2] = tetrahedra[flipped, 1::-1]
    return places, boundary(tetrahedra)


Nodes = dict[int, list[float]]


def _msh_2(sections: dict[str, list[str]]) -> tuple[Nodes, list[list[int]]]:
    nodes: Nodes = {}
    for line in sections["Nodes"][1:]:
        words = line.split()
        nodes[int(words[0])] = [float(word) for word in words[1:4]]
    elements = []
    for line in sections["Elements"][1:]:
        numbers = [int(word) for word in line.split()]
        if numbers[1] in TETRAHEDRA:
            elements.append(numbers[3 + numbers[2] :])
    return nodes, elements


def _msh_4(sections: dict[str, list[str]]) -> tuple[Nodes, list[list[int]]]:
    nodes: Nodes = {}
    for _, rows in _blocks(sections["Nodes"], lambda count: 2 * count):
        tags, places = rows[: len(rows) // 2], rows[len(rows) // 2 :]
        for tag, place in zip(tags, places):
            nodes[int(tag)] = [float(word) for word in place.split()[:3]]
    elements = []
    for header, rows in _blocks(sections["Elements"], lambda count: count):
        if header[2] in TETRAHEDRA:
            elements += [[int(word) for word in row.split()[1:]] for row in rows]
    return nodes, elements


def _blocks(lines: list[str], length: Callable[[int], int]) -> Iterator[tuple[list[int], list[str]]]:
    at = 1
    while at < len(lines):
        header = [int(word) for word in lines[at].split()]
        rows = length(header[3])
        yield header, lines[at + 1 : at + 1 + rows]
        at += 1 + rows


def _joined(corners: Floats) -> tuple[Floats, Ints]:
    """Nodes and triangles of separate triangles, (k, 3, 3)."""
    if len(corners) == 0:
        raise ValueError("has no triangles")
    nodes, index = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    return nodes, index.reshape(-1, 3)


def _read_stl(path: Path) -> tuple[Floats, Ints]:
    data = path.read_bytes()
    if len(data) >= 84 and len(data) == 84 + 50 * int.from_bytes(data[80:84], "little"):
        rows = np.frombuffer(data, np.uint8, offset=84).reshape(-1, 50)[:, 12:48]
        return _joined(np.ascontiguousarray(rows).view("<f4").reshape(-1, 3, 3).astype(float))
    words = re.findall(r"vertex\s+(\S+)\s+(\S+)\s+(\S+)", data.decode("ascii", "replace"))
    return _joined(np.array(words, float).reshape(-1, 3, 3))


def _read_obj(path: Path) -> tuple[Floats, Ints]:
    nodes, triangles = [], []
    for number, line in enumerate(path.read_text(errors="replace").splitlines(), 1):
        words = line.split()
        if words[:1] == ["v"]:
            nodes.append([float(word) for word in words[1:4]])
        elif words[:1] == ["f"]:
            corners = [int(word.split("/")[0]) for word in words[1:]]
            corners = [c - 1 if c > 0 else len(nodes) + c for c in corners]
            if len(corners) < 3 or not all(0 <= c < len(nodes) for c in corners):
                raise ValueError(f"line {number}: a face names a node that is missing")
            triangles += [[corners[0], b, c] for b, c in zip(corners[1:], corners[2:])]
    if not triangles:
        raise ValueError("has no faces")
    return np.array(nodes), np.array(triangles, np.int64)
