"""Meshes of the object: boxes of cells, and tetrahedra from a .msh file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Sequence

import numpy as np
from numpy.typing import NDArray
from palpate.messages import shape_mesh_t
from rigid import Floats

Ints = NDArray[np.int64]

# A cube of corners i + 2 j + 4 k in five tetrahedra, and its mirror image, which alternates
# with it.
_FIVE = np.array([[0, 1, 2, 4], [3, 2, 1, 7], [5, 4, 7, 1], [6, 7, 4, 2], [1, 2, 4, 7]])
_FIVE_MIRRORED = np.array([[1, 0, 5, 3], [2, 3, 6, 0], [4, 5, 0, 6], [7, 6, 3, 5], [0, 5, 3, 6]])


@dataclass(frozen=True)
class ObjectMesh:
    """Rest shape in O."""

    nodes: Floats  # (n, 3), m
    elements: Ints  # (m, 4) tetrahedra, or (m, 27) hexahedra with x fastest
    triangles: Ints  # (k, 3), surface, outward

    @property
    def kind(self) -> int:
        linear = self.elements.shape[1] == 4
        kind: int = shape_mesh_t.LINEAR_TETRAHEDRA if linear else shape_mesh_t.QUADRATIC_HEXAHEDRA
        return kind


def graded_borders(length: float, count: int, cuts: Sequence[float]) -> Floats:
    """Borders of about `count` cells from 0 to `length`, m, with one at each of `cuts`, between
    which the cells are equal."""
    inside = sorted({round(cut, 9) for cut in cuts if 1e-9 < cut < length - 1e-9})
    stations = np.array([0.0, *inside, length])
    counts = [max(1, round(count * part / length)) for part in np.diff(stations)]
    parts = [
        np.linspace(stations[i], stations[i + 1], counts[i] + 1)[:-1] for i in range(len(counts))
    ]
    return np.append(np.concatenate(parts), length)


def box_of_tetrahedra(borders: Sequence[Floats]) -> ObjectMesh:
    """A box of cells between `borders` along x, y and z, five tetrahedra each."""
    counts = [len(part) - 1 for part in borders]
    index = np.arange(np.prod([n + 1 for n in counts])).reshape([n + 1 for n in counts])
    nodes = np.stack(np.meshgrid(*borders, indexing="ij"), axis=-1).reshape(-1, 3)
    corners = np.stack(
        [
            index[i : i + counts[0], j : j + counts[1], k : k + counts[2]]
            for k in (0, 1)
            for j in (0, 1)
            for i in (0, 1)
        ],
        axis=-1,
    ).reshape(-1, 8)
    odd = np.indices(counts).sum(axis=0).ravel() % 2 == 1
    elements = np.where(odd[:, None, None], corners[:, _FIVE_MIRRORED], corners[:, _FIVE])
    return tetrahedra(nodes, elements.reshape(-1, 4))


def tetrahedra(nodes: Any, elements: Any) -> ObjectMesh:
    """Orients the elements and finds their surface. Nodes that no element uses are left out."""
    used, elements = np.unique(np.asarray(elements, np.int64), return_inverse=True)
    elements = elements.reshape(-1, 4)
    nodes = np.asarray(nodes, float)[used]
    negative = volumes(nodes, elements) < 0
    elements[negative] = elements[negative][:, [0, 2, 1, 3]]
    faces = elements[:, [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]]].reshape(-1, 3)
    _, first, count = np.unique(
        np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True
    )
    return ObjectMesh(nodes, elements, faces[first[count == 1]])


def volumes(nodes: Floats, elements: Ints) -> Floats:
    """Signed, of tetrahedra, m^3."""
    edges = nodes[elements[:, 1:]] - nodes[elements[:, :1]]
    return np.linalg.det(edges) / 6


def hexahedra(borders: Sequence[Floats], filled: Any) -> tuple[ObjectMesh, Ints]:
    """27-node hexahedra: those cells of a grid that `filled`, (cells along x, y, z), marks. Also
    the node of the grid, z fastest, that each node of the mesh is."""
    points = [np.sort(np.concatenate([part, (part[1:] + part[:-1]) / 2])) for part in borders]
    shape = tuple(len(part) for part in points)
    grid = np.stack(np.meshgrid(*points, indexing="ij"), axis=-1).reshape(-1, 3)
    cells = np.argwhere(filled)
    local = np.array([[i, j, k] for k in range(3) for j in range(3) for i in range(3)])
    at = 2 * cells[:, None, :] + local
    used, elements = np.unique(np.ravel_multi_index(tuple(at.T), shape).T, return_inverse=True)
    elements = elements.reshape(-1, 27)
    return ObjectMesh(grid[used], elements, _faces(elements, filled, cells)), used


def _faces(elements: Ints, filled: Any, cells: Ints) -> Ints:
    """Eight triangles for each face without a neighbour."""
    padded = np.pad(np.asarray(filled, bool), 1)
    node = np.arange(27).reshape(3, 3, 3).transpose(2, 1, 0)  # by i, j, k
    triangles = []
    for axis in range(3):
        for upper in (False, True):
            step = np.eye(3, dtype=int)[axis] * (1 if upper else -1)
            open_faces = ~padded[tuple((cells + 1 + step).T)]
            face = np.take(node, 2 if upper else 0, axis=axis)
            # Along the axes u, v that follow the normal one in turn.
            face = face if axis != 1 else face.T
            for p in range(2):
                for q in range(2):
                    ring = [face[p, q], face[p + 1, q], face[p + 1, q + 1], face[p, q + 1]]
                    ring = ring if upper else ring[::-1]
                    for corners in (ring[:3], [ring[0], ring[2], ring[3]]):
                        triangles.append(elements[open_faces][:, corners])
    return np.concatenate(triangles)


def read_msh(file: Path) -> ObjectMesh:
    """Tetrahedra of a Gmsh file. Raises ValueError."""
    import meshio  # only needed here

    try:
        mesh = meshio.read(file)
    except (OSError, meshio.ReadError) as error:
        raise ValueError(f"{file}: {error}") from None
    elements = mesh.cells_dict.get("tetra")
    if elements is None:
        raise ValueError(f"{file}: has no linear tetrahedra")
    return tetrahedra(mesh.points, elements)
