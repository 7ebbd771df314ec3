"""A reconstructed surface with sharp edges, fitted to the points.

Poisson reconstruction rounds edges, and a coarse mesh of a rounded box has bevels. The normals of the triangles are therefore
filtered bilaterally (Zheng, Fu, Au and Tai 2011, Bilateral normal filtering for mesh denoising, local scheme), which keeps each
side of an edge, and the nodes are then moved by least squares: towards the points along these normals, and so that edges of
triangles are perpendicular to them.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray
from scipy.sparse.linalg import cg
from scipy.spatial import cKDTree

from palpate_common.surface import Surface
from palpate_scan.triangles import areas_and_normals, collapsed

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
RADIUS = 1.5  # mean edges: standard deviation of the filter in space
CONTRAST = 0.35  # of the filter between unit normals: 20 degrees
SWEEPS = 15
STRAIGHT = 3.0  # weight of an edge that is not perpendicular to a normal, by that of a point
TANGENT = 0.1  # weight of a node's place within the surface
FOLDED = 0.4  # cosine between filtered and actual normal of a triangle that has been turned over
TRIES = 4


def fitted(module: Any, nodes: Floats, triangles: Ints, points: Floats) -> tuple[Floats, Ints, bool]:
    """Nodes, triangles, and whether the edges are sharp: false where that would make the surface cross itself, which then
    stays as it came. nodes: (n, 3), triangles: (k, 3), points: (m, 3), m."""
    given, weight = (nodes, triangles), TANGENT
    for _ in range(TRIES):
        nodes, triangles = given
        for _ in range(5):
            normals = filtered_normals(nodes, triangles)
            nodes = _moved(nodes, triangles, normals, points, weight)
            bad = np.flatnonzero(np.einsum("ij,ij->i", areas_and_normals(nodes, triangles)[1], normals) < FOLDED)
            if len(bad) == 0:
                break
            nodes, triangles, _ = collapsed(nodes, triangles, bad)
        mesh = module.geometry.TriangleMesh(
            module.utility.Vector3dVector(nodes), module.utility.Vector3iVector(triangles.astype(np.int32)))  # fmt: skip
        if len(bad) == 0 and not mesh.is_self_intersecting():
            return nodes, triangles, True
        weight *= 3
    return given[0], given[1], False


def filtered_normals(nodes: Floats, triangles: Ints) -> Floats:
    """(k, 3), unit: constant on flat sides, and discontinuous at edges between them."""
    areas, normals = areas_and_normals(nodes, triangles)
    middles = nodes[triangles].mean(axis=1)
    radius = RADIUS * np.sqrt(areas.mean() * 4 / np.sqrt(3))  # of equilateral triangles
    pairs = cKDTree(middles).query_pairs(2 * radius, output_type="ndarray")
    i, j = np.concatenate([pairs, pairs[:, ::-1]]).T
    near = areas[j] * np.exp(-((middles[i] - middles[j]) ** 2).sum(axis=1) / (2 * radius**2))
    for _ in range(SWEEPS):
        alike = near * np.exp(-((normals[i] - normals[j]) ** 2).sum(axis=1) / (2 * CONTRAST**2))
        summed = sparse.csr_matrix((alike, (i, j)), (len(normals), len(normals))) @ normals + areas[:, None] * normals
        normals = summed / np.linalg.norm(summed, axis=1, keepdims=True)
    return normals


def _moved(nodes: Floats, triangles: Ints, normals: Floats, points: Floats, weight: float) -> Floats:
    count = len(nodes)
    surface = Surface(nodes, triangles)
    feet, chosen = surface.closest(points)
    corners = surface.corners[chosen]
    shares = _barycentric(feet, corners)
    of_point = _rows(triangles[chosen], shares, normals[chosen], count)
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    of_edge = _rows(edges, np.tile([1.0, -1.0], (len(edges), 1)), np.tile(normals, (3, 1)), count)
    areas, _ = areas_and_normals(nodes, triangles)
    spread, around = np.zeros((count, 3, 3)), np.zeros(count)
    for corner in range(3):
        np.add.at(spread, triangles[:, corner], areas[:, None, None] * normals[:, :, None] * normals[:, None, :])
        np.add.at(around, triangles[:, corner], areas)
    # Weak along the normals, at a sharp edge along those of both sides; otherwise the middle of the neighbours.
    hold = weight * np.linalg.inv(spread / around[:, None, None] + 0.05 * np.eye(3))
    held = sparse.bsr_matrix((hold, np.arange(count), np.arange(count + 1)), shape=(3 * count, 3 * count)).tocsr()
    pair = sparse.csr_matrix((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), (count, count))
    pair = pair + pair.T
    middle = (pair @ nodes) / np.asarray(pair.sum(axis=1))
    matrix = of_point.T @ of_point + STRAIGHT * (of_edge.T @ of_edge) + held
    right = of_point.T @ np.einsum("ij,ij->i", normals[chosen], points) + held @ (0.5 * (nodes + middle)).reshape(-1)
    found, _ = cg(matrix, right, x0=nodes.reshape(-1), tol=1e-5, atol=0, maxiter=300, M=sparse.diags(1 / matrix.diagonal()))
    return np.asarray(found).reshape(-1, 3)


def _rows(of: Ints, shares: Floats, normals: Floats, count: int) -> Any:
    """Matrix of normal . (sum of shares times nodes): one row each of `of`, (r, c), `shares`, (r, c), `normals`, (r, 3)."""
    rows = np.repeat(np.arange(len(of)), 3 * of.shape[1])
    columns = (3 * of[:, :, None] + np.arange(3)).reshape(-1)
    values = (shares[:, :, None] * normals[:, None, :]).reshape(-1)
    return sparse.csr_matrix((values, (rows, columns)), (len(of), 3 * count))


def _barycentric(points: Floats, corners: Floats) -> Floats:
    first, second, way = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0], points - corners[:, 0]
    a, b, c = (np.einsum("ij,ij->i", *pair) for pair in ((first, first), (first, second), (second, second)))
    x, y = np.einsum("ij,ij->i", way, first), np.einsum("ij,ij->i", way, second)
    scale = np.maximum(a * c - b * b, 1e-300)
    u, v = (c * x - b * y) / scale, (a * y - b * x) / scale
    return np.stack([1 - u - v, u, v], axis=1)
