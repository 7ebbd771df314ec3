"""The LCM message drake/lcmt_point_cloud, as Drake's PointCloudToLcm and others publish it.

Layout of Drake 1.0 and later, all in network order after the type's fingerprint (8 bytes): utime (int64, us), frame_name
(length with its zero, int32, and text), width and height (int64), num_fields (int32), the fields, each of name (as above),
byte_offset (int32), datatype (int8) and count (int32), then flags (int64; 1: data are big-endian, 2: all are finite),
point_step (int32), row_step (int64), filler_size (int16) and so many bytes, data_size (int64) and so many bytes.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import Optional

import numpy as np
from numpy.typing import NDArray

from palpate_common.cloud_files import unpacked_colours
from palpate_see.cloud import Cloud, Floats

# Hash of the names and types of all members, of both structs, by lcm-gen of the published definitions.
FINGERPRINT = bytes.fromhex("17f2c128b5d25a95")
BIG_ENDIAN = 1  # of flags
TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}  # by datatype
MOST_FIELDS = 64
MOST_POINTS = 10_000_000


class MalformedCloud(ValueError):
    """Bytes that are no cloud; the message says why."""


@dataclass(frozen=True)
class Field:
    """A number of each point, at `offset` bytes from the point's start."""

    name: str
    offset: int
    datatype: int
    count: int


class _Reader:
    def __init__(self, data: bytes) -> None:
        self.data, self.at = data, 0

    def take(self, size: int, what: str) -> bytes:
        if size < 0 or self.at + size > len(self.data):
            raise MalformedCloud(f"{what}: {size} bytes at {self.at} of {len(self.data)}")
        self.at += size
        return self.data[self.at - size : self.at]

    def numbers(self, form: str, what: str) -> tuple[int, ...]:
        return struct.unpack(form, self.take(struct.calcsize(form), what))

    def text(self, what: str) -> str:
        (size,) = self.numbers(">i", what)
        if size < 1:
            raise MalformedCloud(f"{what}: a length of {size}; allowed: 1 or more")
        return self.take(size, what)[:-1].decode("utf-8", "replace")


def decode_point_cloud(data: bytes) -> Cloud:
    """Points and, where it has them, colours: field `rgb`, of the bytes red, green and blue as Drake sends them.

    Raises MalformedCloud.
    """
    if data[:8] != FINGERPRINT:
        raise MalformedCloud(f"the fingerprint is {data[:8].hex()}; drake/lcmt_point_cloud has {FINGERPRINT.hex()}")
    reader = _Reader(data)
    reader.take(8, "fingerprint")
    (utime,) = reader.numbers(">q", "utime")
    reader.text("frame_name")
    width, height, num_fields = reader.numbers(">qqi", "width, height, num_fields")
    if not (0 <= width <= MOST_POINTS and 0 <= height <= MOST_POINTS and width * height <= MOST_POINTS):
        raise MalformedCloud(f"{width} x {height} points; allowed: up to {MOST_POINTS}")
    if not 0 <= num_fields <= MOST_FIELDS:
        raise MalformedCloud(f"{num_fields} fields; allowed: up to {MOST_FIELDS}")
    fields = {}
    for _ in range(num_fields):
        name = reader.text("name of a field")
        fields[name] = Field(name, *reader.numbers(">ibi", f"field {name}"))
    flags, point_step, row_step, filler = reader.numbers(">qiqh", "flags, point_step, row_step, filler_size")
    reader.take(filler, "filler")
    (size,) = reader.numbers(">q", "data_size")
    body = reader.take(size, "data")
    table = _Table(body, (height, width), (row_step, point_step), ">" if flags & BIG_ENDIAN else "<", fields)
    with np.errstate(invalid="ignore"):  # signalling NaN
        points = np.stack([table.column(name).astype(float) for name in "xyz"], axis=1)
    return Cloud(utime, points, table.colours())


class _Table:
    """Columns of the data. shape: rows, columns; steps: bytes from row to row and from point to point."""

    def __init__(self, body: bytes, shape: tuple[int, int], steps: tuple[int, int], order: str,
                 fields: dict[str, Field]) -> None:  # fmt: skip
        self._body, self._shape, self._steps, self._order, self._fields = body, shape, steps, order, fields
        row_step, point_step = steps
        if shape[0] > 1 and row_step < shape[1] * point_step or point_step < 1:
            raise MalformedCloud(f"point_step {point_step}, row_step {row_step} with {shape[1]} points in a row")
        needed = 0 if 0 in shape else (shape[0] - 1) * row_step + shape[1] * point_step
        if needed > len(body):
            raise MalformedCloud(f"data of {len(body)} bytes; {needed} are needed")

    def column(self, name: str) -> NDArray[np.generic]:
        """(n,) of a field."""
        field = self._fields.get(name)
        if field is None:
            raise MalformedCloud(f"has the fields {', '.join(self._fields) or '(none)'}; x, y and z are needed")
        if field.datatype not in TYPES:
            raise MalformedCloud(f"field {name}: datatype {field.datatype}; allowed: 1 to 8")
        return self._view(field.offset, np.dtype(self._order + TYPES[field.datatype]), name)

    def _view(self, offset: int, kind: np.dtype[np.generic], name: str) -> NDArray[np.generic]:
        if not 0 <= offset <= self._steps[1] - kind.itemsize:
            raise MalformedCloud(f"field {name}: {kind.itemsize} bytes at {offset} of {self._steps[1]}")
        if 0 in self._shape:
            return np.zeros(0, kind)
        view: NDArray[np.generic] = np.ndarray(self._shape, kind, self._body, offset, self._steps)
        return view.reshape(-1)

    def colours(self) -> Optional[Floats]:
        """(n, 3) from 0 to 1; None without field `rgb`. A float32 holds the word 0x00RRGGBB, as PCL's does."""
        field = self._fields.get("rgb") or self._fields.get("rgba")
        if field is None or TYPES.get(field.datatype, "")[1:] != "4":
            return None
        if TYPES[field.datatype] == "f4":
            words = self._view(field.offset, np.dtype(self._order + "u4"), field.name)
            return unpacked_colours(words.astype(np.uint32))
        channels = [self._view(field.offset + i, np.dtype("u1"), field.name).astype(float) for i in range(3)]
        result: Floats = np.stack(channels, axis=1) / 255
        return result
