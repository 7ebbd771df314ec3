"""Runs steps, and writes state, configuration and report after each."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import Optional

from palpate_common.input_error import FAILED, InputError
from palpate_setup import configuration, report
from palpate_setup.person import Person
from palpate_setup.programs import Child, Programs
from palpate_setup.project import DONE, SKIPPED, Project
from palpate_setup.step import Result, Step, Work


class Guide:
    """Of one project and one person."""

    def __init__(self, project: Project, programs: Programs, person: Person) -> None:
        self.project, self.programs, self.person = project, programs, person

    def perform(self, step: Step, skip: bool = False) -> Result:
        """Runs or skips a step. Raises InputError with the reason where it stops; then that is recorded."""
        missing = self.project.missing_needs(step)
        if missing:
            raise InputError(f"{step.name} needs {', '.join(missing)}: --step {missing[0]}")
        answers = self.person.answers(step, self.project, skip)
        folder = self.project.step_folder(step.name)
        try:
            with ExitStack() as stack:
                command = None if skip else self.person.command(step.name)
                if command is not None:
                    stack.enter_context(self._child(command, folder))
                work = Work(self.project, self.programs, self.person, folder, answers, stack.close)
                result = step.skip(work) if skip else step.run(work)
        except InputError as error:
            self.project.fail(step, answers, str(error))
            self._write()
            raise
        except OSError as error:
            reason = f"{error.filename}: {error.strerror}" if error.filename else str(error)
            self.project.fail(step, answers, reason)
            self._write()
            raise InputError(reason, FAILED) from error
        self.project.record(step, SKIPPED if skip else DONE, answers, result)
        self._write()
        for line in result.lines:
            self.person.say(line)
        return result

    def _child(self, command: str, folder: Path) -> Child:
        self.person.say(f"runs: {command}"[:110])
        return Child([command], folder / "command.log", shell=True, cwd=self.project.folder)

    def _write(self) -> None:
        configuration.write(self.project)
        report.write(self.project)


def next_step(project: Project, after: Optional[Step] = None) -> Optional[Step]:
    """The first step that is neither done nor skipped, or is outdated; of those behind `after`."""
    steps = project.steps if after is None else project.steps[project.steps.index(after) + 1 :]
    return next((step for step in steps if project.status(step) not in (DONE, SKIPPED)), None)
