"""Models that `palpate-fit export` writes, settled under their weight by MuJoCo and Drake."""

from __future__ import annotations

import json
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Callable, Sequence

import numpy as np
from rigid import Floats

_SETTLED = 1e-7  # m, motion of a node in the last of _CHECKED seconds
_CHECKED = 0.2  # s
_LONGEST = 60.0  # s, simulated


@dataclass
class Exported:
    """A folder that `palpate-fit export` has written."""

    folder: Path
    undeformed: Floats  # (n, 3), m, in W: the nodes of palpate's model, which come first
    under_weight: Floats  # likewise, by palpate's statics
    farthest: int  # the node that moves farthest
    nodes: int  # of the exported mesh
    gravity: Floats  # m/s^2

    @property
    def sag(self) -> float:
        """Displacement of the farthest node by palpate's statics, m."""
        return self.sag_of(self.under_weight)

    def sag_of(self, positions: Floats) -> float:
        """Of the same node along palpate's displacement, m. `positions`: of all nodes."""
        way = self.under_weight[self.farthest] - self.undeformed[self.farthest]
        moved = positions[self.farthest] - self.undeformed[self.farthest]
        return float(moved @ way / np.linalg.norm(way))


def export(program: Path, configuration: Path, folder: Path, words: Sequence[str]) -> Exported:
    """Runs `palpate-fit export`. Raises ValueError with its message."""
    command = [program, "export", configuration, "--output", folder, *words]
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode != 0:
        raise ValueError(done.stderr.strip())
    content = json.loads((folder / "model.json").read_text(encoding="utf-8"))
    return Exported(
        folder,
        np.array(content["undeformed"]),
        np.array(content["under_weight"]),
        content["farthest_node"],
        content["nodes"],
        np.array(content["gravity"]),
    )


def settle_mujoco(exported: Exported) -> Floats:
    """Positions at rest of the nodes of palpate's model, (n, 3), m."""
    import mujoco

    # It warns of an ill-conditioned stiffness, also into a file where it runs.
    mujoco.set_mju_user_warning(lambda text: None)
    model = mujoco.MjModel.from_xml_path(str(exported.folder / "model.xml"))
    data = mujoco.MjData(model)
    # Flexes of several materials list nodes by their own order; bodies bear the nodes' numbers.
    numbers, bodies = [], []
    for body in range(1, model.nbody):
        numbers.append(int(model.body(body).name.removeprefix("node_")))
        bodies.append(body)

    def positions() -> Floats:
        result = exported.undeformed.copy()
        for number, body in zip(numbers, bodies):
            if number < len(result):
                result[number] = data.xpos[body]
        return result

    def advance(time: float) -> None:
        while data.time < time - 1e-9:
            mujoco.mj_step(model, data)
        mujoco.mj_kinematics(model, data)

    return _settle(advance, positions)


def settle_drake(exported: Exported, period: float = 0.01) -> Floats:
    """Positions at rest of the nodes of palpate's model, (n, 3), m. `period`: s, of a step."""
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, DiscreteContactApproximation
    from pydrake.systems.analysis import Simulator
    from pydrake.systems.framework import DiagramBuilder

    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlantSceneGraph(builder, period)
    plant.set_discrete_contact_approximation(DiscreteContactApproximation.kSap)
    plant.mutable_gravity_field().set_gravity_vector(exported.gravity)
    Parser(plant).AddModels(str(exported.folder / "model.sdf"))
    plant.Finalize()
    simulator = Simulator(builder.Build())
    context = plant.GetMyContextFromRoot(simulator.get_context())
    deformable = plant.deformable_model()
    body = deformable.GetBodyByName("object").body_id()

    def positions() -> Floats:
        all_nodes = np.asarray(deformable.GetPositions(context, body)).T
        return all_nodes[: len(exported.undeformed)].copy()

    return _settle(lambda time: simulator.AdvanceTo(time), positions)


SETTLE = {"mujoco": settle_mujoco, "drake": settle_drake}


def _settle(advance: Callable[[float], None], positions: Callable[[], Floats]) -> Floats:
    """Simulates until no node moves. Raises RuntimeError if that takes too long."""
    before = positions()
    time = 0.0
    while time < _LONGEST:
        time += _CHECKED
        advance(time)
        now = positions()
        if not np.isfinite(now).all():
            raise RuntimeError("the solution diverged")
        if np.linalg.norm(now - before, axis=1).max() < _SETTLED:
            return now
        before = now
    raise RuntimeError(f"still moves after {_LONGEST:g} s")


def extrapolated(coarse: float, fine: float) -> float:
    """Value for elements of size zero from sizes h and h/2, for errors of second order."""
    return fine + (fine - coarse) / 3
