"""Numbers within decoded messages, by paths such as wrench.force.x, position[2] or position[name=joint_a]."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, Callable, Iterator, Union

_STEP = re.compile(r"(?P<name>[^.\[\]]+)|\[(?P<index>\d+)\]|\[(?P<key>[A-Za-z_]\w*)=(?P<text>[^\]]*)\]")
MOST_LISTED = 60
LONGEST_LISTED = 16  # elements of one array
ABSENT = object()
Step = tuple[str, Union[str, int, tuple[str, str]]]


def _steps(path: str) -> list[Step]:
    """Raises ValueError for what is no path."""
    steps: list[Step] = []
    at = 0
    while at < len(path):
        if path[at] == "." and at > 0:
            at += 1
        found = _STEP.match(path, at)
        if found is None:
            raise ValueError(path)
        if found["name"] is not None:
            steps.append(("name", found["name"]))
        elif found["index"] is not None:
            steps.append(("index", int(found["index"])))
        else:
            steps.append(("element", (found["key"], found["text"])))
        at = found.end()
    return steps


def _member(message: Any, name: str) -> Any:
    if isinstance(message, Mapping):
        return message.get(name, ABSENT)
    return getattr(message, name, ABSENT)


def _is_array(value: Any) -> bool:
    return hasattr(value, "__len__") and hasattr(value, "__getitem__") and not isinstance(value, (str, bytes, Mapping))


def getter(path: str) -> Callable[[Any], Any]:
    """A function that takes the value out of a message; ABSENT where the message has none. position[name=a] is the element of
    position where the array `name` in its place reads "a". Raises ValueError for what is no path."""
    steps = _steps(path)

    def get(message: Any) -> Any:
        value, parent = message, ABSENT
        for kind, what in steps:
            if kind == "name":
                parent, value = value, _member(value, str(what))
            elif not _is_array(value):
                return ABSENT
            elif kind == "index":
                value = value[what] if int(what) < len(value) else ABSENT  # type: ignore[arg-type]
            else:
                key, text = what  # type: ignore[misc]
                labels = _member(parent, str(key))
                found = [i for i, label in enumerate(labels) if str(label) == text] if _is_array(labels) else []
                value = value[found[0]] if found and found[0] < len(value) else ABSENT
            if value is ABSENT:
                return ABSENT
        return value

    return get


def number_of(value: Any) -> Union[float, int, None]:
    """None for what is no number. A time (sec, nanosec) is in ns."""
    if isinstance(value, (int, float)):  # a truth value, too
        return value
    seconds = _member(value, "sec")
    if seconds is not ABSENT:
        rest = [part for part in (_member(value, name) for name in ("nanosec", "nsec")) if part is not ABSENT]
        return int(seconds) * 10**9 + int(rest[0] if rest else 0)
    try:
        return float(value) if getattr(value, "shape", None) == () else None
    except (TypeError, ValueError):
        return None


def is_time(value: Any) -> bool:
    return _member(value, "sec") is not ABSENT


def leaves(message: Any, prefix: str = "") -> Iterator[str]:
    """Paths of the numbers of a message."""
    if number_of(message) is not None:
        yield prefix
    elif _is_array(message):
        for i in range(min(len(message), LONGEST_LISTED)):
            yield from leaves(message[i], f"{prefix}[{i}]")
    elif not isinstance(message, (str, bytes)):
        members = message if isinstance(message, Mapping) else getattr(message, "__dict__", {})
        for name in members:
            if not str(name).startswith("_"):
                yield from leaves(_member(message, name), f"{prefix}.{name}" if prefix else str(name))
