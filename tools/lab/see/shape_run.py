"""One drawn run of palpate-sim, estimated with palpate-see's points, with perfectly segmented ones and with none."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from goal_text import bootstrap, goal_line
from rays import Floats
from scenes import looking
from scipy.spatial.transform import Rotation
from scipy.stats import chi2
from simulated_run import SOURCE, palpate_package, run

SCENE = SOURCE / "sim/scenes/bar_long_soft_control_cloud.yaml"
CONFIGURATION = SOURCE / "rt/config/examples/bar_long_soft.yaml"
MIDDLE = np.array([1.11, 0, 0.31])  # m, in W, of the bar at rest
MODULUS = 30e3  # Pa, as palpated believes
# Standard deviations: of a calibrated camera (tools/lab/uncertainty/calibrated.yaml) and of the reported pose of a hand that is
# not calibrated (uncalibrated.yaml), each axis; of log E; of the force's bias.
CAMERA_POSITION, CAMERA_ANGLE_DEG, HAND_POSITION, HAND_ANGLE_DEG = 0.001, 0.1, 0.002, 1.0  # m and degrees
LOG_MODULUS, FORCE_BIAS = 0.5, 0.08  # N
WITHIN_95 = float(np.sqrt(chi2.ppf(0.95, 3)))  # standard deviations of each axis, of the length of an error
PROCESSING_US = 50_000  # from a cloud's arrival to palpate-see's message, on a slow computer
START = 0.5  # s, from which the shape is scored
KINDS = ("seen", "truth", "blind")
MOST = 1.2  # times the error with perfectly segmented points


@dataclass(frozen=True, eq=False)
class Run:
    """settings: of the scene. R, p: pose of the camera in W as configured."""

    settings: list[str]
    R: Floats
    p: Floats


def _list(values: Any) -> str:
    return "[" + ", ".join(f"{float(value):.9g}" for value in np.ravel(values)) + "]"


def _pose(random: np.random.Generator, position: float, angle_deg: float) -> str:
    return f"{{position: {_list(position * random.normal(size=3))}, rpy_deg: {_list(angle_deg * random.normal(size=3))}}}"


def draw(seed: int) -> Run:
    """Motion of the hand, place of the camera and errors of a seed."""
    random = np.random.default_rng([2025, seed])
    azimuth, elevation = random.uniform(-np.pi / 2, np.pi / 2), random.uniform(np.radians(25), np.radians(60))
    target = MIDDLE + random.uniform(-0.05, 0.05, 3)
    sideways = np.array([np.sin(azimuth), -np.cos(azimuth), 0]) * np.cos(elevation)
    p = target + random.uniform(0.8, 1.1) * (sideways + np.array([0, 0, np.sin(elevation)]))
    R = looking(p, target)
    poses = []
    for _ in range(2):
        way = random.uniform([-0.04, -0.1, -0.08], [0.01, 0.1, 0.12])
        turn = random.uniform(-25, 25, 3)
        poses.append(f"{{move: 1.5, hold: 0.5, translation: {_list(way)}, rotation_deg: {_list(turn)}}}")
    x, y, z, w = Rotation.from_matrix(R).as_quat()
    return Run([
        f"seed={seed}",
        "object.elements=[10, 1, 1]",
        f"motion={{start_delay: 0.5, poses: [{', '.join(poses)}]}}",
        f"camera={{pose: {{position: {_list(p)}, quaternion: {_list([w, x, y, z])}}}, occlusions: [], "
        "truth_segmentation: true, segmentation: truth, cloud: {stride: 4}}",
        f"sensors.camera={{rate: 10, depth: {{noise: 1, disparity_step: 0.125}}, "
        f"calibration_error: {_pose(random, CAMERA_POSITION, CAMERA_ANGLE_DEG)}}}",
        f"sensors.kinematics_error={_pose(random, HAND_POSITION, HAND_ANGLE_DEG)}",
        f"sensors.force_torque.bias={_list([*(FORCE_BIAS * random.normal(size=3)), 0, 0, 0])}",
        f"object.material.young_modulus={MODULUS * np.exp(LOG_MODULUS * random.normal()):.9g}",
    ], R, p)  # fmt: skip


def see_configuration(of: Run, folder: Path) -> Path:
    """As a user writes it: the configured pose with its error, a wide box, the rig's block; no colour, defaults otherwise."""
    rig = {"name": "rig", "shape": "box", "size": [0.03, 0.096, 0.096], "pose": {"position": [1.375, 0.0, 0.31]}}
    (folder / "palpated.yaml").write_text(yaml.safe_dump({"obstacles": [rig]}))
    x, y, z, w = Rotation.from_matrix(of.R).as_quat().tolist()
    (folder / "see.yaml").write_text(yaml.safe_dump({
        "configuration": "palpated.yaml",
        "camera_in_base": {"position": of.p.tolist(), "quaternion": [w, x, y, z]},
        "crop": {"lower": [0.6, -0.4, 0.0], "upper": [1.5, 0.4, 0.7]},
        "camera_error": {"position": WITHIN_95 * CAMERA_POSITION, "angle_deg": WITHIN_95 * CAMERA_ANGLE_DEG},
        "robot": {"urdf": str(SOURCE / "sim/robot/lwr_hand.urdf")},
    }))  # fmt: skip
    return folder / "see.yaml"


def _log_of(kind: str, folder: Path, palpate: Any) -> Path:
    """Sensors of the run with one kind of observations, each at the time at which it would have come."""
    observation = "SHAPE_OBSERVATION"
    events = [(event.utime, event.channel, event.data) for event in palpate.EventLog(folder / "sensors.log")
              if kind == "truth" or event.channel != observation]  # fmt: skip
    if kind == "seen":
        arrival = {}
        for event in palpate.EventLog(folder / "clouds.log"):
            arrival[int.from_bytes(event.data[8:16], "big")] = event.utime  # utime is the message's first field
        events += [(arrival[event.utime] + PROCESSING_US, observation, event.data)
                   for event in palpate.EventLog(folder / "seen.log")]  # fmt: skip
        events.sort(key=lambda event: event[0])
    path = folder / f"with_{kind}.log"
    with palpate.EventLogWriter(path) as writer:
        for event in events:
            writer.write(*event)
    return path


def _points() -> Floats:
    """(n, 3), m, in O at rest: on the bar's surface, between the clamp and the hand."""
    across = [[y, z] for y in (0, 0.03, 0.06) for z in (0, 0.03, 0.06) if (y, z) != (0.03, 0.03)]
    return np.array([[x, y, z] for x in np.linspace(0.02, 0.44, 15) for y, z in across])


def _errors(log: Any, truth: Any, palpate: Any) -> Floats:
    """(times, points), m: distances of the estimated from the true points, in O, from START on."""
    from palpate.mesh import PointsInMesh

    shapes, true_shapes = log["SHAPE"], truth["TRUTH_SHAPE"]
    points = [PointsInMesh(log.meshes()[int(shapes.mesh_hash[0])], _points()).at(shapes.positions),
              PointsInMesh(truth.meshes("TRUTH_MESH")[int(true_shapes.mesh_hash[0])], _points()).at(true_shapes.positions)]  # fmt: skip
    times, true_times = shapes.sent_utime, true_shapes.sent_utime
    nearest = np.abs(times[:, None] - true_times[None]).argmin(axis=1)
    counts = times > 1e6 * START
    distances: Floats = np.linalg.norm(points[0][counts] - points[1][nearest[counts]], axis=-1)
    return distances


def score(seed: int, binaries: Path, folder: Path) -> dict[str, Any]:
    """Mean and largest error of the shape by kind of observation, m, and the numbers of observations and of their points."""
    palpate, of = palpate_package(), draw(seed)
    folder.mkdir(parents=True, exist_ok=True)
    settings = [word for setting in of.settings for word in ("--set", setting)]
    run(binaries / "palpate-sim", SCENE, "--record", folder, *settings)
    run(binaries / "palpate-see", "--config", see_configuration(of, folder), "--log", folder / "clouds.log", "--joints",
        folder / "sensors.log", "--output", folder / "seen.log")  # fmt: skip
    truth = palpate.read_log(folder / "truth.log")
    result: dict[str, Any] = {"seed": seed}
    for kind in KINDS:
        log = _log_of(kind, folder, palpate)
        run(binaries / "palpate-replay", log, "--config", CONFIGURATION, "--set", "estimation.component=pose_wrench_filter",
            "--start", "--output", folder / "replay.log")  # fmt: skip
        errors = _errors(palpate.read_log(folder / "replay.log"), truth, palpate)
        result[kind] = {"mean": float(errors.mean()), "largest": float(errors.max())}
        if kind != "blind":
            counts = palpate.read_log(log)["SHAPE_OBSERVATION"].array("count")
            result[kind] |= {"observations": len(counts), "points": float(np.mean(counts))}
    for log in folder.glob("*.log"):
        log.unlink()
    return result


def text_of(runs: list[dict[str, Any]]) -> tuple[str, dict[str, float]]:
    """Lines with the goal, what was reached and whether it is met; and the numbers."""
    errors = {kind: np.array([run[kind]["mean"] for run in runs]) for kind in ("seen", "truth", "blind")}
    ratios = errors["seen"] / errors["truth"]
    pooled = float(errors["seen"].mean() / errors["truth"].mean())
    low, high = bootstrap(ratios) if len(ratios) > 1 else (pooled, pooled)
    rows = [(f"error {name}, mean", f"{1e3 * errors[kind].mean():.2f} mm") for kind, name in
            (("seen", "with palpate-see"), ("truth", "with perfectly segmented points"), ("blind", "without a camera"))]  # fmt: skip
    rows += [("ratio of each run, mean and its 95 % interval", f"{ratios.mean():.2f}, {low:.2f} to {high:.2f}"),
             ("  in the worst run", f"{ratios.max():.2f}"),
             ("observations by palpate-see, share of the clouds",
              f"{100 * np.mean([run['seen']['observations'] / run['truth']['observations'] for run in runs]):.0f} %")]  # fmt: skip
    lines = [f"bar in the robot's hand before a camera: {len(runs)} runs",
             goal_line("shape error, times that with perfect segmentation", f"{pooled:.2f}", f"at most {MOST:g}", pooled <= MOST),
             *(f"  {what:50}{reached:>26}" for what, reached in rows)]  # fmt: skip
    return "\n".join(lines), {"ratio": pooled, "ratio_low": low, "ratio_high": high, "ratio_worst": float(ratios.max()),
                              **{f"{kind}_mm": 1e3 * float(values.mean()) for kind, values in errors.items()}}  # fmt: skip
