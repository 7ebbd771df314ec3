"""MuJoCo's flex as a plant: quadratic cells of 27 nodes (MuJoCo 4), integrated implicitly.

Held and clamped nodes are given a mass of _HEAVY and their prescribed velocity before each step.
The step changes that velocity by the elastic force on them over their mass, so imperceptibly; what
it changes, times the mass, is the force. MuJoCo's own equality constraints are soft.
"""

from __future__ import annotations

from typing import Sequence

import mujoco
import numpy as np
from mujoco_obstacles import OPTIONS, RADIUS, geoms, words
from object_mesh import ObjectMesh, hexahedra, volumes
from obstacles import Obstacle
from rigid import Floats, Pose
from scene import ObjectOptions

_HEAVY = 100.0  # kg, against fractions of a gram

# MuJoCo counts its warnings, too; without this it also writes them to a file where it runs.
mujoco.set_mju_user_warning(lambda text: None)


class MujocoPlant:
    """A box, or the part of a grid of cells that a mesh of tetrahedra fills."""

    def __init__(
        self,
        body: ObjectOptions,
        shape: ObjectMesh,
        cells: Sequence[int],
        gravity_O: Floats,
        X_OG: Pose,
        period: float = 0.002,
        damping: float = 0.02,
        obstacles: Sequence[Obstacle] = (),
    ) -> None:
        """`shape`: tetrahedra that fill the object, whose surface touches the obstacles;
        `gravity_O`: m/s^2; `X_OG`: pose of the grasp at rest; `damping`: s, proportional to
        stiffness. Raises ValueError."""
        self.period = period
        lower, upper = shape.nodes.min(axis=0), shape.nodes.max(axis=0)
        mass = body.density * float(volumes(shape.nodes, shape.elements).sum())
        self._model = _model(body, shape, cells, mass, gravity_O, period, damping, obstacles)
        self._data = mujoco.MjData(self._model)
        bodies = self._model.flex_nodebodyid.copy()
        borders = [
            lower[i] + (upper - lower)[i] * np.arange(n + 1) / n for i, n in enumerate(cells)
        ]
        # The middle node belongs to its cell alone; nodes of empty cells are fixed to the world.
        grid = bodies.reshape([2 * n + 1 for n in cells])
        self.mesh, used = hexahedra(borders, grid[1::2, 1::2, 1::2] > 0)
        bodies = bodies[used]
        self.clamped = np.flatnonzero(body.clamp_box.contains(self.mesh.nodes))
        self.held = np.flatnonzero(body.grasp_box.contains(self.mesh.nodes))
        for name, nodes in (("clamp_box", self.clamped), ("grasp_box", self.held)):
            if not len(nodes):
                raise ValueError(f"object.{name}: no node of MuJoCo's grid of cells lies in it")
        self._dofs = self._model.body_dofadr[bodies][:, None] + np.arange(3)
        self._held_masses = self._model.body_mass[bodies[self.held]].copy()
        for node in (*self.clamped, *self.held):
            self._model.body_mass[bodies[node]] = _HEAVY
            self._model.body_inertia[bodies[node]] = _HEAVY
            self._model.body_gravcomp[bodies[node]] = 1
        mujoco.mj_setConst(self._model, self._data)
        mujoco.mj_forward(self._model, self._data)
        self._gravity = gravity_O
        self._held_in_hand = X_OG.inverse().of(self.mesh.nodes[self.held])
        self._velocity = np.zeros((len(self.held), 3))
        self._wrench = np.zeros(6)

    @property
    def positions(self) -> Floats:
        return np.asarray(self.mesh.nodes + self._data.qpos[self._dofs])

    @property
    def hand_wrench(self) -> Floats:
        return self._wrench

    @property
    def unconverged_steps(self) -> int:
        """Steps in which MuJoCo's linear solver ended at its limit of iterations."""
        return int(self._data.warning[mujoco.mjtWarning.mjWARN_INERTIA].number)

    @property
    def remark(self) -> str:
        return (
            f"MuJoCo {mujoco.__version__}, {len(self.mesh.elements)} quadratic cells, "
            f"{len(self.mesh.nodes)} nodes, steps of {1e3 * self.period:g} ms"
        )

    def step(self, X_OG: Pose) -> None:
        rest = self.mesh.nodes[self.held]
        target = X_OG.of(self._held_in_hand)
        held, clamped = self._dofs[self.held], self._dofs[self.clamped]
        before = self._data.qpos[held] + rest
        velocity = (target - before) / self.period
        self._data.qvel[held] = velocity
        self._data.qvel[clamped] = 0
        mujoco.mj_step(self._model, self._data)
        elastic = _HEAVY * (self._data.qvel[held] - velocity) / self.period
        if not np.isfinite(elastic).all():
            raise RuntimeError("MuJoCo's solution diverged; use a smaller --period")
        inertial = (velocity - self._velocity) / self.period - self._gravity
        force = self._held_masses[:, None] * inertial - elastic
        self._data.qpos[held] = target - rest
        self._data.qpos[clamped] = 0
        self._velocity = velocity
        moment = np.cross(target - X_OG.position, force)
        self._wrench = np.concatenate([force.sum(axis=0), moment.sum(axis=0)])


def _model(
    body: ObjectOptions,
    shape: ObjectMesh,
    cells: Sequence[int],
    mass: float,
    gravity_O: Floats,
    period: float,
    damping: float,
    obstacles: Sequence[Obstacle],
) -> mujoco.MjModel:
    """The flex, with a body of three slide joints for each node of the grid, and the obstacles."""
    touches = 1 if obstacles else 0
    return mujoco.MjModel.from_xml_string(f"""<mujoco>
  <option gravity="{words(gravity_O)}" integrator="discrete" timestep="{period}"
      {OPTIONS}/>
  <size memory="2G"/>
  <worldbody>
    {geoms(obstacles, period)}
    <flexcomp name="object" type="direct" dim="3" origin="{words(shape.nodes.mean(axis=0))}"
        dof="quadratic" cellcount="{words(cells)}" radius="{RADIUS}" mass="{mass:.12g}"
        point="{words(shape.nodes)}" element="{words(shape.elements)}">
      <contact selfcollide="none" contype="{touches}" conaffinity="{touches}"/>
      <elasticity young="{body.young_modulus}" poisson="{body.poisson_ratio}" damping="{damping}"/>
    </flexcomp>
  </worldbody>
</mujoco>""")
