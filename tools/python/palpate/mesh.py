"""Shapes and meshes, assembled from their chunks, and points within a mesh."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Iterable, Optional

import numpy as np
from numpy.typing import NDArray

from palpate import messages

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, repr=False, eq=False)
class Mesh:
    """Rest shape of an object in its frame O."""

    hash: int
    element_kind: int  # shape_mesh_t.LINEAR_TETRAHEDRA, ...
    nodes: Floats  # (n, 3), m, at rest
    elements: Ints  # (m, nodes of an element), from 0; of 10: the 4 corners first
    triangles: Ints  # (k, 3), surface, outward
    constrained: Ints  # nodes fixed by the test rig

    def __repr__(self) -> str:
        return f"<Mesh {self.hash:#x}: {len(self.nodes)} nodes, {len(self.elements)} elements>"

    @property
    def corners(self) -> Ints:
        """Nodes at corners of elements; all nodes unless the elements are quadratic tetrahedra."""
        count = 4 if self.elements.shape[1] == 10 else self.elements.shape[1]
        result: Ints = np.unique(self.elements[:, :count])
        return result

    @property
    def longest_side(self) -> float:
        """Of the box around the object at rest, m."""
        return float(np.ptp(self.nodes, axis=0).max())


class MeshBuilder:
    """Collects chunks and assembles each mesh once all of them have arrived."""

    def __init__(self) -> None:
        self._chunks: dict[int, dict[int, messages.shape_mesh_t]] = {}
        self.meshes: dict[int, Mesh] = {}  # complete ones by hash, in order of completion

    def add(self, chunk: messages.shape_mesh_t) -> Optional[Mesh]:
        """The mesh that this chunk completes. Raises ValueError for inconsistent chunks."""
        if chunk.mesh_hash in self.meshes or not 0 <= chunk.chunk < chunk.chunks:
            return None
        chunks = self._chunks.setdefault(chunk.mesh_hash, {})
        chunks[chunk.chunk] = chunk
        if len(chunks) < chunk.chunks:
            return None
        mesh = _join([chunks[index] for index in sorted(chunks)])
        self.meshes[mesh.hash] = mesh
        return mesh


class ShapeBuilder:
    """Joins the chunks of the shapes of one channel."""

    _MOST = 4  # incomplete shapes

    def __init__(self) -> None:
        self._chunks: dict[tuple[int, int], dict[int, messages.shape_t]] = {}

    def add(self, chunk: messages.shape_t) -> Optional[messages.shape_t]:
        """The whole shape that this chunk completes: chunk 0 of 1. Raises ValueError for
        inconsistent chunks."""
        if not 0 <= chunk.chunk < chunk.chunks:
            raise ValueError(f"chunk {chunk.chunk} of {chunk.chunks}")
        key = (chunk.session, chunk.utime)
        chunks = self._chunks.setdefault(key, {})
        chunks[chunk.chunk] = chunk
        if len(chunks) < chunk.chunks:
            while len(self._chunks) > self._MOST:
                del self._chunks[next(iter(self._chunks))]
            return None
        del self._chunks[key]
        whole = chunks[0]
        if chunk.chunks > 1:
            parts = [chunks[index] for index in sorted(chunks)]
            whole.xyz = [value for part in parts for value in part.xyz]
            whole.deviation = [value for part in parts for value in part.deviation]
            whole.xyz_count, whole.deviation_count = len(whole.xyz), len(whole.deviation)
            whole.chunks = 1
        if whole.xyz_count != 3 * whole.node_count:
            raise ValueError(f"shape of {whole.xyz_count} coordinates for {whole.node_count} nodes")
        return whole


def assemble(chunks: Iterable[messages.shape_mesh_t]) -> Mesh:
    """The first complete mesh. Raises ValueError if there is none."""
    count = 0
    builder = MeshBuilder()
    for chunk in chunks:
        count += 1
        mesh = builder.add(chunk)
        if mesh is not None:
            return mesh
    raise ValueError(f"no complete mesh in {count} chunks")


def _join(chunks: list[messages.shape_mesh_t]) -> Mesh:
    first = chunks[0]
    nodes = np.full((max(0, first.node_count), 3), np.nan)
    for chunk in chunks:
        part = np.asarray(chunk.rest_xyz, float).reshape(-1, 3)
        end = chunk.first_node + len(part)
        if chunk.first_node < 0 or end > len(nodes):
            raise ValueError("mesh message with nodes beyond their count")
        nodes[chunk.first_node : end] = part
    if not np.isfinite(nodes).all():
        raise ValueError("mesh message that lacks nodes, or has some that are not finite")

    def joined(field: str, width: int) -> Ints:
        parts = [np.asarray(getattr(chunk, field), np.int64) for chunk in chunks]
        numbers = np.concatenate(parts)
        if numbers.size and not (0 <= numbers.min() and numbers.max() < len(nodes)):
            raise ValueError(f"mesh message whose {field} name a node that it has not")
        if width < 1 or numbers.size % width:
            raise ValueError(f"mesh message with broken {field}")
        return numbers.reshape(-1, width)

    return Mesh(
        first.mesh_hash,
        first.element_kind,
        nodes,
        joined("elements", first.element_size),
        joined("triangles", 3),
        joined("constrained", 1).ravel(),
    )


class PointsInMesh:
    """Material points of a mesh as weighted sums of its nodes: of linear or quadratic tetrahedra
    with straight edges at rest, or of 27-node hexahedra that are boxes at rest, as palpate-sim's
    are."""

    def __init__(self, mesh: Mesh, rest_points: Any) -> None:
        """`rest_points`: (p, 3) in O, m. A point outside uses the nearest element. Raises
        ValueError if the mesh has other elements."""
        points = np.asarray(rest_points, float).reshape(-1, 3)
        self._nodes = np.empty((len(points), mesh.elements.shape[1]), np.int64)
        self._weights = np.empty(self._nodes.shape)
        nodes = mesh.nodes[mesh.elements]  # (m, nodes of an element, 3)
        if mesh.elements.shape[1] == 27:
            place = _place_in_boxes
        elif mesh.elements.shape[1] in (4, 10):
            place = _place_in_tetrahedra
        else:
            raise ValueError("the mesh is neither one of 27-node hexahedra nor of tetrahedra")
        for index, point in enumerate(points):
            element, weights = place(nodes, point)
            self._nodes[index] = mesh.elements[element]
            self._weights[index] = weights

    def at(self, positions: Any) -> Floats:
        """Positions of the points for nodes at `positions`, (..., n, 3): (..., p, 3)."""
        of_points = np.asarray(positions, float)[..., self._nodes, :]
        result: Floats = np.einsum("pk,...pkc->...pc", self._weights, of_points)
        return result


def _place_in_boxes(nodes: Floats, point: Floats) -> tuple[int, Floats]:
    lower, upper = nodes.min(axis=1), nodes.max(axis=1)
    outside = np.maximum(np.maximum(lower - point, point - upper), 0)
    element = int(np.argmin(np.linalg.norm(outside, axis=1)))
    size = upper[element] - lower[element]
    s = (point - lower[element]) / size
    # A node's rest position determines its Lagrange polynomial on 0, 1/2, 1.
    node = (nodes[element] - lower[element]) / size
    polynomial = np.where(
        node < 0.25,
        2 * (s - 0.5) * (s - 1),
        np.where(node > 0.75, 2 * s * (s - 0.5), 4 * s * (1 - s)),
    )
    return element, polynomial.prod(axis=1)


def _place_in_tetrahedra(nodes: Floats, point: Floats) -> tuple[int, Floats]:
    corners = nodes[:, :4]
    edges = (corners[:, 1:] - corners[:, :1]).transpose(0, 2, 1)
    rest = np.linalg.solve(edges, (point - corners[:, 0])[..., None])[..., 0]
    weights = np.column_stack([1 - rest.sum(axis=1), rest])
    clipped = np.maximum(weights, 0)
    clipped /= clipped.sum(axis=1, keepdims=True)
    # For an outside point the nearest: its weights extrapolate beyond the element.
    distance = np.linalg.norm(np.einsum("mk,mkc->mc", clipped, corners) - point, axis=1)
    element = int(np.argmin(distance))
    at = weights[element]
    if nodes.shape[1] == 4:
        return element, at
    ends = np.array([[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]])
    return element, np.concatenate([at * (2 * at - 1), 4 * at[ends].prod(axis=1)])
