"""Command lines in the layout of palpate's other programs, from which tools/packaging makes manual pages and completion."""

from __future__ import annotations

import argparse
import sys
from typing import Any, Callable, NoReturn, Optional, Union

from palpate_common.input_error import FAILED, InputError

COLUMN = 30  # at which the meaning of an option begins
WIDTH = 110
WRONG_COMMAND_LINE = 64


def exit_code_of(program: str, work: Callable[[], int]) -> int:
    """What `work` returns, or the code of the InputError or OSError that ends it, whose message goes to the standard error."""
    try:
        return work()
    except InputError as error:
        message, code = str(error), error.exit_code
    except OSError as error:
        message, code = f"{error.filename}: {error.strerror}" if error.filename else str(error), FAILED
    print(f"{program}: {message}", file=sys.stderr)
    return code


class Number:
    """Type of an argument: a number within a range."""

    def __init__(self, low: float, high: float, whole: bool = False) -> None:
        self.low, self.high, self.whole = low, high, whole

    def __call__(self, text: str) -> Union[int, float]:
        try:
            value = int(text) if self.whole else float(text)
        except ValueError:
            value = float("nan")
        if not self.low <= value <= self.high:
            kind = "a whole number" if self.whole else "a number"
            raise argparse.ArgumentTypeError(f"{text}; allowed: {kind} from {self.low:g} to {self.high:g}")
        return value


class PositionAndAngle(argparse.Action):
    """Two values of an option, m and degrees, each within its range: `position` and `angle` of add_argument()."""

    def __init__(self, option_strings: list[str], dest: str, position: Number, angle: Number, **kwargs: Any) -> None:
        super().__init__(option_strings, dest, nargs=2, type=float, **kwargs)
        self.position, self.angle = position, angle

    def __call__(self, parser: argparse.ArgumentParser, namespace: argparse.Namespace, values: Any,
                 option_string: Optional[str] = None) -> None:  # fmt: skip
        if not all(of.low <= value <= of.high for of, value in zip((self.position, self.angle), values)):
            parser.error(f"argument {option_string}: {values[0]:g} {values[1]:g}; allowed: {self.position.low:g} to "
                         f"{self.position.high:g} m, {self.angle.low:g} to {self.angle.high:g} degrees")  # fmt: skip
        setattr(namespace, self.dest, values)


def _kind(action: argparse.Action) -> str:
    if isinstance(action.type, Number):
        return "INT" if action.type.whole else "FLOAT"
    return {float: "FLOAT", int: "INT"}.get(action.type, "TEXT")  # type: ignore[call-overload]


def _default(action: argparse.Action) -> str:
    if action.default is None or action.default == []:
        return ""
    return "=" + (" ".join(map(str, action.default)) if isinstance(action.default, list) else str(action.default))


class Parser(argparse.ArgumentParser):
    """Ends with 64 on a wrong command line. `tail` follows the options: examples and exit codes."""

    def __init__(self, prog: str, description: str, usage: str, tail: str) -> None:
        super().__init__(prog=prog, description=description, add_help=False, allow_abbrev=False)
        self.usage_text, self.tail = usage, tail
        self.add_argument("-h", "--help", action="help", help="Print this help message and exit")

    def error(self, message: str) -> NoReturn:
        print(f"{self.prog}: {message}\nRun with --help for more information.", file=sys.stderr)
        sys.exit(WRONG_COMMAND_LINE)

    def format_help(self) -> str:
        positionals = [action for action in self._actions if not action.option_strings]
        options = [action for action in self._actions if action.option_strings]
        lines = [(self.description or "").strip(), "", f"Usage: {self.prog} {self.usage_text}", ""]
        for title, actions in (("Positionals:", positionals), ("Options:", options)):
            if actions:
                lines += [title, *(line for action in actions for line in self._item(action)), ""]
        return "\n".join(lines) + "\n" + self.tail.strip("\n") + "\n"

    @staticmethod
    def _item(action: argparse.Action) -> list[str]:
        names = ",".join(action.option_strings) or action.dest
        spec = names
        if action.nargs != 0:
            kind = _kind(action) + (":{" + ",".join(map(str, action.choices)) + "}" if action.choices else "")
            count = f" x {action.nargs}" if isinstance(action.nargs, int) else " ..." if action.nargs in ("*", "+") else ""
            spec = f"{names} {kind}{_default(action)}{count}"
        words, lines = (action.help or "").split(), [""]
        for word in words:
            if len(lines[-1]) + len(word) + 1 > WIDTH - COLUMN:
                lines.append("")
            lines[-1] += (" " if lines[-1] else "") + word
        head = f"  {spec}"
        if len(head) < COLUMN - 1:
            return [head.ljust(COLUMN) + lines[0], *(" " * COLUMN + line for line in lines[1:])]
        return [head, *(" " * COLUMN + line for line in lines)]
