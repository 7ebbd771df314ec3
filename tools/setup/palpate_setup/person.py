"""Who answers the questions: a person at a terminal, a file of answers, or a person at the page (page.py)."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Optional, Protocol, Sequence

from palpate_common.input_error import WRONG_CONFIGURATION, InputError
from palpate_common.section import read_section
from palpate_setup.questions import Question, answers_in, asked, with_defaults

if TYPE_CHECKING:
    from palpate_setup.project import Project
    from palpate_setup.step import Step


class Person(Protocol):
    """Answers and is shown what happens."""

    def answers(self, step: Step, project: Project, skip: bool) -> dict[str, Any]:
        """Of the questions of a step that is run or skipped. Raises InputError."""
        ...

    def ready(self, text: str) -> None:
        """Returns once what `text` asks for is done."""
        ...

    def say(self, text: str) -> None:
        """One line of progress."""
        ...

    def check(self) -> None:
        """Raises InputError if the step is to be stopped."""
        ...

    def command(self, step: str) -> Optional[str]:
        """A shell command that runs during the step, such as the arm's own motion; None: there is none."""
        ...


class Terminal:
    """Asks line by line; interrupted by Ctrl-C."""

    def answers(self, step: Step, project: Project, skip: bool) -> dict[str, Any]:
        questions = step.questions_to_skip(project) if skip else step.questions(project)
        return asked(with_defaults(questions, project.entry(step.name).get("answers", {})), self._ask)

    def _ask(self, question: Question) -> Any:
        default = question.shown_default
        note = f" ({question.allowed})" if question.allowed else ""
        while True:
            typed = self.line(f"  {question.text}{note}{f' [{default}]' if default is not None else ''}: ")
            try:
                return question.parse(typed)
            except InputError as error:
                print(f"  {error}")

    @staticmethod
    def line(prompt: str) -> str:
        """Raises InputError at the end of the input."""
        try:
            return input(prompt)
        except EOFError:
            raise InputError("the input has ended; --answers FILE runs without a person") from None

    def ready(self, text: str) -> None:
        self.line(f"  {text} Then press Enter: ")

    def say(self, text: str) -> None:
        print(f"  {text}", flush=True)

    def check(self) -> None:
        pass

    def command(self, step: str) -> Optional[str]:
        return None


class AnswersFile:
    """A YAML file with a section per step, and `commands`: a shell command per step that runs while the step does.

    Where the file does not state an answer, the default counts, and a question without one ends the program with 78. Nothing
    waits for a person.
    """

    def __init__(self, path: Path, steps: Sequence[str]) -> None:
        """Raises InputError."""
        self._top = read_section(path)
        self._commands: dict[str, str] = {}
        commands = self._top.optional("commands")
        for step in steps:
            self._top.optional(step)
            text = commands.text(step, "")
            if text:
                self._commands[step] = text
        commands.check_unused()
        self._top.check_unused()

    def answers(self, step: Step, project: Project, skip: bool) -> dict[str, Any]:
        section = self._top.optional(step.name)
        run, typed = step.questions(project), step.questions_to_skip(project)
        try:
            return answers_in(section, typed if skip else run, [question.key for question in (*run, *typed)])
        except InputError as error:
            raise InputError(str(error), WRONG_CONFIGURATION) from error

    def ready(self, text: str) -> None:
        pass

    def say(self, text: str) -> None:
        print(f"  {text}", flush=True)

    def check(self) -> None:
        pass

    def command(self, step: str) -> Optional[str]:
        return self._commands.get(step)
