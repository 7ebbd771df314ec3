"""The plants by name, built for a scene."""

from __future__ import annotations

from typing import Optional, Sequence

import numpy as np
from object_mesh import ObjectMesh, box_of_tetrahedra, graded_borders, read_msh
from plant import Plant
from rigid import Floats, Pose
from scene import ObjectOptions, Scene
from sensors import GRAVITY_W

WORLDS = ("drake", "mujoco")
# Cells along the longest side, s per step, s of damping proportional to stiffness.
_DEFAULTS = {"drake": (40, 0.01, 0.2), "mujoco": (20, 0.002, 0.02)}


def default_cells(size: Floats, longest: int) -> list[int]:
    """About cubic cells, `longest` along the longest side."""
    return [max(1, round(longest * side / max(size))) for side in size]


def make_plant(
    world: str,
    scene: Scene,
    X_OG: Pose,
    cells: Optional[Sequence[int]] = None,
    period: Optional[float] = None,
    damping: Optional[float] = None,
) -> Plant:
    """`X_OG`: pose of the grasp at rest; what is None has the world's default. Raises ValueError,
    or ImportError where the world's package is not installed."""
    longest, own_period, own_damping = _DEFAULTS[world]
    body = scene.body
    gravity = body.pose.rotation.T @ GRAVITY_W if body.gravity else np.zeros(3)
    given = None if body.mesh is None else read_msh(body.mesh)
    size = np.ptp(given.nodes, axis=0) if given is not None else body.size
    assert size is not None  # a scene has one of them
    counts = list(cells) if cells else default_cells(size, longest)
    period, damping = period or own_period, own_damping if damping is None else damping
    if world == "mujoco":
        from mujoco_obstacles import FACETS  # only the packages of this world are needed
        from mujoco_plant import MujocoPlant

        facets = [FACETS * n if scene.obstacles else 1 for n in counts]
        shape = given or box_of_tetrahedra(
            [np.linspace(0, side, n + 1) for side, n in zip(size, facets)]
        )
        return MujocoPlant(body, shape, counts, gravity, X_OG, period, damping, scene.obstacles)
    from drake_plant import DrakePlant

    shape = given or _drake_box(body, size, counts)
    return DrakePlant(body, shape, gravity, X_OG, period, damping, scene.obstacles)


def _drake_box(body: ObjectOptions, size: Floats, counts: Sequence[int]) -> ObjectMesh:
    """With cells that end where the object is clamped and held."""
    borders = []
    for axis in range(3):
        boxes = (body.clamp_box, body.grasp_box)
        cuts = [float(end[axis]) for box in boxes for end in (box.lower, box.upper)]
        borders.append(graded_borders(float(size[axis]), counts[axis], cuts))
    return box_of_tetrahedra(borders)
