"""Clouds from PLY, PCD, XYZ (text) and NPY files: points in m, and colours where the file has them."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple, Optional

import numpy as np
from numpy.typing import NDArray

from palpate_common.input_error import InputError

Floats = NDArray[np.float64]
LARGEST = 100.0  # m, of a coordinate
PLY_TYPES = {"char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2",
             "ushort": "u2", "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4",
             "float": "f4", "float32": "f4", "double": "f8", "float64": "f8"}  # fmt: skip


class CloudContent(NamedTuple):
    """points: (n, 3), m, some of which may not be finite. colours: (n, 3), red, green and blue from 0 to 1, or None."""

    points: Floats
    colours: Optional[Floats]


def read_cloud(path: Path, scale: float = 1.0) -> Floats:
    """Points of a file, (n, 3), times `scale`, m; those that are not finite are left out. Raises InputError, also for fewer
    than 10."""
    points = read_coloured_cloud(path, scale).points
    points = points[np.isfinite(points).all(axis=1)]
    if len(points) < 10:
        raise InputError(f"{path}: {len(points)} finite points; allowed: 10 or more")
    return points


def read_coloured_cloud(path: Path, scale: float = 1.0) -> CloudContent:
    """All points of a file, of any number. Colours are of PLY's red, green, blue, of PCD's rgb, or of columns 4 to 6 of XYZ
    and NPY, from 0 to 1 or to 255. Raises InputError."""
    readers = {".ply": _read_ply, ".pcd": _read_pcd, ".xyz": _read_xyz, ".txt": _read_xyz, ".npy": _read_npy}
    reader = readers.get(path.suffix.lower())
    if reader is None:
        raise InputError(f"{path}: reads {', '.join(readers)}")
    try:
        table = np.asarray(reader(path), float)
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from error
    except (ValueError, IndexError, KeyError, TypeError) as error:
        raise InputError(f"{path}: {error}") from error
    if table.ndim != 2 or table.shape[1] < 3:
        raise InputError(f"{path}: an array of shape {table.shape}; allowed: (points, 3)")
    points = table[:, :3] * scale
    largest = np.abs(points[np.isfinite(points).all(axis=1)]).max(initial=0.0)
    if largest > LARGEST:
        raise InputError(f"{path}: a coordinate of {largest:g} m; allowed: up to {LARGEST:g} m (is the file in mm?)")
    return CloudContent(points, _shares(table[:, 3:6]) if table.shape[1] >= 6 else None)


def unpacked_colours(packed: NDArray[np.uint32]) -> Floats:
    """(n, 3) from 0 to 1 of words 0x00RRGGBB, (n,)."""
    result: Floats = np.stack([(packed >> shift) & 255 for shift in (16, 8, 0)], axis=1) / 255.0
    return result


def _shares(colours: Floats) -> Floats:
    return colours / 255.0 if np.nanmax(colours, initial=0.0) > 1 else colours


def _header(data: bytes, last: str) -> tuple[list[list[str]], bytes]:
    """Words of the header's lines up to the one that begins with `last`, and what follows it."""
    lines, at = [], 0
    while at < len(data):
        end = data.find(b"\n", at)
        end = len(data) if end < 0 else end
        words = data[at:end].decode("ascii", "replace").split()
        lines.append(words)
        at = end + 1
        if words[:1] == [last]:
            return lines, data[at:]
    raise ValueError(f"its header lacks the line {last}")


def _columns(table: NDArray[np.void]) -> Floats:
    names = table.dtype.names or ()
    if not {"x", "y", "z"} <= set(names):
        raise ValueError(f"has the fields {', '.join(names)}; x, y and z are needed")
    points = np.column_stack([table[axis].astype(float) for axis in "xyz"])
    if {"red", "green", "blue"} <= set(names):
        # Divided here: 0 or 1 of 255 in all of a dark cloud are no shares of 1.
        scale = 255.0 if table["red"].dtype.kind in "iu" else 1.0
        return np.column_stack([points, *(table[name].astype(float) / scale for name in ("red", "green", "blue"))])
    for name in ("rgb", "rgba"):
        if name in names:
            words = np.ascontiguousarray(table[name])
            words = words.view(np.uint32) if words.dtype == np.float32 else words.astype(np.uint32)
            return np.column_stack([points, unpacked_colours(words)])
    return points


def _table(body: bytes, dtype: np.dtype[np.void], count: int, is_text: bool) -> NDArray[np.void]:
    if is_text:
        rows = [tuple(line.split()) for line in body.decode("ascii", "replace").splitlines() if line.strip()][:count]
        if len(rows) < count:
            raise ValueError(f"{len(rows)} points of the {count} that its header states")
        width = len(dtype.names or ())
        # Text of a float32 is one; of integers, a number.
        kinds = [(name, dtype[name]) for name in dtype.names or ()]
        return np.array([tuple(float(word) for word in row[:width]) for row in rows], kinds)
    if len(body) < count * dtype.itemsize:
        raise ValueError(f"ends before the {count} points that its header states")
    return np.frombuffer(body, dtype, count)


def _read_ply(path: Path) -> Floats:
    lines, body = _header(path.read_bytes(), "end_header")
    if lines[0][:1] != ["ply"]:
        raise ValueError("is no PLY file")
    form = next(words[1] for words in lines if words[:1] == ["format"])
    order = {"ascii": "<", "binary_little_endian": "<", "binary_big_endian": ">"}[form]
    elements = [words for words in lines if words[:1] == ["element"]]
    if not elements or elements[0][1] != "vertex":
        raise ValueError("its first element is not vertex")
    first = lines.index(elements[0])
    last = lines.index(elements[1]) if len(elements) > 1 else len(lines)
    fields = [(words[-1], order + PLY_TYPES[words[1]]) for words in lines[first:last] if words[:1] == ["property"]]
    return _columns(_table(body, np.dtype(fields), int(elements[0][2]), form == "ascii"))


def _read_pcd(path: Path) -> Floats:
    lines, body = _header(path.read_bytes(), "DATA")
    entry = {words[0]: words[1:] for words in lines if words}
    if entry["DATA"] not in (["ascii"], ["binary"]):
        raise ValueError(f"DATA {' '.join(entry['DATA'])}; reads ascii and binary")
    fields = []
    for i, (name, size, kind, count) in enumerate(zip(entry["FIELDS"], entry["SIZE"], entry["TYPE"],
                                                      entry.get("COUNT", ["1"] * len(entry["FIELDS"])))):  # fmt: skip
        base = "<" + {"F": "f", "I": "i", "U": "u"}[kind] + size
        for part in range(int(count)):
            fields.append((name if count == "1" else f"{name}_{i}_{part}", base))
    return _columns(_table(body, np.dtype(fields), int(entry["POINTS"][0]), entry["DATA"] == ["ascii"]))


def _read_xyz(path: Path) -> Floats:
    rows = []
    for number, line in enumerate(path.read_text(errors="replace").splitlines(), 1):
        words = line.split("#")[0].replace(",", " ").replace(";", " ").split()
        if words:
            try:
                rows.append([float(word) for word in words[:3]])
            except ValueError:
                raise ValueError(f"line {number}: {line.strip()!r}; allowed: three numbers") from None
            if len(rows[-1]) < 3:
                raise ValueError(f"line {number}: {len(rows[-1])} numbers; allowed: three or more")
            try:
                rows[-1] += [float(word) for word in words[3:6]]  # a colour, or anything else
            except ValueError:
                pass
    width = 6 if rows and min(map(len, rows)) == 6 else 3
    return np.array([row[:width] for row in rows]).reshape(-1, width)


def _read_npy(path: Path) -> Floats:
    points: Floats = np.load(path, allow_pickle=False)
    return points.reshape(-1, points.shape[2]) if points.ndim == 3 else points
