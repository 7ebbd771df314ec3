"""Depth images, PNG of 16 bits or NPY, and their points in the camera's frame."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from palpate_common.input_error import InputError
from palpate_common.section import Section
from palpate_see.cloud import Floats

MOST_PIXELS = 10_000  # of a side


@dataclass(frozen=True)
class Intrinsics:
    """Of a pinhole camera without distortion: width, height, focal lengths and principal point, pixels, whose centres are at
    whole numbers. scale: m per unit of an image of whole numbers."""

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    scale: float = 0.001


def back_project(depth: Floats, intrinsics: Intrinsics) -> Floats:
    """Points, (n, 3), m, in C (x right, y down, z forwards) of depths along the optical axis, (h, w), m, row by row.

    Pixels without depth are rows of NaN, so that they are counted.
    """
    rows, columns = np.indices(depth.shape)
    z = np.where(depth > 0, depth, np.nan)
    x = (columns - intrinsics.cx) / intrinsics.fx * z
    y = (rows - intrinsics.cy) / intrinsics.fy * z
    points: Floats = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    return points


def read_depth(path: Path, intrinsics: Intrinsics) -> Floats:
    """(h, w), m, 0: none. An NPY file of floating numbers holds m; whole numbers are in units of `scale`.

    Raises InputError.
    """
    image = _read(path)
    if image.shape != (intrinsics.height, intrinsics.width):
        raise InputError(f"{path}: {' x '.join(map(str, image.shape[::-1]))} pixels; allowed: "
                         f"{intrinsics.width} x {intrinsics.height}, as in section intrinsics")  # fmt: skip
    scale = intrinsics.scale if image.dtype.kind in "iu" else 1.0
    depth = scale * image.astype(float)
    result: Floats = np.where(np.isfinite(depth) & (depth > 0), depth, 0.0)
    return result


def _read(path: Path) -> Floats:
    try:
        if path.suffix.lower() == ".npy":
            image = np.load(path, allow_pickle=False)
        elif path.suffix.lower() == ".png":
            from PIL import Image

            image = np.asarray(Image.open(path))
        else:
            raise InputError(f"{path}: reads .png (16 bits) and .npy")
    except OSError as error:
        raise InputError(f"{path}: {error.strerror or error}") from error
    except ImportError as error:
        remedy = "apt-get install python3-pil, or images as .npy"
        raise InputError(f"{path}: PNG needs the Python package PIL; remedy: {remedy}") from error
    except (ValueError, SyntaxError, EOFError) as error:
        raise InputError(f"{path}: {error}") from error
    if image.ndim != 2 or image.dtype.kind not in "iuf" or image.dtype.itemsize < 2:
        raise InputError(f"{path}: {image.dtype} of shape {image.shape}; allowed: one channel of 16 bits or more")
    return image  # type: ignore[no-any-return]


def read_intrinsics(section: Section) -> Intrinsics:
    """Of section `intrinsics`. Raises InputError."""
    width, height = section.whole("width", 1, MOST_PIXELS), section.whole("height", 1, MOST_PIXELS)
    made = Intrinsics(
        width,
        height,
        section.number("fx", 1, 1e5),
        section.number("fy", 1, 1e5),
        section.number("cx", -MOST_PIXELS, MOST_PIXELS, (width - 1) / 2),
        section.number("cy", -MOST_PIXELS, MOST_PIXELS, (height - 1) / 2),
        section.number("scale", 1e-6, 1, 0.001),
    )
    section.check_unused()
    return made
