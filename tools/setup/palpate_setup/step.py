"""What a step of the set-up is, what it works with, and what it leaves."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Mapping, NamedTuple

from palpate_common.input_error import InputError
from palpate_setup.questions import Question

if TYPE_CHECKING:
    from palpate_setup.person import Person
    from palpate_setup.programs import Programs
    from palpate_setup.project import Project


class Setting(NamedTuple):
    """One key of palpated's configuration, such as object.material.young_modulus; origin: where its value comes from, with its
    interval; empty: it needs no comment."""

    path: str
    value: Any
    origin: str = ""


@dataclass
class Result:
    """lines: what the user reads. files: the user's files that were read. pictures: relative to the project's folder.
    data: numbers that later steps and the report use, of JSON's types."""

    lines: list[str] = field(default_factory=list)
    settings: list[Setting] = field(default_factory=list)
    files: list[Path] = field(default_factory=list)
    pictures: list[str] = field(default_factory=list)
    data: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Work:
    """What a step works with. answers: one entry per question that was asked."""

    project: Project
    programs: Programs
    person: Person
    folder: Path  # of the step's own files; exists
    answers: Mapping[str, Any]
    arm_is_done: Callable[[], None] = lambda: None  # ends the command that stands for the arm in this step, or moves it

    def file(self, key: str) -> Path:
        """The file that an answer names, relative to the project's folder. Raises InputError if it does not exist."""
        path = self.project.folder / str(self.answers[key])
        if not path.is_file():
            raise InputError(f"{key}: {path}: there is no such file")
        return path

    def shown(self, name: str) -> str:
        """A file of the step's folder, relative to the project's folder."""
        return str((self.folder / name).relative_to(self.project.folder))


class Step(ABC):
    """One step. The class attributes: name on the command line, title, one sentence, and the steps whose results it uses."""

    name = ""
    title = ""
    about = ""
    needs: tuple[str, ...] = ()

    @abstractmethod
    def questions(self, project: Project) -> list[Question]:
        """What cannot be measured."""

    @abstractmethod
    def run(self, work: Work) -> Result:
        """Measures. Raises InputError with the reason where it stops."""

    def questions_to_skip(self, project: Project) -> list[Question]:
        """What is typed instead of being measured."""
        return []

    def skip(self, work: Work) -> Result:
        """By typed values."""
        return Result(["skipped"])
