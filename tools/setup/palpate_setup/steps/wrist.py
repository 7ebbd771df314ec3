"""Step wrist: what the force-torque sensor carries and how it is mounted."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Any

from palpate_common.input_error import InputError
from palpate_common.section import plain, read_section
from palpate_setup.cell import recording
from palpate_setup.project import Project
from palpate_setup.questions import CHOICE, NUMBER, NUMBERS, TEXT, Question
from palpate_setup.step import Result, Setting, Step, Work

FRAMES = ("sensor_in_flange", "imu_in_flange", "grasp_in_flange")
DRAWING = "from the drawing, typed"


def _pose(key: str, text: str, default: Any) -> list[Question]:
    return [Question(f"{key}_position", f"{text}: position in the flange", NUMBERS, "m", default, -2, 2),
            Question(f"{key}_rpy_deg", f"{text}: roll, pitch, yaw in the flange", NUMBERS, "degrees", [0.0, 0.0, 0.0], -360, 360)]  # fmt: skip


def _frames(answers: Any, has_imu: bool) -> list[Setting]:
    return [Setting(f"frames.{name}", {"position": answers[f"{name}_position"], "rpy_deg": answers[f"{name}_rpy_deg"]}, DRAWING)
            for name in FRAMES if has_imu or name != "imu_in_flange"]  # fmt: skip


def _interval(quantity: Any, digits: int = 4) -> str:
    return f"{quantity['value']:.{digits}g} +- {quantity['half_width']:.2g} {quantity['unit']}"


class Wrist(Step):
    name = "wrist"
    title = "Wrist"
    about = "Payload, bias, mounting and delay of the force-torque sensor, by palpate-calibrate wrist; nothing is held."
    needs = ("channels",)

    def _drawings(self, project: Project) -> list[Question]:
        has_imu = bool(project.data("channels")["has_imu"])
        questions = _pose("sensor_in_flange", "Force-torque sensor", [0.0, 0.0, 0.0])
        if has_imu:
            questions += _pose("imu_in_flange", "Inertial unit", [0.0, 0.0, 0.0])
        questions += _pose("grasp_in_flange", "Grasp frame, between the fingers", [0.0, 0.0, 0.1])
        return [*questions, Question("gravity_in_base", "Gravity in W", NUMBERS, "m/s^2", [0.0, 0.0, -9.81], -20, 20)]

    def questions(self, project: Project) -> list[Question]:
        return [
            *self._drawings(project),
            Question("recording", "Log of the motion, if there is one already (empty: record now)", TEXT, default=None),
            Question("seconds", "Duration of the recording", NUMBER, "s", 90.0, 5, 3600, when=lambda a: not a["recording"]),
            Question("clock", "Times of the messages: of reception, or the senders'", CHOICE, default="received",
                     choices=("received", "sent")),
        ]  # fmt: skip

    def questions_to_skip(self, project: Project) -> list[Question]:
        return [
            *self._drawings(project),
            Question("mass", "Mass of what the sensor carries", NUMBER, "kg", low=0, high=1000),
            Question("center_of_mass", "Its centre of mass in the sensor's frame", NUMBERS, "m", low=-2, high=2),
        ]

    def run(self, work: Work) -> Result:
        has_imu = bool(work.project.data("channels")["has_imu"])
        settings = [*_frames(work.answers, has_imu), Setting("frames.gravity_in_base", work.answers["gravity_in_base"], "typed")]
        base = work.folder / "drawing.yaml"
        sensing = {"name": "wrist", "component": "ft_newton_euler", "payload": {"mass": 1}}
        _write_base(work, base, settings, sensing)
        log = work.file("recording") if work.answers["recording"] else self._record(work, base)
        work.arm_is_done()
        output, table = work.folder / "wrist.yaml", work.folder / "wrist.json"
        work.programs.run("palpate-calibrate", "wrist", log, "--config", base, "--clock", work.answers["clock"], "--output", output,
                          "--json", table, "--picture", work.folder / "wrist.png", say=work.person.say)  # fmt: skip
        summary = json.loads(table.read_text())
        return self._result(work, settings, summary, plain(read_section(output).values), log, has_imu)

    def _record(self, work: Work, base: Path) -> Path:
        flange = work.project.data("channels")["flange"]
        text = "Move the arm with nothing held through several rotations, with quick small turns in between."
        if flange is not None:
            plan, picture = work.folder / "poses.yaml", work.folder / "poses.png"
            work.programs.run("palpate-calibrate", "wrist", "--plan", "--config", base, "--start", *(f"{value:.5f}" for value in flange),
                              "--output", plan,
                              "--picture", picture)  # fmt: skip
            text = f"Prepare the motion through the poses of {work.shown('poses.yaml')}, with nothing held."
        work.person.ready(text + " The recording begins at once.")
        seconds = work.answers["seconds"]
        with recording(work, "wrist.lcmlog") as log:
            end, shown = time.monotonic() + seconds, seconds
            while (left := end - time.monotonic()) > 0:
                if left <= shown:
                    work.person.say(f"records, {left:.0f} s left")
                    shown = left - 15.0
                work.person.check()
                time.sleep(min(left, 0.2))
        return log

    def _result(self, work: Work, settings: list[Setting], summary: Any, written: Any, log: Path, has_imu: bool) -> Result:
        found = summary["quantities"]
        if not found["mass"]["determined"]:
            advice = "; ".join(entry["advice"] for entry in summary["not_determined"])
            raise InputError(f"the recording does not determine the payload's mass: {advice}")
        payload = written["sensing"][0]["payload"]
        settings = [*settings]
        for name, part in (("sensor_in_flange", "sensor_rotation"), ("imu_in_flange", "imu_rotation")):
            if name in written.get("frames", {}):
                widths = max(found[f"{part}_{axis}"]["half_width"] for axis in ("roll", "pitch", "yaw"))
                pose = {key: value for key, value in written["frames"][name].items() if value is not None}
                settings.append(Setting(f"frames.{name}", pose, f"position typed, rotation by palpate-calibrate wrist, 95 % within {widths:.2g} degrees"))
        centre = ", ".join(_interval(found[f"center_of_mass_{axis}"]) for axis in "xyz")
        origin = (f"palpate-calibrate wrist: mass {_interval(found['mass'])}, centre {centre} (95 %)\n"
                  f"bias at the recording's end; force residual {summary['residuals']['force']['rms_norm']:.2g} N")  # fmt: skip
        settings.append(Setting("sensing", [_sensing(payload, has_imu, summary["polarity"])], origin))
        delay = found.get("wrench_delay")
        if delay is not None and delay["value"] > delay["half_width"]:
            settings += [Setting(f"estimation.{key}", value, f"palpate-calibrate wrist: {_interval(delay)} (95 %)")
                         for key, value in written.get("estimation", {}).items()]  # fmt: skip
        lines = [f"{name:<22}{_interval(q) if q['determined'] else 'not determined'}" for name, q in found.items()
                 if name.startswith(("mass", "center", "force_bias", "sensor_rotation", "wrench_delay", "imu_delay"))]  # fmt: skip
        lines += [f"{name}: RMS of the residual {entry['rms_norm']:.3g} {entry['unit']}" for name, entry in summary["residuals"].items()]
        lines += [f"not determined: {', '.join(entry['parameters'])}: {entry['advice']}" for entry in summary["not_determined"]]
        return Result(lines, settings, [log] if work.answers["recording"] else [], [work.shown("wrist.png")],
                      {"mass": payload["mass"], "center_of_mass": payload["center_of_mass"]})  # fmt: skip

    def skip(self, work: Work) -> Result:
        has_imu = bool(work.project.data("channels")["has_imu"])
        answers = work.answers
        payload = {"mass": answers["mass"], "center_of_mass": answers["center_of_mass"]}
        settings = [*_frames(answers, has_imu), Setting("frames.gravity_in_base", answers["gravity_in_base"], "typed"),
                    Setting("sensing", [_sensing(payload, has_imu, 1)], "payload typed, not measured")]  # fmt: skip
        return Result([f"payload of {answers['mass']:g} kg, typed"], settings, data=payload)


def _sensing(payload: Any, has_imu: bool, polarity: int) -> dict[str, Any]:
    sensing = {"name": "wrist", "component": "ft_newton_euler", "use_imu": has_imu, "tare_at_start": False, "payload": payload}
    if has_imu:
        sensing["rest_speed"] = 0.001
    if polarity < 0:
        sensing["polarity"] = polarity
    return sensing


def _write_base(work: Work, path: Path, settings: list[Setting], sensing: dict[str, Any]) -> None:
    from palpate_setup.configuration import text_of

    estimation = Setting("estimation.component", "pose_wrench_filter")
    path.write_text(text_of([*work.project.settings(), *settings, Setting("sensing", [sensing]), estimation],
                            "What palpate-calibrate wrist starts from."))  # fmt: skip
