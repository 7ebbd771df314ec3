"""What a world must do for palpate-world: a soft object that is clamped and held, quasi-rigidly at
both places, and the wrench that its hand feels.
"""

from __future__ import annotations

from typing import Protocol

from object_mesh import Ints, ObjectMesh
from rigid import Floats, Pose


class Plant(Protocol):
    """An object at rest in O until the first step. Held nodes follow the hand rigidly."""

    mesh: ObjectMesh  # to which positions belong
    clamped: Ints  # numbers of the clamped nodes of the mesh
    held: Ints  # numbers of the held ones
    period: float  # s, of a step

    def step(self, X_OG: Pose) -> None:
        """Advances by one period, at whose end the grasp is at X_OG."""

    @property
    def positions(self) -> Floats:
        """(n, 3), m, in O."""

    @property
    def hand_wrench(self) -> Floats:
        """Of the hand on the object at G, in O: N, N m."""

    @property
    def remark(self) -> str:
        """Solver, elements and nodes, in one line."""

    @property
    def unconverged_steps(self) -> int:
        """Steps in which the solver reported that it ended early."""
