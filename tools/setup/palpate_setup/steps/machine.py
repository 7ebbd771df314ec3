"""Step machine: what on this machine would impair palpated."""

from __future__ import annotations

from palpate_common.input_error import InputError
from palpate_setup.project import Project
from palpate_setup.questions import CHOICE, FLAG, Question
from palpate_setup.step import Result, Setting, Step, Work

# ms: lateness that degrades the loop, its window, missing commands that stop the arm; None: palpated's defaults.
LATENESS = {"real_time": None, "desktop": (30, 60, 100), "simulator": (5000, 10000, 10000)}


class Machine(Step):
    name = "machine"
    title = "Machine"
    about = "Kernel, priorities, memory and network, by palpate-doctor."

    def questions(self, project: Project) -> list[Question]:
        return [
            Question("lateness", "Lateness of the loop that is allowed: real_time (6 ms), desktop (30 ms), or simulator (seconds; "
                     "never with a real arm); automatic: by the kernel", CHOICE, default="automatic",
                     choices=("automatic", *LATENESS)),
            Question("accept_failures", "Continue although a check of the machine fails", FLAG, default=False),
        ]  # fmt: skip

    def questions_to_skip(self, project: Project) -> list[Question]:
        return self.questions(project)[:1]

    def run(self, work: Work) -> Result:
        found = work.programs.run_json("palpate-doctor", "--json", "-", allowed=(0, 1))["findings"]
        result = Result([f"{sum(f['verdict'] == 'ok' for f in found)} of {len(found)} checks are well"])
        for finding in found:
            if finding["verdict"] != "ok":
                result.lines.append(f"{finding['verdict']}: {finding['check']}: {finding['found']}"
                                    + (f"; {finding['why']}" if finding["why"] else ""))  # fmt: skip
                result.lines += [f"    remedy: {line}" for line in finding["remedy"].splitlines()]
        failed = [finding["check"] for finding in found if finding["verdict"] == "fail"]
        if failed and not work.answers["accept_failures"]:
            for line in result.lines:
                work.person.say(line)
            raise InputError(f"checks of the machine that fail: {', '.join(failed)}; correct them, or answer accept_failures: true")
        kind = work.answers["lateness"]
        if kind == "automatic":
            is_real_time = any(f["check"] == "kernel" and f["verdict"] == "ok" for f in found)
            kind = "real_time" if is_real_time else "desktop"
            result.lines.append(f"the kernel is {'' if is_real_time else 'no '}real-time one: lateness {kind}")
        result.settings = _loop(kind, "palpate-doctor")
        result.data = {"is_simulated": kind == "simulator"}
        return result

    def skip(self, work: Work) -> Result:
        kind = work.answers["lateness"]
        settings = _loop("desktop" if kind == "automatic" else kind, "typed")
        return Result(["not checked"], settings, data={"is_simulated": kind == "simulator"})


def _loop(kind: str, source: str) -> list[Setting]:
    limits = LATENESS[kind]
    settings = [Setting("loop.period_ms", 1), Setting("loop.fifo_priority", 50)]
    if limits is not None:
        origin = f"limits of lateness: {kind} ({source})"
        if kind == "simulator":
            origin += "; remove them before an arm moves: then 6 ms degrade the loop, and 20 ms without a command stop the arm"
        keys = ("degraded_after_ms", "overrun_window_ms", "safe_stop_after_ms")
        settings += [Setting(f"loop.{key}", value, origin) for key, value in zip(keys, limits)]
    return settings
