"""Series of clouds and depth images in files."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Iterator

from palpate_common.cloud_files import read_coloured_cloud
from palpate_common.column_file import Layout, read_columns
from palpate_common.input_error import InputError
from palpate_see.cloud import Cloud
from palpate_see.depth_images import Intrinsics, back_project, read_depth
from palpate_see.edges import EdgeFilter

CLOUDS, IMAGES = (".ply", ".pcd", ".xyz", ".npy"), (".png", ".npy")
STAMP = re.compile(r"(\d+)$")  # at the end of a name without its suffix
LATEST = 1 << 62  # us
LIST = Layout(("utime", "file"), (), {})


def read_clouds(path: Path) -> Iterator[Cloud]:
    """Of a folder or list, in its order. Raises InputError."""
    for utime, file in exposures(path, CLOUDS):
        content = read_coloured_cloud(file)
        yield Cloud(utime, content.points, content.colours)


def read_images(path: Path, intrinsics: Intrinsics, edges: EdgeFilter) -> Iterator[Cloud]:
    """The same of depth images. Raises InputError."""
    for utime, file in exposures(path, IMAGES):
        depth = read_depth(file, intrinsics)
        yield Cloud(utime, back_project(depth, intrinsics), at_edges=edges.of_image(depth).reshape(-1))


def exposures(path: Path, suffixes: tuple[str, ...]) -> list[tuple[int, Path]]:
    """us of each exposure, and its file. Raises InputError.

    Of a folder: files whose names end in the us, sorted by them. Of a CSV file: columns utime and file, relative to it, in
    its order.
    """
    return _of_folder(path, suffixes) if path.is_dir() else _of_list(path)


def _of_folder(path: Path, suffixes: tuple[str, ...]) -> list[tuple[int, Path]]:
    found = []
    for file in path.iterdir():
        if file.suffix.lower() in suffixes:
            stamp = STAMP.search(file.stem)
            if stamp is None:
                raise InputError(f"{file}: its name has no time stamp; allowed: a name such as cloud_1700000000000000"
                                 f"{file.suffix}, or a CSV list with the columns utime and file")  # fmt: skip
            found.append((_stamp(stamp.group(1), str(file)), file))
    if not found:
        raise InputError(f"{path}: holds no file of {', '.join(suffixes)}")
    return sorted(found)


def _of_list(path: Path) -> list[tuple[int, Path]]:
    rows = read_columns(path, LIST)
    found = []
    for row, (utime, file) in enumerate(zip(rows.texts["utime"], rows.texts["file"])):
        if not file:
            rows.fail(row, "file: is absent; required")
        found.append((_stamp(utime, f"{path}:{rows.lines[row]}"), path.parent / file))
    if not found:
        raise InputError(f"{path}: lists no file")
    return found


def _stamp(text: str, where: str) -> int:
    if not text.isdecimal() or int(text) > LATEST:
        raise InputError(f"{where}: utime: {text!r}; allowed: a whole number of us from 0 to {LATEST}")
    return int(text)
