"""Contact with obstacles in a world: palpated's errors at rest in each pose with the obstacles in
its model and without, the plant's own penetration, and the difference between two worlds.
"""

from __future__ import annotations

import json
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable, Sequence

import numpy as np
import palpate
from convergence import sample_points
from live_run import RunFiles, RunPlan, replayed, run_live
from obstacles import Capsule, Cuboid, Cylinder, HalfSpace, Obstacle, Sphere, penetrations
from palpate import PointsInMesh
from rigid import Floats, Pose
from scene import Scene
from scipy.spatial.transform import Rotation

AGREEMENT = 1e-3  # m, mean difference of the two plants' shapes below which a pose counts as agreed
_REST = 0.5  # s at the end of a pose
_NO_OBSTACLE = "obstacles=[]"

Log = Any


@dataclass(frozen=True)
class Window:
    """The end of a pose's hold, s of simulated time."""

    name: str
    begin: float
    end: float


def windows(scene: Scene) -> list[Window]:
    result, end = [], scene.start_delay
    for leg in scene.legs:
        end += leg.move + leg.hold
        result.append(Window(leg.name, end - min(_REST, leg.hold), end))
    return result


def obstacles_of_configuration(scene: Scene) -> str:
    """The override that gives palpated the scene's obstacles."""
    X_WO = scene.body.pose
    return f"obstacles={json.dumps([_entry(each, X_WO) for each in scene.obstacles])}"


def _entry(obstacle: Obstacle, X_WO: Pose) -> dict[str, Any]:
    X_WS = X_WO @ obstacle.pose
    with warnings.catch_warnings():  # any of the angles will do where they are not unique
        warnings.simplefilter("ignore")
        angles = Rotation.from_matrix(X_WS.rotation).as_euler("xyz", degrees=True)
    return {
        "name": obstacle.name,
        **_shape(obstacle),
        "pose": {"position": X_WS.position.tolist(), "rpy_deg": angles.tolist()},
        "friction": obstacle.friction,
        "allowed": "contact",
    }


def _shape(obstacle: Obstacle) -> dict[str, Any]:
    shape = obstacle.shape
    if isinstance(shape, HalfSpace):
        return {"shape": "half_space"}
    if isinstance(shape, Cuboid):
        return {"shape": "box", "size": shape.size.tolist()}
    if isinstance(shape, Sphere):
        return {"shape": "sphere", "radius": shape.radius}
    kind = "capsule" if isinstance(shape, Capsule) else "cylinder"
    assert isinstance(shape, (Capsule, Cylinder))
    length = {} if shape.length is None else {"length": shape.length}
    return {"shape": kind, "radius": shape.radius, **length}


def measure(
    plan: RunPlan, scene: Scene, filtered: str, say: Callable[[str], None], folder: Path
) -> dict[str, Any]:
    """Runs pose alone live, with the obstacles in the model, the others on the same sensors;
    `filtered`: the override that selects the filter. Raises RunFailed, OSError, ValueError."""
    run = run_live(plan, folder)
    say("the run has ended; replays")
    files = {
        "pose alone": run,
        "filter": replayed(plan, run, [filtered], folder / "filter"),
        "pose alone, no obstacle": replayed(plan, run, [_NO_OBSTACLE], folder / "pose_without"),
    }
    ends = windows(scene)
    truth = _read(run)
    summary = json.loads((run.folder / "world.json").read_text(encoding="utf-8"))
    rows = {name: _errors(_read(each), ends) for name, each in files.items()}
    plants = [_plant_at(truth, scene, window.end) for window in ends]
    poses = [
        {
            "name": window.name,
            "estimators": {name: errors[i] for name, errors in rows.items()},
            **plants[i],
        }
        for i, window in enumerate(ends)
    ]
    return {"plant": summary["plant"], "penetration_mm": summary["penetration_mm"], "poses": poses}


def _read(files: RunFiles) -> Log:
    return palpate.read_log(files.control, files.housekeeping, clock="sent")


def _errors(log: Log, ends: Sequence[Window]) -> list[dict[str, float]]:
    error = palpate.shape_error(log)
    first = 1e-6 * float(log["SHAPE"].utime[0])
    rows = []
    for window in ends:
        at_rest = error.between(window.begin - first, window.end - first)
        rows.append({"mean_mm": 1e3 * at_rest.mean, "max_mm": 1e3 * at_rest.maximum})
    return rows


def _plant_at(log: Log, scene: Scene, time: float) -> dict[str, Any]:
    """Depth in each obstacle, mm, and places of material points, m, at the last true shape up to
    `time`, s."""
    mesh, truth = log.truth_mesh, log["TRUTH_SHAPE"]
    at = int(np.searchsorted(truth.utime, round(1e6 * time), side="right")) - 1
    positions = truth.positions[at]
    body = scene.body
    free = ~(body.clamp_box.contains(mesh.nodes) | body.grasp_box.contains(mesh.nodes))
    depths = penetrations(scene.obstacles, positions[free])
    points = sample_points(np.ptp(mesh.nodes, axis=0))
    return {
        "penetration_mm": {o.name: 1e3 * d for o, d in zip(scene.obstacles, depths.tolist())},
        "points": PointsInMesh(mesh, points).at(positions).tolist(),
    }


def disagreement(poses: Sequence[dict[str, Any]], others: Sequence[dict[str, Any]]) -> Floats:
    """Mean and largest distance of the material points in each pose, (poses, 2), m."""
    rows = []
    for pose, other in zip(poses, others):
        distance = np.linalg.norm(np.subtract(pose["points"], other["points"]), axis=1)
        rows.append([distance.mean(), distance.max()])
    return np.array(rows).reshape(-1, 2)


def worst(poses: Sequence[dict[str, Any]]) -> dict[str, dict[str, float]]:
    """Of each estimator, the largest mean and the largest error of any pose."""
    return {
        name: {key: max(pose["estimators"][name][key] for pose in poses) for key in errors}
        for name, errors in poses[0]["estimators"].items()
    }
