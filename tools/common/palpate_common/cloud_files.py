"""Clouds from PLY, PCD, XYZ (text) and NPY files: (n, 3), m, in the file's frame."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from palpate_common.input_error import InputError

Floats = NDArray[np.float64]
LARGEST = 100.0  # m, of a coordinate
PLY_TYPES = {"char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2",
             "ushort": "u2", "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4",
             "float": "f4", "float32": "f4", "double": "f8", "float64": "f8"}  # fmt: skip


def read_cloud(path: Path) -> Floats:
    """Points of a file; those that are not finite are left out. Raises InputError."""
    readers = {".ply": _read_ply, ".pcd": _read_pcd, ".xyz": _read_xyz, ".txt": _read_xyz, ".npy": _read_npy}
    reader = readers.get(path.suffix.lower())
    if reader is None:
        raise InputError(f"{path}: reads {', '.join(readers)}")
    try:
        points = np.asarray(reader(path), float)
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from error
    except (ValueError, IndexError, KeyError, TypeError) as error:
        raise InputError(f"{path}: {error}") from error
    if points.ndim != 2 or points.shape[1] < 3:
        raise InputError(f"{path}: an array of shape {points.shape}; allowed: (points, 3)")
    points = points[np.isfinite(points[:, :3]).all(axis=1), :3]
    if len(points) < 10:
        raise InputError(f"{path}: {len(points)} finite points; allowed: 10 or more")
    if np.abs(points).max() > LARGEST:
        raise InputError(f"{path}: a coordinate of {np.abs(points).max():g} m; allowed: up to {LARGEST:g} m (is the file in mm?)")
    return points


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
    return np.column_stack([table[axis].astype(float) for axis in "xyz"])


def _table(body: bytes, dtype: np.dtype[np.void], count: int, is_text: bool) -> NDArray[np.void]:
    if is_text:
        rows = [tuple(line.split()) for line in body.decode("ascii", "replace").splitlines() if line.strip()][:count]
        if len(rows) < count:
            raise ValueError(f"{len(rows)} points of the {count} that its header states")
        width = len(dtype.names or ())
        return np.array([tuple(float(word) for word in row[:width]) for row in rows], [(n, "f8") for n in dtype.names or ()])
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
    return np.array(rows).reshape(-1, 3)


def _read_npy(path: Path) -> Floats:
    points: Floats = np.load(path, allow_pickle=False)
    return points
