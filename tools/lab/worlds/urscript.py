"""The part of URScript that palpate's programs use: translated to Python, one control cycle at a time."""

from __future__ import annotations

import ast
import re
from typing import Any, Callable, Generator, Mapping

Cycles = Generator[None, None, None]

_BLOCKS = re.compile(r"(while|if|elif) (.+):$|(else):$")
_ASSIGNMENT = re.compile(r"([A-Za-z_]\w*) = (.+)$")
_CALL = re.compile(r"[A-Za-z_]\w*\(.*\)$")
_ALLOWED = (
    ast.Expression, ast.BinOp, ast.Add, ast.Sub, ast.Mult, ast.Div, ast.UnaryOp, ast.USub, ast.Not,
    ast.BoolOp, ast.And, ast.Or, ast.Compare, ast.Eq, ast.NotEq, ast.Lt, ast.LtE, ast.Gt, ast.GtE,
    ast.Call, ast.Name, ast.Load, ast.Constant, ast.List, ast.Subscript,
)  # fmt: skip


class ScriptError(ValueError):
    """What a controller would refuse, with the line."""


def _checked(expression: str, line: int) -> str:
    try:
        tree = ast.parse(expression, mode="eval")
    except SyntaxError as error:
        raise ScriptError(f"line {line}: {expression}: {error.msg}") from error
    for node in ast.walk(tree):
        if not isinstance(node, _ALLOWED):
            raise ScriptError(f"line {line}: {expression}: {type(node).__name__} is not known")
    return expression


def _statement(text: str, line: int, waiting: frozenset[str]) -> str:
    assignment = _ASSIGNMENT.match(text)
    if assignment:
        return f"{assignment[1]} = {_checked(assignment[2], line)}"
    if _CALL.match(text):
        call = _checked(text, line)
        return f"yield from {call}" if text.split("(")[0] in waiting else call
    raise ScriptError(f"line {line}: {text}: not known")


def load(
    text: str,
    functions: Mapping[str, Callable[..., Any]],
    waiting: Mapping[str, Callable[..., Cycles]],
) -> tuple[str, Cycles]:
    """Name and run of the program, which yields once per control cycle. `waiting`: functions that
    take cycles, and stand alone as statements. Raises ScriptError.
    """
    lines, depth, name = [], 0, ""
    for number, raw in enumerate(text.splitlines(), 1):
        line = raw.split("#")[0].strip()
        if not line:
            continue
        definition = re.match(r"def (\w+)\(\):$", line)
        if definition and not name:
            name, depth = definition[1], 1
            lines.append("def program():")
        elif depth == 0:
            raise ScriptError(f"line {number}: {line}: outside of a program")
        elif line == "end":
            depth -= 1
        elif block := _BLOCKS.match(line):
            condition = f" {_checked(block[2], number)}" if block[2] else ""
            # elif and else end the block before.
            indent = depth if block[1] in ("while", "if") else depth - 1
            lines.append(f"{'  ' * indent}{block[1] or block[3]}{condition}:")
            depth = indent + 1
        else:
            lines.append("  " * depth + _statement(line, number, frozenset(waiting)))
    if depth != 0 or not name:
        raise ScriptError("no complete program: def NAME(): ... end")
    lines.append("  yield")
    scope: dict[str, Any] = {"__builtins__": {}, **functions, **waiting}
    exec("\n".join(lines), scope)  # expressions and names have been checked
    run: Cycles = scope["program"]()
    return name, run
