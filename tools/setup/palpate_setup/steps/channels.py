"""Step channels: what the robot publishes, and the limits of its motion."""

from __future__ import annotations

import numpy as np

from palpate_common.input_error import InputError
from palpate_common.rotations import from_wxyz, to_rpy
from palpate_setup.project import Project
from palpate_setup.questions import FLAG, NUMBERS, TEXT, Question
from palpate_setup.step import Result, Setting, Step, Work
from palpate_setup.traffic import judge, listen

CONTROL, HOUSEKEEPING = "udpm://239.255.76.67:7667?ttl=0", "udpm://239.255.76.68:7668?ttl=0"


class Channels(Step):
    name = "channels"
    title = "Channels"
    about = "Which channels of the robot arrive, how often, how old, and whether their numbers are plausible; limits of the arm."
    needs = ("machine",)

    def questions(self, project: Project) -> list[Question]:
        return [
            Question("seconds", "Time to listen", unit="s", default=3.0, low=0.5, high=600),
            *self.questions_to_skip(project)[:-1],
        ]

    def questions_to_skip(self, project: Project) -> list[Question]:
        return [
            Question("control", "LCM URL of the control channels", TEXT, default=CONTROL),
            Question("housekeeping", "LCM URL of the housekeeping channels", TEXT, default=HOUSEKEEPING),
            Question("key_file", "Key of signed commands (palpate-command --make-key; empty: not signed)", TEXT, default=None),
            Question("lower", "Workspace of the flange: lowest corner in W", NUMBERS, "m", low=-10, high=10),
            Question("upper", "Workspace of the flange: highest corner in W", NUMBERS, "m", low=-10, high=10),
            Question("linear_speed", "Largest speed of the flange", unit="m/s", default=0.02, low=1e-4, high=10),
            Question("angular_speed", "Largest angular speed of the flange", unit="rad/s", default=0.2, low=1e-4, high=10),
            Question("force", "Contact force at which the hand stops", unit="N", default=10.0, low=0.01, high=1e4),
            Question("torque", "Contact torque at which the hand stops", unit="N m", default=3.0, low=0.01, high=1e3),
            Question("has_imu", "An inertial unit is mounted", FLAG, default=False),
        ]

    def run(self, work: Work) -> Result:
        url = work.answers["control"]
        work.person.say(f"listens for {work.answers['seconds']:g} s on {url}")
        try:
            heard, malformed = listen(url, work.answers["seconds"], work.person.check)
        except (ValueError, OSError) as error:
            raise InputError(str(error)) from error
        lines, faults = judge(heard, work.project.data("machine")["is_simulated"])
        if malformed:
            lines.append(f"{malformed} datagrams that are no LCM messages")
        if faults:
            for line in lines:
                work.person.say(line)
            raise InputError("; ".join(faults))
        flange = heard["ROBOT_STATE"].messages[-1]
        rpy = np.degrees(to_rpy(from_wxyz(np.array(flange.quaternion))))
        lines.append(f"flange at {_list(flange.position, 3)} m, roll, pitch, yaw {_list(rpy, 1)} degrees")
        result = Result(lines, _settings(work))
        result.data = {"has_imu": "IMU" in heard and bool(heard["IMU"].messages), "joints": flange.joint_count,
                       "flange": [*map(float, flange.position), *map(float, rpy)],
                       "rates": {name: round(one.rate, 1) for name, one in heard.items()}}  # fmt: skip
        outside = [axis for axis, low, value, high in zip("xyz", work.answers["lower"], flange.position, work.answers["upper"])
                   if not low <= value <= high]  # fmt: skip
        if outside:
            raise InputError(f"the flange at {_list(flange.position, 3)} m is outside the workspace along {', '.join(outside)}; "
                             "is the frame W that of the arm's base?")  # fmt: skip
        return result

    def skip(self, work: Work) -> Result:
        return Result(["not checked"], _settings(work), data={"has_imu": work.answers["has_imu"], "joints": 0, "flange": None})


def _settings(work: Work) -> list[Setting]:
    answers = work.answers
    wrong = [axis for axis, low, high in zip("xyz", answers["lower"], answers["upper"]) if not low < high]
    if wrong:
        raise InputError(f"lower and upper: the workspace is empty along {', '.join(wrong)}")
    settings = [Setting("bus.control", answers["control"]), Setting("bus.housekeeping", answers["housekeeping"])]
    if answers["key_file"]:
        work.file("key_file")
        settings.append(Setting("access.key_file", answers["key_file"], "commands are signed"))
    settings += [Setting(f"gate.{key}", answers[key], "limits of the arm, typed")
                 for key in ("linear_speed", "angular_speed", "force", "torque")]  # fmt: skip
    return [*settings, Setting("gate.workspace.lower", answers["lower"], "of the flange in W, m, typed"),
            Setting("gate.workspace.upper", answers["upper"], "of the flange in W, m, typed")]  # fmt: skip


def _list(values: object, digits: int) -> str:
    return "(" + ", ".join(f"{float(value) + 0.0:.{digits}f}" for value in values) + ")"  # type: ignore[attr-defined]
