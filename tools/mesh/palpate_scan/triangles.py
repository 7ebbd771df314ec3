"""Areas, normals and volume of triangles, and the removal of folded ones."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def areas_and_normals(nodes: Floats, triangles: Ints) -> tuple[Floats, Floats]:
    """(k,), m^2, and (k, 3), unit."""
    corners = nodes[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    double = np.linalg.norm(normals, axis=1)
    return 0.5 * double, normals / np.maximum(double, 1e-300)[:, None]


def enclosed_volume(nodes: Floats, triangles: Ints) -> float:
    """m^3; negative if the triangles look inward."""
    corners = nodes[triangles]
    return float(np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6)


def collapsed(nodes: Floats, triangles: Ints, bad: Ints) -> tuple[Floats, Ints, int]:
    """Merges the ends of the shortest edge of each triangle of `bad`, where the surface stays a closed one of the same genus
    (the ends have two neighbours in common). Returns nodes, triangles and the number of merged edges."""
    neighbours: list[set[int]] = [set() for _ in nodes]
    around: list[set[int]] = [set() for _ in nodes]
    work = triangles.tolist()
    for index, corners in enumerate(work):
        for i in range(3):
            neighbours[corners[i]].update((corners[i - 1], corners[i - 2]))
            around[corners[i]].add(index)
    places = nodes.copy()
    alive = np.ones(len(work), bool)
    count = 0
    for index in bad:
        if not alive[index]:
            continue
        corners = work[index]
        edges = [(corners[i], corners[(i + 1) % 3]) for i in range(3)]
        for a, b in sorted(edges, key=lambda edge: float(np.linalg.norm(places[edge[0]] - places[edge[1]]))):
            shared = neighbours[a] & neighbours[b]
            if len(shared) != 2 or min(len(neighbours[n]) for n in shared) <= 3:
                continue
            places[a] = 0.5 * (places[a] + places[b])
            for other in list(around[b]):
                if other in around[a]:
                    alive[other] = False
                    for n in work[other]:
                        around[n].discard(other)
                else:
                    work[other] = [a if n == b else n for n in work[other]]
                    around[a].add(other)
            for n in neighbours[b]:
                neighbours[n].discard(b)
                if n != a:
                    neighbours[n].add(a)
                    neighbours[a].add(n)
            neighbours[b], around[b] = set(), set()
            count += 1
            break
    kept = np.array([corners for corners, lives in zip(work, alive) if lives], np.int64)
    used, index = np.unique(kept, return_inverse=True)
    return places[used], index.reshape(-1, 3).astype(np.int64), count
