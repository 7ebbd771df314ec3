"""Common parts of the tests of tools/see."""

import os
import pathlib
import struct
import sys

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
SOURCE = pathlib.Path(os.environ["PALPATE_SOURCE_DIR"])
sys.path[:0] = [str(SOURCE / "tools" / folder) for folder in ("see", "common")]

URDF = SOURCE / "sim/robot/lwr_hand.urdf"
FINGERPRINT = bytes.fromhex("17f2c128b5d25a95")  # of drake/lcmt_point_cloud


def text(value):
    return struct.pack(">i", len(value) + 1) + value.encode() + b"\0"


def encoded_cloud(points, utime=5, rgb=None, height=1, big_endian=False, filler=b"", padding=0, fields=None):
    """drake/lcmt_point_cloud as its published layout says: float32 x, y, z, then `rgb` as the bytes red, green, blue, 0.

    points: rows of three; rgb: rows of three from 0 to 255. padding: bytes after each point and row.
    """
    order = ">" if big_endian else "<"
    all_fields = [("x", 0, 7), ("y", 4, 7), ("z", 8, 7)] + ([("rgb", 12, 6)] if rgb is not None else [])
    step = (16 if rgb is not None else 12) + padding
    width = len(points) // height
    data = b""
    for i, point in enumerate(points):
        data += struct.pack(order + "3f", *point)
        data += bytes([*rgb[i], 0]) if rgb is not None else b""
        data += bytes(padding)
        if (i + 1) % width == 0:
            data += bytes(padding)
    message = FINGERPRINT + struct.pack(">q", utime) + text("camera") + struct.pack(">qqi", width, height, len(all_fields))
    for name, offset, kind in fields or all_fields:
        message += text(name) + struct.pack(">ibi", offset, kind, 1)
    message += struct.pack(">qiqh", (1 if big_endian else 0) | 2, step, step * width + padding, len(filler)) + filler
    return message + struct.pack(">q", len(data)) + data
