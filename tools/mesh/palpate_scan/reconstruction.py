"""A closed surface of a cloud: Poisson reconstruction by Open3D, a plane for the side that the scan did not see, sharp edges
and a fit to the points."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from palpate_common.input_error import InputError
from palpate_scan.support import support_points
from palpate_scan.triangles import areas_and_normals, enclosed_volume

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
NEIGHBOURS = 20  # points, of a normal and of the test for outliers
OUTLIER = 4.0  # standard deviations of the mean distance to the neighbours
MOST_POINTS = 40000  # more are averaged in cells
TRIANGLES = (6000, 5000, 4000, 7000)  # of the surface: several times finer than any mesh that is made of it
FAR = 3.0  # spacings from the nearest point, beyond which a surface counts as not seen


class Reconstruction(NamedTuple):
    """nodes: (n, 3), m. triangles: (k, 3), outward. facts: for the report, SI units."""

    nodes: Floats
    triangles: Ints
    facts: dict[str, Any]


def open3d() -> Any:
    """The module. Raises InputError with the package's name where it is absent."""
    try:
        import open3d as module
    except ImportError as error:
        raise InputError(f"Open3D is needed to make a surface of a cloud ({error}); apt-get install python3-open3d") from error
    return module


def reconstruct(points: Floats, most_unseen: float) -> Reconstruction:
    """points: (n, 3), m. most_unseen: share of the surface, 0 to 1, that may lie far from all points. Raises InputError where
    no closed surface results, or where more of it is guessed than that."""
    from palpate_scan.fit import fitted  # imports after open3d() has been tried

    module = open3d()
    cloud = module.geometry.PointCloud(module.utility.Vector3dVector(points))
    cloud, _ = cloud.remove_statistical_outlier(NEIGHBOURS, OUTLIER)
    outliers = len(points) - len(cloud.points)
    if len(cloud.points) > MOST_POINTS:
        cloud = _thinned(cloud)
    kept = np.asarray(cloud.points).copy()
    distances, _ = cKDTree(kept).query(kept, 7)
    # In an even random cloud the k-th neighbour has k others in a disc of its radius: here k = 6.
    spacing = float(np.median(distances[:, 6]) * np.sqrt(np.pi / 6))
    cloud.estimate_normals(module.geometry.KDTreeSearchParamKNN(NEIGHBOURS))
    cloud.orient_normals_consistent_tangent_plane(10)
    nodes, triangles, parts = _poisson(module, cloud, spacing)
    added = support_points(kept, np.asarray(cloud.normals), _unseen_places(nodes, triangles, kept, spacing), spacing)
    if len(added.points):
        both = module.geometry.PointCloud(module.utility.Vector3dVector(np.concatenate([kept, added.points])))
        inward = enclosed_volume(nodes, triangles) < 0
        normals = np.concatenate([np.asarray(cloud.normals), -added.normals if inward else added.normals])
        both.normals = module.utility.Vector3dVector(normals)
        nodes, triangles, parts = _poisson(module, both, spacing)
        kept = np.concatenate([kept, added.points])
    if enclosed_volume(nodes, triangles) < 0:
        triangles = triangles[:, ::-1]
    areas = areas_and_normals(nodes, triangles)[0]
    far = cKDTree(kept).query(nodes[triangles].mean(axis=1))[0] > FAR * spacing
    unseen = float(areas[far].sum() / areas.sum())
    if unseen > most_unseen:
        raise InputError(
            f"{100 * unseen:.0f} % of the closed surface is farther than {1e3 * FAR * spacing:.1f} mm from all points; allowed: "
            f"{100 * most_unseen:.0f} % (--most-unseen). Is the scan of one side only, or are its points uneven?")  # fmt: skip
    nodes, triangles, sharpened = fitted(module, nodes, triangles, kept)
    facts = {"points": len(points), "outliers": outliers, "spacing_m": spacing, "unseen_share": unseen, "parts_dropped": parts,
             "support_points": len(added.points), "edges_sharpened": sharpened, "triangles": len(triangles),
             "volume_m3": enclosed_volume(nodes, triangles)}  # fmt: skip
    return Reconstruction(nodes, triangles, facts)


def _thinned(cloud: Any) -> Any:
    size = float(np.linalg.norm(cloud.get_max_bound() - cloud.get_min_bound())) / 1000
    while len(cloud.points) > MOST_POINTS:
        cloud = cloud.voxel_down_sample(size)
        size *= 1.2
    return cloud


def _poisson(module: Any, cloud: Any, spacing: float) -> tuple[Floats, Ints, int]:
    """Nodes and triangles of the largest closed part, of either orientation, and the number of other parts."""
    largest = 1.1 * float((cloud.get_max_bound() - cloud.get_min_bound()).max())  # of the cube: Open3D's scale
    depth = int(np.clip(np.round(np.log2(largest / (1.2 * spacing))), 5, 8))
    mesh, _ = module.geometry.TriangleMesh.create_from_point_cloud_poisson(cloud, depth=depth, n_threads=1)
    clusters, counts, _ = mesh.cluster_connected_triangles()
    mesh.remove_triangles_by_mask(np.asarray(clusters) != int(np.argmax(counts)))
    mesh.remove_unreferenced_vertices()
    if not mesh.is_edge_manifold(allow_boundary_edges=False):
        raise InputError("its points do not enclose a body: the surface through them is open. Is the scan of one side only?")
    made = _coarser(mesh)
    if made is None:
        raise InputError("the surface through its points is not that of one body; are there gaps that touch, or a second object?")
    return np.asarray(made.vertices).copy(), np.asarray(made.triangles).astype(np.int64), len(counts) - 1


def _coarser(mesh: Any) -> Any:
    """The same with fewer triangles, of one of TRIANGLES. Open3D's decimation may join sheets or make triangles that cross, so
    the first result without either is taken, otherwise the first without joined sheets; None if there is none."""
    possible = []
    for count in TRIANGLES:
        made = mesh.simplify_quadric_decimation(count) if len(mesh.triangles) > count else mesh
        if made.is_edge_manifold(allow_boundary_edges=False) and made.is_vertex_manifold() and made.is_orientable():
            if not made.is_self_intersecting():
                return made
            possible.append(made)
    return possible[0] if possible else None


def _unseen_places(nodes: Floats, triangles: Ints, points: Floats, spacing: float) -> Floats:
    middles: Floats = nodes[triangles].mean(axis=1)
    return middles[cKDTree(points).query(middles)[0] > FAR * spacing]
