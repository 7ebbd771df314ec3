"""Balls on rails that press against the hand of an arm that Drake simulates, with known forces."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any, Sequence

import numpy as np
from pydrake.geometry import CollisionFilterDeclaration, GeometrySet, Sphere
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import CoulombFriction, MultibodyPlant
from pydrake.multibody.tree import FixedOffsetFrame, PrismaticJoint, SpatialInertia, UnitInertia
from pydrake.systems.framework import Context, DiagramBuilder, EventStatus, LeafSystem

HAND_RADIUS, RADIUS = 0.04, 0.02  # m: ball fixed to the hand, and each that presses
GAP = 1e-3  # m, to the hand before and after
MASS = 0.1  # kg
STIFFNESS, DAMPING = 400.0, 40.0  # N/m, N s/m: of what holds and brakes a ball on its rail
FRICTIONLESS = CoulombFriction(0.0, 0.0)


@dataclass(frozen=True)
class Push:
    """One contact: a trapezoid of force along a direction in W."""

    direction: Sequence[float]  # unit vector of the force on the hand
    force: float  # N
    begin: float  # s
    rise: float = 0.3  # s, and the same to fall
    hold: float = 0.5  # s

    @property
    def end(self) -> float:
        return self.begin + 2 * self.rise + self.hold

    def at(self, seconds: float) -> float:
        """N"""
        left = min(seconds - self.begin, self.end - seconds)
        return self.force * max(0.0, min(1.0, left / self.rise))


class Pushers:
    """One ball for each push, on a rail through the centre of a ball on the hand."""

    def __init__(
        self, plant: MultibodyPlant, still: MultibodyPlant, hand: str, pushes: Sequence[Push]
    ) -> None:
        """`plant`: with the arm, not final; `still`: the arm alone, whose default pose it keeps;
        `hand`: its link at whose origin they press."""
        self._plant, self._pushes = plant, pushes
        self._hand = plant.GetBodyByName(hand)
        self.noted: dict[str, list[Any]] = {"time": [], "utime": [], "force": [], "rotation": []}
        place = still.EvalBodyPoseInWorld(still.CreateDefaultContext(), still.GetBodyByName(hand))
        self._add_ball(self._hand, HAND_RADIUS)
        self._instance = plant.AddModelInstance("pushers")
        balls = GeometrySet()
        inertia = SpatialInertia(MASS, np.zeros(3), UnitInertia.SolidSphere(RADIUS))
        for number, push in enumerate(pushes):
            body = plant.AddRigidBody(f"ball_{number}", self._instance, inertia)
            balls.Add(self._add_ball(body, RADIUS))
            along = np.array(push.direction) / np.linalg.norm(push.direction)
            start = place.translation() - (HAND_RADIUS + RADIUS + GAP) * along
            pose = RigidTransform(RotationMatrix.MakeFromOneVector(along, 2), start)
            rail = plant.AddFrame(FixedOffsetFrame(f"rail_{number}", plant.world_frame(), pose))
            joint = PrismaticJoint(f"rail_joint_{number}", rail, body.body_frame(), [0, 0, 1])
            plant.AddJointActuator(f"rail_drive_{number}", plant.AddJoint(joint))
        self._balls = balls
        plant.set_gravity_enabled(self._instance, False)

    def _add_ball(self, body: Any, radius: float) -> Any:
        return self._plant.RegisterCollisionGeometry(
            body, RigidTransform(), Sphere(radius), f"{body.name()}_contact", FRICTIONLESS
        )

    def drive(self, builder: DiagramBuilder) -> None:
        """Once the plant is final."""
        (graph,) = (s for s in builder.GetSystems() if s.get_name() == "scene_graph")
        graph.collision_filter_manager().Apply(
            CollisionFilterDeclaration().ExcludeWithin(self._balls)
        )
        forces = builder.AddSystem(_Forces(self._pushes))
        state = self._plant.get_state_output_port(self._instance)
        builder.Connect(state, forces.get_input_port())
        drive = self._plant.get_actuation_input_port(self._instance)
        builder.Connect(forces.get_output_port(), drive)

    def note(self, root: Context) -> EventStatus:
        """Keeps the sum of the contact forces on the hand, N in W, with simulated time, s, the wall
        clock, us, and the hand's rotation."""
        context = self._plant.GetMyContextFromRoot(root)
        results = self._plant.get_contact_results_output_port().Eval(context)
        total = np.zeros(3)
        for index in range(results.num_point_pair_contacts()):
            pair = results.point_pair_contact_info(index)
            sign = 1 if pair.bodyB_index() == self._hand.index() else -1
            total += sign * pair.contact_force()
        rotation = self._plant.EvalBodyPoseInWorld(context, self._hand).rotation().matrix()
        self.noted["time"].append(root.get_time())
        self.noted["utime"].append(round(1e6 * time.time()))
        self.noted["force"].append(total.tolist())
        self.noted["rotation"].append(rotation.tolist())
        return EventStatus.DidNothing()


class _Forces(LeafSystem):  # type: ignore[misc]
    """Of the drives: a push while there is one, else of a spring to the start."""

    def __init__(self, pushes: Sequence[Push]) -> None:
        super().__init__()
        self._pushes = pushes
        self.DeclareVectorInputPort("state", 2 * len(pushes))
        self.DeclareVectorOutputPort("force", len(pushes), self._calculate)

    def _calculate(self, context: Context, output: Any) -> None:
        position, speed = np.split(self.get_input_port().Eval(context), 2)
        pushed = np.array([push.at(context.get_time()) for push in self._pushes])
        held = np.where(pushed > 0, pushed, -STIFFNESS * position)
        output.SetFromVector(held - DAMPING * speed)
