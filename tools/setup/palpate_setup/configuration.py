"""The configuration that palpated reads, each value with a comment that states where it comes from."""

from __future__ import annotations

import textwrap
from typing import Any, Mapping, Sequence

from palpate_common.section import plain, read_section
from palpate_setup.project import CONFIGURATION, DONE, OPEN, OWN, SKIPPED, Project
from palpate_setup.questions import as_yaml
from palpate_setup.step import Setting

ORDER = ("loop", "bus", "access", "frames", "object", "sensing", "contact", "estimation", "deformation", "feature", "control", "gate")
WIDTH = 118
# The parts of a pose: those of another source replace all of them.
POSE = {"position", "rpy_deg", "quaternion"}


class _Leaf:
    """A value with its origin."""

    def __init__(self, value: Any, origin: str) -> None:
        self.value, self.origin = value, origin


def _is_leaf(value: Any) -> bool:
    return not isinstance(value, dict) or not value or bool(POSE & value.keys())


def _put(tree: dict[str, Any], path: Sequence[str], value: Any, origin: str) -> None:
    """A later value replaces an earlier one."""
    if len(path) > 1:
        below = tree.get(path[0])
        if isinstance(below, _Leaf) and isinstance(below.value, dict) and not _is_leaf(below.value):
            below = {key: _Leaf(entry, below.origin) for key, entry in below.value.items()}
        if not isinstance(below, dict):
            below = {}
        tree[path[0]] = below
        _put(below, path[1:], value, origin)
    elif value is None:
        tree.pop(path[0], None)
    else:
        tree[path[0]] = _Leaf(value, origin)


def _leaves(values: Mapping[str, Any], path: tuple[str, ...] = ()) -> list[tuple[tuple[str, ...], Any]]:
    found: list[tuple[tuple[str, ...], Any]] = []
    for key, value in values.items():
        found += [((*path, key), value)] if _is_leaf(value) else _leaves(value, (*path, key))
    return found


def _comment(text: str, indent: str) -> list[str]:
    return [line for paragraph in text.splitlines()
            for line in textwrap.wrap(paragraph, WIDTH, initial_indent=f"{indent}# ", subsequent_indent=f"{indent}# ")]  # fmt: skip


def _lines(tree: Mapping[str, Any], indent: str = "") -> list[str]:
    keys = sorted(tree, key=lambda key: ORDER.index(key) if key in ORDER else len(ORDER)) if not indent else list(tree)
    lines: list[str] = []
    said = ""
    for key in keys:
        entry = tree[key]
        if isinstance(entry, _Leaf):
            if entry.origin != said:
                lines += _comment(entry.origin, indent)
            said = entry.origin
            is_long_list = isinstance(entry.value, list) and any(isinstance(item, dict) for item in entry.value)
            if is_long_list:
                lines += [f"{indent}{key}:", *(f"{indent}  - {as_yaml(item)}" for item in entry.value)]
            else:
                lines.append(f"{indent}{key}: {as_yaml(entry.value)}")
        else:
            said = ""
            lines += [f"{indent}{key}:", *_lines(entry, indent + "  ")]
        if not indent:
            lines.append("")
    return lines


def text_of(settings: Sequence[Setting], header: str) -> str:
    """The file. header: its first comment."""
    tree: dict[str, Any] = {}
    for setting in settings:
        _put(tree, setting.path.split("."), setting.value, setting.origin)
    return "\n".join([*_comment(header, ""), "", *_lines(tree)])


def own_settings(project: Project) -> list[Setting]:
    """Of own.yaml, the user's own keys, where it exists. Raises InputError."""
    path = project.folder / OWN
    if not path.exists():
        return []
    return [Setting(".".join(path_of), value, OWN) for path_of, value in _leaves(plain(read_section(path).values))]


def write(project: Project) -> None:
    """All that the steps have found so far."""
    status = {step.name: project.status(step) for step in project.steps}
    left = [name for name, what in status.items() if what not in (DONE, SKIPPED)]
    header = "Written by palpate-setup, which overwrites it: put own keys into own.yaml, next to this file.\n"
    if left:
        header += "Not complete: " + ", ".join(f"{name} ({'not done' if status[name] == OPEN else status[name]})" for name in left)
    else:
        header += "All steps are done."
    (project.folder / CONFIGURATION).write_text(text_of([*project.settings(), *own_settings(project)], header))
