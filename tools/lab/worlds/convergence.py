"""Convergence of a plant's mesh: positions and wrench in the poses of a scene, quasi-statically."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Callable, Sequence

import numpy as np
from arm import motion_at
from palpate import Mesh, PointsInMesh
from plant import Plant
from rigid import Floats, Pose, exp_rotation, log_rotation
from scene import Scene

_MOVE = 0.5  # s, from pose to pose
_HOLD = 1.5  # s, until the object rests


@dataclass(frozen=True)
class Solution:
    """At rest in each pose: places of common material points, m, and the hand's wrench, N, N m."""

    cells: Sequence[int]
    nodes: int
    positions: Floats  # (poses, points, 3)
    wrenches: Floats  # (poses, 6)


@dataclass(frozen=True)
class Difference:
    """From the finest mesh, over poses and points: m, N, N m."""

    cells: Sequence[int]
    nodes: int
    mean: float
    largest: float
    force: float
    torque: float


def solve(
    scene: Scene,
    X_OG: Pose,
    cells: Sequence[int],
    make: Callable[[], Plant],
    points: Floats,
    progress: Callable[[str], None],
) -> Solution:
    """`X_OG`: first pose of the grasp; `make` builds the plant; `points`: (p, 3), m, in O at
    rest."""
    plant = make()
    mesh = plant.mesh
    places = PointsInMesh(
        Mesh(0, mesh.kind, mesh.nodes, mesh.elements, mesh.triangles, plant.clamped), points
    )
    positions, wrenches, end = [], [], scene.start_delay
    X_before = X_OG
    for leg in scene.legs:
        end += leg.move + leg.hold
        translation, rotation, _ = motion_at(scene, end)
        X_after = Pose(rotation @ X_OG.rotation, X_OG.position + translation)
        _move(plant, X_before, X_after)
        positions.append(places.at(plant.positions))
        wrenches.append(plant.hand_wrench)
        X_before = X_after
        progress(f"{' x '.join(map(str, cells))} cells: {leg.name}")
    return Solution(cells, len(mesh.nodes), np.array(positions), np.array(wrenches))


def _move(plant: Plant, X_from: Pose, X_to: Pose) -> None:
    turn = log_rotation(X_to.rotation @ X_from.rotation.T)
    steps = round(_MOVE / plant.period)
    for step in range(1, steps + 1):
        x = step / steps
        share = x**3 * (10 + x * (-15 + 6 * x))
        position = X_from.position + share * (X_to.position - X_from.position)
        plant.step(Pose(exp_rotation(share * turn) @ X_from.rotation, position))
    for _ in range(round(_HOLD / plant.period)):
        plant.step(X_to)


def differences(solutions: Sequence[Solution]) -> list[Difference]:
    """Each from the last, the finest."""
    finest = solutions[-1]
    result = []
    for solution in solutions[:-1]:
        distance = np.linalg.norm(solution.positions - finest.positions, axis=2)
        wrench = solution.wrenches - finest.wrenches
        result.append(
            Difference(
                solution.cells,
                solution.nodes,
                float(distance.mean()),
                float(distance.max()),
                float(np.linalg.norm(wrench[:, :3], axis=1).max()),
                float(np.linalg.norm(wrench[:, 3:], axis=1).max()),
            )
        )
    return result


def sample_points(size: Floats) -> Floats:
    """A grid of material points of a box, on its surface and inside."""
    axes = [np.linspace(0, side, 11 if side == max(size) else 3) for side in size]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
