"""Questions, and values that answer them: typed or from a file, checked alike."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable, Mapping, Optional, Sequence

import yaml

from palpate_common.input_error import InputError
from palpate_common.section import REQUIRED, Section

NUMBER, NUMBERS, WHOLE, TEXT, CHOICE, FLAG = "number", "numbers", "whole", "text", "choice", "flag"


@dataclass(frozen=True)
class Question:
    """key: in the file of answers. low, high: allowed range, in `unit`. default: REQUIRED, or what an empty answer means; None:
    nothing. when: asked only if this holds for the answers so far."""

    key: str
    text: str
    kind: str = NUMBER
    unit: str = ""
    default: Any = REQUIRED
    low: float = 0.0
    high: float = 0.0
    count: int = 3
    choices: Sequence[str] = ()
    when: Optional[Callable[[Mapping[str, Any]], bool]] = None

    def read(self, section: Section) -> Any:
        """Its value in a section. Raises InputError with file, line, key, value and what is allowed."""
        if self.default is None and not section.has(self.key):
            section.text(self.key, "")  # marks it as known
            return None
        if self.kind == NUMBER:
            return section.number(self.key, self.low, self.high, self.default)
        if self.kind == WHOLE:
            return section.whole(self.key, int(self.low), int(self.high), self.default)
        if self.kind == NUMBERS:
            return section.numbers(self.key, self.count, self.low, self.high, self.default)
        if self.kind == CHOICE:
            return section.choice(self.key, list(self.choices), self.default)
        if self.kind == FLAG:
            return section.flag(self.key, bool(self.default) if self.default is not REQUIRED else False)
        return section.text(self.key, self.default)

    def parse(self, text: str) -> Any:
        """A typed answer; an empty one is the default. Raises InputError."""
        text = text.strip()
        values: dict[str, Any] = {}
        if text:
            values[self.key] = self._typed(text)
        return self.read(Section(values, Path("answer")))

    def _typed(self, text: str) -> Any:
        if self.kind in (TEXT, CHOICE):
            return text
        if self.kind == FLAG:
            return {"y": True, "yes": True, "n": False, "no": False}.get(text.lower(), text)
        words = text.strip("[]").replace(",", " ").split()
        try:
            numbers = [int(word) if self.kind == WHOLE else float(word) for word in words]
        except ValueError:
            return text
        return numbers if self.kind == NUMBERS else numbers[0] if len(numbers) == 1 else text

    @property
    def empty(self) -> Any:
        """A value of its kind that states nothing."""
        if self.kind == FLAG:
            return False
        return "" if self.kind in (TEXT, CHOICE) else [self.low] * self.count if self.kind == NUMBERS else self.low

    @property
    def allowed(self) -> str:
        """Unit and what is allowed, in words."""
        if self.kind == CHOICE:
            return ", ".join(self.choices)
        if self.kind == FLAG:
            return "yes, no"
        if self.kind == TEXT:
            return self.unit
        count = f"{self.count} numbers, " if self.kind == NUMBERS else ""
        return f"{count}{self.unit + ', ' if self.unit else ''}{self.low:g} to {self.high:g}"

    @property
    def shown_default(self) -> Optional[str]:
        """None: an answer is required."""
        if self.default is REQUIRED:
            return None
        if self.default is None:
            return ""
        if self.kind == FLAG:
            return "yes" if self.default else "no"
        if self.kind == NUMBERS:
            return " ".join(f"{value:.6g}" for value in self.default)
        return f"{self.default:.6g}" if self.kind in (NUMBER, WHOLE) else str(self.default)


def asked(questions: Sequence[Question], ask: Callable[[Question], Any]) -> dict[str, Any]:
    """Asks the questions in order, leaving out those whose condition does not hold."""
    answers: dict[str, Any] = {}
    for question in questions:
        if question.when is None or question.when(answers):
            answers[question.key] = ask(question)
    return answers


def asked_keys(questions: Sequence[Question], typed: Mapping[str, str]) -> list[str]:
    """Keys of the questions that are asked while these answers are being typed; a wrong or missing one counts as its default, or
    as an empty value."""

    def value(question: Question) -> Any:
        try:
            return question.parse(typed.get(question.key, ""))
        except InputError:
            return question.empty if question.default is REQUIRED else question.default

    return list(asked(questions, value))


def with_defaults(questions: Sequence[Question], earlier: Mapping[str, Any]) -> list[Question]:
    """The same with the answers of an earlier run as defaults, where they are still allowed."""
    result = []
    for question in questions:
        if earlier.get(question.key) is not None:
            try:
                value = question.read(Section({question.key: earlier[question.key]}, Path("earlier")))
                question = Question(**{**question.__dict__, "default": value})
            except InputError:
                pass
        result.append(question)
    return result


def answers_in(section: Section, questions: Sequence[Question], known: Sequence[str]) -> dict[str, Any]:
    """All answers from a section of a file. known: keys of questions that are not asked now; others are errors."""
    answers = asked(questions, lambda question: question.read(section))
    for key in (*known, *(question.key for question in questions)):
        section.text(key, "")
    section.check_unused()
    return answers


def as_yaml(value: Any) -> str:
    """One line."""
    return str(yaml.safe_dump(value, default_flow_style=True, width=10000, sort_keys=False)).removesuffix("\n").removesuffix("\n...")
