"""The two commands: files in, files out."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from palpate_common.cloud_files import read_cloud
from palpate_common.input_error import InputError
from palpate_common.json_output import write_json
from palpate_common.mesh_files import read_surface
from palpate_common.surface import Surface

FEWEST = 200  # points of a cloud of which a surface is made


def make(options: argparse.Namespace) -> int:
    """`surface`: writes the closed surface as OBJ and what was found on the way as JSON."""
    points = read_cloud(options.cloud, options.scale)
    if len(points) < FEWEST:
        raise InputError(f"{options.cloud}: {len(points)} points; allowed: {FEWEST} or more of a scan")
    from palpate_scan.reconstruction import reconstruct

    try:
        made = reconstruct(points, options.most_unseen)
    except InputError as error:
        raise InputError(f"{options.cloud}: {error}") from error
    write_obj(options.surface, made.nodes, made.triangles)
    write_json(made.facts, options.json)
    return 0


def compare(options: argparse.Namespace) -> int:
    """`deviation`: distances of cloud and surface in both directions as JSON, and a picture."""
    from palpate_scan.deviation import measure

    points, surface = read_cloud(options.cloud, options.scale), read_surface(options.surface)
    found = measure(points, surface)
    write_json(found.facts, options.json)
    if options.picture:
        from palpate_scan.picture import draw

        draw(options.picture, options.cloud.name, points, surface, found)
    return 0


def write_obj(path: Path, nodes: NDArray[np.float64], triangles: NDArray[np.int64]) -> None:
    """nodes: (n, 3), m. triangles: (k, 3), from 0."""
    Surface(nodes, triangles)  # refuses what encloses nothing
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in nodes] + [f"f {a} {b} {c}" for a, b, c in triangles + 1]
    path.write_text("\n".join(lines) + "\n")
