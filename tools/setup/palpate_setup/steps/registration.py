"""Step registration: where the object is, by touches and a cloud."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

from palpate_common.input_error import InputError
from palpate_common.rotations import from_wxyz, log_rotation
from palpate_common.section import plain, read_section
from palpate_setup.cell import configuration_of
from palpate_setup.project import Project
from palpate_setup.questions import CHOICE, NUMBER, NUMBERS, TEXT, WHOLE, Question
from palpate_setup.step import Result, Setting, Step, Work
from palpate_setup.touching import touch_until_known

Floats = NDArray[np.float64]
Z95 = 1.959964
PRIOR = ("pose_position_deviation", "pose_rotation_deviation", "clamp_deviation")
LEAST_TOUCHES = 3


def _by_file(answers: Any) -> bool:
    return bool(answers["touches"] == "file")


def _by_robot(answers: Any) -> bool:
    return bool(answers["touches"] == "robot")


class Registration(Step):
    name = "registration"
    title = "Registration"
    about = "Pose of the object in the robot's base, by palpate-register from touches, a cloud, or both."
    needs = ("wrist", "object")

    def questions(self, project: Project) -> list[Question]:
        return [
            *self._guess(),
            Question("guess_range", "How far it may be off along each axis", NUMBER, "m", 0.05, 1e-4, 10),
            Question("guess_angle", "and turned", NUMBER, "degrees", 20.0, 0.01, 180),
            Question("touches", "Touches: made now by the robot (robot), of a file (file), or none", CHOICE, default="robot",
                     choices=("robot", "file", "none")),
            Question("touch_file", "CSV of touched points (palpate-register --help)", TEXT, when=_by_file),
            Question("count", "Number of touches", WHOLE, "", 12, LEAST_TOUCHES, 100, when=_by_robot),
            Question("touch_force", "Force at which a touch ends", NUMBER, "N", 0.3, 0.02, 20, when=_by_robot),
            Question("force_play", "Play of the force by friction of the sensor's cables (0: none)", NUMBER, "N", 0.0, 0, 10,
                     when=_by_robot),
            Question("tip_in_grasp", "Centre of the tip that touches, in the grasp frame", NUMBERS, "m", [0.0, 0.0, 0.0], -1, 1,
                     when=_by_robot),
            Question("deviation", "Standard deviation of a touched point along each axis", NUMBER, "m", 3e-4, 1e-6, 0.1),
            Question("probe_radius", "Radius of the tip", NUMBER, "m", 0.0, 0, 0.1),
            Question("cloud", "Cloud of the object's points in W (.ply, .pcd, .xyz, .npy; empty: none)", TEXT, default=None),
            Question("camera_deviation", "Standard deviation of the camera's place along each axis", NUMBER, "m", 0.02, 1e-6, 10,
                     when=lambda a: a["cloud"]),
            Question("camera_angle_deviation", "and of its angles", NUMBER, "degrees", 2.0, 0.01, 180, when=lambda a: a["cloud"]),
            Question("table", "Height in W below which nothing is touched (empty: there is no table)", NUMBER, "m", None, -10, 10),
        ]  # fmt: skip

    @staticmethod
    def _guess() -> list[Question]:
        return [Question("position", "About where the origin of O is in W", NUMBERS, "m", low=-10, high=10),
                Question("rpy_deg", "and how O is turned: roll, pitch, yaw", NUMBERS, "degrees", [0.0, 0.0, 0.0], -360, 360)]  # fmt: skip

    def questions_to_skip(self, project: Project) -> list[Question]:
        return [*self._guess(), Question("position_deviation", "Standard deviation of each axis", NUMBER, "m", 0.002, 1e-6, 0.1),
                Question("angle_deviation", "and of the angles", NUMBER, "degrees", 1.0, 1e-4, 57)]  # fmt: skip

    def run(self, work: Work) -> Result:
        answers = work.answers
        guess = Setting("frames.object_in_base", {"position": answers["position"], "rpy_deg": answers["rpy_deg"]}, "guess")
        base = configuration_of(work, "registration.yaml", [guess])
        result = Result()
        touches: Optional[Path] = None
        if answers["touches"] == "file":
            touches = work.file("touch_file")
            result.files.append(touches)
        elif answers["touches"] == "robot":
            touches = touch(work, guess, base)
        cloud = work.file("cloud") if answers["cloud"] else None
        if touches is None and cloud is None:
            raise InputError("touches: none, and no cloud; allowed: one of them, or --skip registration with a typed pose")
        summary = register(work, base, touches, cloud)
        if cloud is not None:
            result.files.append(cloud)
        written = plain(read_section(work.folder / "registered.yaml").values)
        self._settings(result, written, summary)
        result.lines += _lines(summary)
        result.pictures.append(work.shown("registration.png"))
        _refuse_vague(summary)
        return result

    def _settings(self, result: Result, written: Any, summary: Any) -> None:
        deviations = np.sqrt(np.diag(np.array(summary["covariance_of_center"])))
        position, angle = 1e3 * Z95 * deviations[:3].max(), np.degrees(Z95 * deviations[3:].max())
        pose = {key: value for key, value in written["frames"]["object_in_base"].items() if value is not None}
        origin = (f"palpate-register: {len(summary['touch_distances'])} touches"
                  f"{' and a cloud' if 'camera_error' in summary else ''}; 95 % within {position:.2g} mm and {angle:.2g} degrees\n"
                  f"{summary['fit']['text']}")  # fmt: skip
        result.settings.append(Setting("frames.object_in_base", pose, origin))
        result.settings += [Setting(f"estimation.{key}", float(f"{written['estimation'][key]:.3g}"),
                                    "the filter's prior, from the registration's covariance") for key in PRIOR]  # fmt: skip
        result.data = {"pose": pose, "position_half_width_mm": position, "angle_half_width_deg": angle}

    def skip(self, work: Work) -> Result:
        answers = work.answers
        pose = {"position": answers["position"], "rpy_deg": answers["rpy_deg"]}
        angle = float(np.radians(answers["angle_deviation"]))
        values = (answers["position_deviation"], angle, answers["position_deviation"])
        settings = [Setting("frames.object_in_base", pose, "typed, not measured")]
        settings += [Setting(f"estimation.{key}", value, "typed") for key, value in zip(PRIOR, values)]
        return Result([f"origin at {answers['position']} m, typed"], settings, data={"pose": pose})


def register(work: Work, base: Path, touches: Optional[Path], cloud: Optional[Path]) -> Any:
    """Runs palpate-register; its results as JSON. Raises InputError if the mesh does not fit."""
    answers = work.answers
    table = work.folder / "registration.json"
    words: list[object] = ["--config", base, "--guess-range", answers["guess_range"], answers["guess_angle"], "--deviation",
                           answers["deviation"], "--probe-radius", answers["probe_radius"], "--output", work.folder / "registered.yaml",
                           "--json", table, "--picture", work.folder / "registration.png"]  # fmt: skip
    if touches is not None:
        words += ["--touches", touches]
    if cloud is not None:
        words += ["--cloud", cloud, "--camera-deviation", answers["camera_deviation"], answers["camera_angle_deviation"]]
    if answers["table"] is not None:
        words += ["--table", answers["table"]]
    table.unlink(missing_ok=True)
    text = work.programs.run("palpate-register", *words, allowed=(0, 1), say=work.person.say)
    if not table.exists():
        raise InputError(f"palpate-register has failed: {text.strip() or 'see its message'}")
    summary = json.loads(table.read_text())
    if summary["fit"]["fits"] is False:
        raise InputError(summary["fit"]["text"])
    return summary


def _lines(summary: Any) -> list[str]:
    deviations = np.sqrt(np.diag(np.array(summary["covariance_of_center"])))
    turn = np.degrees(log_rotation(from_wxyz(np.array(summary["object_in_base"]["quaternion"]))))
    lines = [f"centre {axis}: {1e3 * value:.2f} +- {1e3 * Z95 * deviation:.2f} mm"
             for axis, value, deviation in zip("xyz", summary["center"], deviations)]  # fmt: skip
    lines += [f"rotation vector {axis}: {value:.3f} +- {np.degrees(Z95 * deviation):.3f} degrees"
              for axis, value, deviation in zip("xyz", turn, deviations[3:])]  # fmt: skip
    lines += [f"fit: {summary['fit']['text']}", f"symmetry: {summary['symmetry']['text']}"]
    if "camera_error" in summary:
        lines.append(f"the camera is off by {[round(1e3 * value, 1) for value in summary['camera_error']['shift']]} mm")
    return lines


def _refuse_vague(summary: Any) -> None:
    """Raises InputError where the pose is not determined."""
    if summary["undetermined"]:
        proposal = summary["next_touches"][0] if summary["next_touches"] else None
        advice = (f"; touch next along {np.round(proposal['approach'], 2).tolist()} onto {np.round(proposal['point'], 3).tolist()} m"
                  if proposal else "")  # fmt: skip
        raise InputError(f"the points do not determine {', '.join(summary['undetermined'])}{advice}")
    if summary["other_poses"]:
        raise InputError(f"{len(summary['other_poses'])} other poses explain the points nearly as well; more touches decide")


def touch(work: Work, guess: Setting, base: Path) -> Path:
    """Touches of the robot, each proposed from those before; the file of touched points."""
    path = work.folder / "touches.csv"

    def propose() -> Optional[tuple[Floats, Floats]]:
        proposals = register(work, base, path, None)["next_touches"]
        return (np.array(proposals[0]["point"]), np.array(proposals[0]["approach"])) if proposals else None

    touch_until_known(work, guess, path, propose)
    return path
