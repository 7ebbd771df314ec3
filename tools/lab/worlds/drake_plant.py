"""Drake's deformable body as a plant: linear tetrahedra of a co-rotated material, SAP.

The hand is a rigid body of _HEAVY that carries Drake's fixed constraints on the held nodes. It is
given its pose and velocity before each step; the change of its velocity in the step, times its
mass, is the wrench of the constraints. Elements of which all nodes are held, or clamped, do not
deform: they are left out, and the weight and inertia of held ones are added to the wrench.

Drake solves the motion without constraints before it applies them, linearised there. Steps that
are long without much damping let soft bodies fall far in between, and forces are wrong by newtons.
"""

from __future__ import annotations

import importlib.metadata
import tempfile
from pathlib import Path
from typing import Any, Sequence

import numpy as np
from drake_obstacles import add_obstacles, object_properties
from object_mesh import Ints, ObjectMesh, volumes
from obstacles import Obstacle
from pydrake.geometry import Box, GeometryInstance, Mesh
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.fem import DeformableBodyConfig, MaterialModel
from pydrake.multibody.math import SpatialVelocity
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, DiscreteContactApproximation
from pydrake.multibody.tree import SpatialInertia, UnitInertia
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder
from rigid import Floats, Pose, log_rotation
from scene import ObjectOptions

_HEAVY = 1000.0  # kg
_GYRATION = 0.1  # m^2, unit inertia about each axis
_MARGIN = 1e-6  # m, around boxes that select nodes


class DrakePlant:
    """An object of tetrahedra."""

    def __init__(
        self,
        body: ObjectOptions,
        shape: ObjectMesh,
        gravity_O: Floats,
        X_OG: Pose,
        period: float = 0.01,
        damping: float = 0.2,
        obstacles: Sequence[Obstacle] = (),
    ) -> None:
        """`gravity_O`: m/s^2; `X_OG`: pose of the grasp at rest; `damping`: s, proportional to
        stiffness. Raises ValueError."""
        self.mesh, self.period = shape, period
        self._damping, self._gravity = damping, gravity_O
        is_clamped = body.clamp_box.contains(shape.nodes)
        is_held = body.grasp_box.contains(shape.nodes)
        self.clamped, self.held = np.flatnonzero(is_clamped), np.flatnonzero(is_held)
        for name, nodes in (("clamp_box", self.clamped), ("grasp_box", self.held)):
            if not len(nodes):
                raise ValueError(f"object.{name}: no node of Drake's mesh lies in it")
        rigid = is_held[shape.elements].all(axis=1)
        fixed = is_clamped[shape.elements].all(axis=1)
        self._soft, soft_elements = np.unique(shape.elements[~(rigid | fixed)], return_inverse=True)
        soft_elements = soft_elements.reshape(-1, 4)
        self._X_OG = X_OG
        self._held_in_hand = X_OG.inverse().of(shape.nodes[self.held])
        self._rigid_masses = body.density * _nodal_volumes(shape, shape.elements[rigid])[self.held]
        self._held_velocity = np.zeros((len(self.held), 3))
        self._wrench = np.zeros(6)
        self._positions = shape.nodes.copy()

        builder = DiagramBuilder()
        self._plant, _ = AddMultibodyPlantSceneGraph(builder, period)
        self._plant.set_discrete_contact_approximation(DiscreteContactApproximation.kSap)
        self._plant.mutable_gravity_field().set_gravity_vector(gravity_O)
        self._hand = self._add_hand()
        add_obstacles(self._plant, obstacles)
        self._model = self._plant.deformable_model()
        self._body = self._register(
            body, shape.nodes[self._soft], soft_elements, object_properties(obstacles)
        )
        hand_box = _shape(body.grasp_box)
        X_GO = _transform(X_OG.inverse())
        world = self._plant.world_body()
        self._model.AddFixedConstraint(self._body, world, RigidTransform(), *_shape(body.clamp_box))
        self._model.AddFixedConstraint(
            self._body, self._hand, X_GO, hand_box[0], X_GO @ hand_box[1]
        )
        self._plant.Finalize()
        self._simulator = Simulator(builder.Build())
        self._context = self._plant.GetMyMutableContextFromRoot(
            self._simulator.get_mutable_context()
        )
        self._steps = 0

    @property
    def positions(self) -> Floats:
        return self._positions

    @property
    def hand_wrench(self) -> Floats:
        return self._wrench

    @property
    def unconverged_steps(self) -> int:
        return 0  # Drake raises an exception instead

    @property
    def remark(self) -> str:
        return (
            f"Drake {importlib.metadata.version('drake')}, {len(self.mesh.elements)} linear "
            f"tetrahedra, {len(self.mesh.nodes)} nodes, steps of {1e3 * self.period:g} ms, "
            f"damping {self._damping:g} s"
        )

    def step(self, X_OG: Pose) -> None:
        start = self._X_OG
        linear = (X_OG.position - start.position) / self.period
        angular = log_rotation(X_OG.rotation @ start.rotation.T) / self.period
        self._plant.SetFreeBodyPose(self._context, self._hand, _transform(start))
        self._plant.SetFreeBodySpatialVelocity(
            context=self._context, body=self._hand, V_JpJc=SpatialVelocity(angular, linear)
        )
        self._steps += 1
        self._simulator.AdvanceTo(self._steps * self.period)
        after = self._plant.EvalBodySpatialVelocityInWorld(self._context, self._hand)
        force = _HEAVY * (after.translational() - linear) / self.period
        torque = _HEAVY * _GYRATION * (after.rotational() - angular) / self.period
        if not np.isfinite(force).all():
            raise RuntimeError("Drake's solution diverged; use a smaller --period")
        self._X_OG = X_OG
        held = X_OG.of(self._held_in_hand)
        self._wrench = self._rigid_part(X_OG, held) - np.concatenate([force, torque])
        self._positions = self.mesh.nodes.copy()
        self._positions[self._soft] = self._model.GetPositions(self._context, self._body).T
        self._positions[self.held] = held

    def _rigid_part(self, X_OG: Pose, held: Floats) -> Floats:
        """Of the elements that are left out: inertia minus weight of their nodes, at G."""
        velocity = (held - self._positions[self.held]) / self.period
        acceleration = (velocity - self._held_velocity) / self.period
        self._held_velocity = velocity
        force = self._rigid_masses[:, None] * (acceleration - self._gravity)
        moment = np.cross(held - X_OG.position, force)
        return np.concatenate([force.sum(axis=0), moment.sum(axis=0)])

    def _register(
        self, body: ObjectOptions, nodes: Floats, elements: Ints, properties: Any
    ) -> Any:
        config = DeformableBodyConfig()
        config.set_youngs_modulus(body.young_modulus)
        config.set_poissons_ratio(body.poisson_ratio)
        config.set_mass_density(body.density)
        config.set_stiffness_damping_coefficient(self._damping)
        config.set_material_model(MaterialModel.kCorotated)
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "object.vtk"
            _write_vtk(file, nodes, elements)
            geometry = GeometryInstance(RigidTransform(), Mesh(str(file)), "object")
            geometry.set_proximity_properties(properties)
            return self._model.RegisterDeformableBody(geometry, config, 1.0)

    def _add_hand(self) -> Any:
        instance = self._plant.AddModelInstance("hand")
        self._plant.set_gravity_enabled(instance, False)
        inertia = UnitInertia(_GYRATION, _GYRATION, _GYRATION)
        return self._plant.AddRigidBody(
            "hand", instance, SpatialInertia(_HEAVY, np.zeros(3), inertia)
        )


def _transform(pose: Pose) -> RigidTransform:
    return RigidTransform(RotationMatrix(pose.rotation), pose.position)


def _shape(box: Any) -> tuple[Box, RigidTransform]:
    """That selects the nodes in the box, and its pose in O."""
    return Box(*(box.upper - box.lower + 2 * _MARGIN)), RigidTransform((box.lower + box.upper) / 2)


def _nodal_volumes(shape: ObjectMesh, elements: Ints) -> Floats:
    """A quarter of each of these elements for each of its nodes, m^3."""
    quarter = np.repeat(volumes(shape.nodes, elements) / 4, 4)
    return np.asarray(np.bincount(elements.ravel(), quarter, len(shape.nodes)), float)


def _write_vtk(file: Path, nodes: Floats, elements: Ints) -> None:
    """Drake reads deformable meshes from legacy VTK files alone."""
    with open(file, "w", encoding="ascii") as text:
        text.write("# vtk DataFile Version 3.0\nobject\nASCII\nDATASET UNSTRUCTURED_GRID\n")
        text.write(f"POINTS {len(nodes)} double\n")
        np.savetxt(text, nodes, "%.12g")
        text.write(f"CELLS {len(elements)} {5 * len(elements)}\n")
        np.savetxt(text, np.column_stack([np.full(len(elements), 4), elements]), "%d")
        text.write(f"CELL_TYPES {len(elements)}\n" + "10\n" * len(elements))
