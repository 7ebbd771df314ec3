"""Step material: stiffness of the held object, from small motions of the hand."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from palpate_common.input_error import InputError
from palpate_common.section import plain, read_section
from palpate_setup.cell import configuration_of, daemon, recording
from palpate_setup.project import Project
from palpate_setup.questions import CHOICE, FLAG, NUMBER, TEXT, Question, as_yaml
from palpate_setup.steering import Steering
from palpate_setup.step import Result, Setting, Step, Work

# Of the controlled point from rest, in O, times the amplitude; along the object's long side less, where it is stiffest.
MOVES = ((0, 0, 1), (0, 1, 0), (0, 0, -1), (0, -1, 0), (0.5, 0, 0), (-0.5, 0, 0), (0.3, 0.7, 0.7), (0, 0, 0))
REST = 1.6  # s, at each place
CALM = "{linear_speed: 0.001, angular_speed: 0.004, settle: 0.5, window: 0.5, every: 3}"  # of the hand: m/s, rad/s, s
TOLERANCE = 2e-3  # m, of the controlled point; the fit uses the pose of the hand
WIDEST = 0.5  # half width of E's interval as a share of E, beyond which it counts as not determined


class Material(Step):
    name = "material"
    title = "Material"
    about = "Young's modulus by palpate-fit, and Poisson's ratio on request, from rests of the hand while it holds the object."
    needs = ("registration",)

    def questions(self, project: Project) -> list[Question]:
        return [
            Question("young_modulus", "Young's modulus, a first guess within a factor of 10", NUMBER, "Pa", 30e3, 1, 1e10),
            Question("poisson_ratio", "Poisson's ratio", NUMBER, "", 0.3, -0.5, 0.499),
            Question("fit_poisson_ratio", "Find Poisson's ratio as well, from that value on (a recording needs twists or pulls)", FLAG,
                     default=False),
            Question("recording", "Log of a hand that holds, moves and rests, if there is one (empty: move now)", TEXT, default=None),
            Question("amplitude", "How far the controlled point is moved", NUMBER, "m", 0.008, 5e-4, 0.1,
                     when=lambda a: not a["recording"]),
            Question("clock", "Times of the messages: of reception, or the senders'", CHOICE, default="received",
                     choices=("received", "sent")),
        ]  # fmt: skip

    def questions_to_skip(self, project: Project) -> list[Question]:
        return [Question("young_modulus", "Young's modulus", NUMBER, "Pa", low=1, high=1e10),
                Question("poisson_ratio", "Poisson's ratio", NUMBER, "", 0.3, -0.5, 0.499)]  # fmt: skip

    def run(self, work: Work) -> Result:
        guess = [Setting("object.material.young_modulus", work.answers["young_modulus"], "first guess"),
                 Setting("object.material.poisson_ratio", work.answers["poisson_ratio"], "first guess")]  # fmt: skip
        # The shape under a held pose hardly depends on the stiffness: the hand's pose drives it until the stiffness is known.
        driven = [Setting("estimation", None), Setting("estimation.component", "pose_driven", "until the stiffness is known")]
        base = configuration_of(work, "material.yaml", [*guess, *driven])
        log = work.file("recording") if work.answers["recording"] else self._move(work, base)
        work.arm_is_done()
        folder = work.folder / "fitted"
        self._fit(work, base, log, folder)
        result = self._result(work, folder)
        result.files = [log] if work.answers["recording"] else []
        return result

    def _move(self, work: Work, base: Path) -> Path:
        point = np.array(work.project.data("object")["point"])
        work.person.ready("Let the hand hold the object, at rest, as it lies in the clamp.")
        with daemon(work, base) as (client, _), recording(work, "moves.lcmlog") as log:
            client.start()
            steering = Steering(client)
            at_rest = steering.wait_for_value()
            if np.linalg.norm(at_rest - point) > 0.05:
                raise InputError(f"the controlled point seems to be {1e3 * np.linalg.norm(at_rest - point):.0f} mm from its place at rest: "
                                 "does the hand hold the object where step object says?")  # fmt: skip
            steering.rest(REST, work.person.check)
            for number, move in enumerate(MOVES, 1):
                work.person.say(f"motion {number} of {len(MOVES)}")
                steering.move((at_rest + work.answers["amplitude"] * np.array(move)).tolist(), TOLERANCE, 60.0, work.person.check)
                steering.rest(REST, work.person.check)
        return log

    def _fit(self, work: Work, base: Path, log: Path, folder: Path) -> None:
        mesh = as_yaml(work.project.data("object")["fine_mesh"])
        plan = work.folder / "fit.yaml"
        plan.write_text(
            "# Written by palpate-setup\nname: object\nrecordings:\n  - kind: held_object\n"
            f"    log: {log}\n    configuration: {base}\n    set: [\"object.mesh=~\", \"object.mesh={mesh}\"]\n"
            f"    time: {work.answers['clock']}\n    calm: {CALM}\n"
            f"    sought: [bias{', poisson_ratio' if work.answers['fit_poisson_ratio'] else ''}]\n"
        )
        work.person.say("palpate-fit: some minutes")
        work.programs.run("palpate-fit", plan, "--output", folder, say=work.person.say)

    def _result(self, work: Work, folder: Path) -> Result:
        fit = json.loads((folder / "fits.json").read_text())["fits"][0]
        written: Any = plain(read_section(folder / "material.yaml").values)
        modulus, interval = _modulus(fit, written)
        undetermined = list(written.get("undetermined") or [])
        is_given = not work.answers["fit_poisson_ratio"]
        if "young_modulus" in undetermined or max(abs(bound - modulus) for bound in interval) > WIDEST * modulus:
            raise InputError(f"the motions do not determine Young's modulus ({modulus:.3g} Pa, 95 %: {interval[0]:.3g} to {interval[1]:.3g}); "
                             "a larger amplitude, or another grasp")  # fmt: skip
        deviation = float(np.clip((interval[1] - interval[0]) / 3.92 / modulus, 0.05, 0.5))
        lines = [f"E = {modulus:.4g} Pa, 95 %: {interval[0]:.4g} to {interval[1]:.4g}"]
        origin = f"palpate-fit held_object: 95 % {interval[0]:.4g} to {interval[1]:.4g} Pa"
        settings = [Setting("object.material.young_modulus", float(f"{modulus:.5g}"), origin)]
        if is_given or "poisson_ratio" in undetermined:
            reason = "typed" if is_given else "typed; the motions do not determine it"
            settings.append(Setting("object.material.poisson_ratio", work.answers["poisson_ratio"], reason))
            lines.append(f"nu = {work.answers['poisson_ratio']:g}, {reason}")
        else:
            ratio, widths = fit["corotational"]["poisson_ratio"], fit["corotational"]["poisson_ratio_interval"]
            lines.append(f"nu = {ratio:.3f}, 95 %: {widths[0]:.3f} to {widths[1]:.3f}")
            settings.append(Setting("object.material.poisson_ratio", float(f"{min(ratio, 0.495):.4g}"),
                                    f"palpate-fit: 95 % {widths[0]:.3g} to {widths[1]:.3g}"))  # fmt: skip
        settings.append(Setting("estimation.log_young_modulus_deviation", round(deviation, 3),
                                "the filter's prior: the interval, at least 5 % for the model's own error"))  # fmt: skip
        pictures = [work.shown("fitted/fit.png")] if (folder / "fit.png").exists() else []
        return Result(lines, settings, [], pictures, {"young_modulus": modulus, "interval": list(interval)})

    def skip(self, work: Work) -> Result:
        answers = work.answers
        settings = [Setting(f"object.material.{key}", answers[key], "typed, not measured") for key in ("young_modulus", "poisson_ratio")]
        return Result([f"E = {answers['young_modulus']:.4g} Pa, nu = {answers['poisson_ratio']:g}, typed"], settings,
                      data={"young_modulus": answers["young_modulus"]})  # fmt: skip


def _modulus(fit: Any, written: Any) -> tuple[float, list[float]]:
    """Young's modulus of the linear model, Pa, and its 95 % interval: that nearest to another model, or that of the model itself.
    Raises InputError where the fit has none."""
    if "corotational" in fit:
        return float(fit["corotational"]["young_modulus"]), list(fit["corotational"]["young_modulus_interval"])
    interval = (written.get("intervals") or {}).get("young_modulus")
    if written["material"]["model"] != "linear" or interval is None:
        raise InputError("palpate-fit does not determine Young's modulus; see its fit.png: larger motions, or another first guess")
    return float(written["material"]["young_modulus"]), list(interval)
