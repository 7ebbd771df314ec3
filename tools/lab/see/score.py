"""What palpate-see's steps publish of drawn scenes, and which of the points are not the object's."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from depth_camera import FOCAL, HEIGHT, WIDTH
from goal_text import goal_line
from rays import Floats, depth_below, distance_to_boxes
from scenes import BAR, CAMERA_ANGLE, CAMERA_POSITION, TABLE_ERROR, Scene
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation
from scipy.stats import chi2

from palpate_see.cloud import Cloud
from palpate_see.configuration import read_settings
from palpate_see.depth_images import back_project
from palpate_see.pipeline import Pipeline
from palpate_see.robot_body import RobotBody

MOST_WRONG = 0.01  # share of all published points
FAR = 5.0  # standard deviations of the depth, beyond which a point is wrong whatever it was measured on
WITHIN_95 = float(np.sqrt(chi2.ppf(0.95, 3)))  # standard deviations of each axis, of the length of an error
NEAR = 0.02  # m, from a published point to the visible surface that it covers


def _configuration(scene: Scene, urdf: Path, folder: Path) -> Path:
    """As a user would write it: the calibrated camera, a wide box, what is known of table and clamp; defaults otherwise."""
    clamp = {"name": "clamp", "shape": "box", "size": list(scene.clamp.size), "pose": {"position": scene.clamp.p.tolist()}}
    table = {"name": "table", "shape": "half_space", "pose": {"position": [0.0, 0.0, scene.table_height]}}
    palpated = {"robot": {"urdf": str(urdf)}, "obstacles": [table, clamp]}
    (folder / "palpated.yaml").write_text(yaml.safe_dump(palpated))
    x, y, z, w = Rotation.from_matrix(scene.R_believed).as_quat().tolist()
    see = {
        "configuration": "palpated.yaml",
        "camera_in_base": {"position": scene.p_believed.tolist(), "quaternion": [w, x, y, z]},
        "intrinsics": {"width": WIDTH, "height": HEIGHT, "fx": FOCAL, "fy": FOCAL},
        "crop": {"lower": [0.6, -0.4, 0.2], "upper": [1.6, 0.4, 0.8]},
        "camera_error": {"position": WITHIN_95 * CAMERA_POSITION, "angle_deg": WITHIN_95 * float(np.degrees(CAMERA_ANGLE))},
        "obstacles": {"deviation": TABLE_ERROR},
        "robot": {},
    }
    path = folder / "see.yaml"
    path.write_text(yaml.safe_dump(see))
    return path


def score(scene: Scene, urdf: Path, kind: str) -> dict[str, Any]:
    """Numbers of one scene, given as an `image` or as a `cloud` without order: published, wrong, of which bodies, share of
    the visible object that is covered, time, s, counters."""
    with tempfile.TemporaryDirectory() as name:
        settings = read_settings(_configuration(scene, urdf, Path(name)))
    assert settings.robot is not None and settings.intrinsics is not None
    body = RobotBody(settings.robot)
    body.add_arm(0, [scene.angles[joint] for joint in settings.robot.arm_joints])
    body.add_hand(0, [scene.angles[joint] for joint in settings.robot.hand_joints])
    pipeline = Pipeline(settings, body)
    begin = time.process_time()
    points_C = back_project(scene.picture.depth, settings.intrinsics)
    at_edges = settings.edges.of_image(scene.picture.depth).reshape(-1) if kind == "image" else None
    seen = pipeline.process(Cloud(1, points_C, at_edges=at_edges))
    elapsed = time.process_time() - begin
    points = np.zeros((0, 3)) if seen is None else settings.X_WC.inverse_of(seen.points)
    labels, far = _judged(scene, points)
    wrong = (labels != BAR) | far
    counts = {str(label): int((labels[wrong] == label).sum()) for label in np.unique(labels[wrong])}
    return {"published": len(points), "wrong": int(wrong.sum()), "wrong_by_label": counts, "far": int(far.sum()),
            "covered": _covered(scene, points), "seconds": elapsed, "counters": pipeline.counters.points}  # fmt: skip


def _judged(scene: Scene, points: Floats) -> tuple[Any, Any]:
    """Label that each point, (n, 3), m, in C, was measured on, and whether it is far from the true surface."""
    columns = np.rint(FOCAL * points[:, 0] / np.maximum(points[:, 2], 1e-9) + (WIDTH - 1) / 2).astype(int)
    rows = np.rint(FOCAL * points[:, 1] / np.maximum(points[:, 2], 1e-9) + (HEIGHT - 1) / 2).astype(int)
    labels = scene.picture.label[rows, columns]
    truly = points @ scene.R.T + scene.p
    deviation = 0.0012 + 0.0019 * (points[:, 2] - 0.4) ** 2 + points[:, 2] ** 2 / (FOCAL * 0.075) / 16
    off = distance_to_boxes(truly, scene.bar) + depth_below(truly, scene.bar)
    return labels, off > FAR * deviation


def _covered(scene: Scene, points: Floats) -> float:
    """Share of the object's pixels whose measured place is within NEAR of a published point."""
    rows, columns = np.nonzero((scene.picture.label == BAR) & (scene.picture.truth == BAR))
    z = scene.picture.depth[rows, columns]
    places = np.stack([(columns - (WIDTH - 1) / 2) / FOCAL * z, (rows - (HEIGHT - 1) / 2) / FOCAL * z, z], axis=1)
    if len(points) == 0 or len(places) == 0:
        return 0.0
    distance, _ = cKDTree(points).query(places)
    return float((distance <= NEAR).mean())


def text_of(kind: str, results: list[dict[str, Any]]) -> tuple[str, dict[str, float]]:
    """Of images or clouds: lines with the goal, what was reached and whether it is met; and the numbers."""
    published, wrong = sum(r["published"] for r in results), sum(r["wrong"] for r in results)
    share = wrong / published if published else 1.0
    worst = max((r["wrong"] / r["published"] if r["published"] else 1.0) for r in results)
    least, covered = min(r["published"] for r in results), [r["covered"] for r in results]
    seconds = float(np.median([r["seconds"] for r in results]))
    by_label: dict[str, int] = {}
    for result in results:
        for label, count in result["wrong_by_label"].items():
            by_label[label] = by_label.get(label, 0) + count
    names = {"1": "the object, far off", "2": "table", "3": "clamp", "4": "robot", "100": "mixtures", "-1": "nothing"}
    of = ", ".join(f"{names[label]} {count}" for label, count in sorted(by_label.items())) or "none"
    others = [
        ("  in the worst scene", f"{100 * worst:.2f} %"),
        ("  of what", of),
        ("published per scene, least", f"{least}"),
        (f"object's pixels within {1e3 * NEAR:.0f} mm of a point, mean", f"{100 * np.mean(covered):.1f} %"),
        ("  in the worst scene", f"{100 * min(covered):.1f} %"),
        (f"processor time per {kind} of {WIDTH} x {HEIGHT}, median", f"{1e3 * seconds:.0f} ms"),
    ]
    lines = [
        f"bar on a table, clamped, in the robot's hand, as {kind}: {len(results)} scenes, {published} published points",
        goal_line("points that are not the object's", f"{100 * share:.2f} %", f"at most {100 * MOST_WRONG:g} %",
                  share <= MOST_WRONG),
        *(f"  {what:50}{reached:>26}" for what, reached in others),
    ]  # fmt: skip
    numbers = {"wrong_percent": 100 * share, "worst_percent": 100 * worst, "published_least": least,
               "covered_percent": 100 * float(np.mean(covered)), "covered_least_percent": 100 * min(covered),
               "milliseconds": 1e3 * seconds}  # fmt: skip
    return "\n".join(lines), numbers
