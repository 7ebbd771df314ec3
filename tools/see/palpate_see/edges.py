"""Points at edges in the camera's view, where a measured depth may be a mixture of both sides (flying pixels)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from palpate_common.section import Section
from palpate_see.cloud import Floats, Mask

AROUND = 0.1  # tangent of the angle about the sought points within which neighbours are looked for


@dataclass(frozen=True)
class EdgeFilter:
    """What is next to a jump of the depth is removed, on both sides.

    jump: of neighbouring pixels, as a share of their depth. pixels: at most so far from the jump; 0: nothing is removed.
    """

    jump: float = 0.02
    pixels: int = 2

    def of_image(self, depth: Floats) -> Mask:
        """(h, w) of depths, (h, w), m, 0: none: whether a pixel is at an edge. Pixels without depth make none."""
        has = depth > 0
        at_edge = np.zeros(depth.shape, bool)
        if self.pixels == 0:
            return at_edge
        for axis in (0, 1):
            near, far = _neighbours(axis)
            steep = np.abs(depth[far] - depth[near]) > self.jump * np.minimum(depth[far], depth[near])
            steep &= has[far] & has[near]
            at_edge[near] |= steep
            at_edge[far] |= steep
        for _ in range(self.pixels - 1):
            narrow = at_edge.copy()
            for axis in (0, 1):
                near, far = _neighbours(axis)
                at_edge[near] |= narrow[far]
                at_edge[far] |= narrow[near]
        return at_edge

    def of_cloud(self, points: Floats, everything: Floats) -> Mask:
        """(n,) of points, (n, 3), m, in C, among all points that were seen, (k, 3), also those of other bodies, all finite
        and with z > 0. Neighbours are as many as an image has within `pixels`, the nearest by their direction."""
        count = (2 * self.pixels + 1) ** 2  # with the point itself
        if self.pixels == 0 or len(points) == 0:
            return np.zeros(len(points), bool)
        towards, others = points[:, :2] / points[:, 2:], everything[:, :2] / everything[:, 2:]
        near = ((others >= towards.min(axis=0) - AROUND) & (others <= towards.max(axis=0) + AROUND)).all(axis=1)
        others, depths = others[near], everything[near, 2]
        _, found = cKDTree(others).query(towards, min(count, len(others)))
        gaps = np.abs(depths[found.reshape(len(points), -1)] - points[:, 2:]).max(axis=1)
        result: Mask = gaps > self.jump * points[:, 2]
        return result


def _neighbours(axis: int) -> tuple[tuple[slice, ...], tuple[slice, ...]]:
    """Index of all pixels but the last along an axis, and of all but the first."""
    near, far = [slice(None)] * 2, [slice(None)] * 2
    near[axis], far[axis] = slice(None, -1), slice(1, None)
    return tuple(near), tuple(far)


def read_edges(section: Section) -> EdgeFilter:
    """Of section `edges`. Raises InputError."""
    usual = EdgeFilter()
    made = EdgeFilter(section.number("jump", 1e-4, 1, usual.jump), section.whole("pixels", 0, 20, usual.pixels))
    section.check_unused()
    return made
