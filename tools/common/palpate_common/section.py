"""YAML files whose values are read with checks that name file, line, key, value and what is allowed."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, NoReturn, Optional

import yaml

from palpate_common.input_error import WRONG_CONFIGURATION, InputError

REQUIRED = object()
DEEPEST = 16  # files that name each other as their base


class Mapping(dict):  # type: ignore[type-arg]
    """A mapping of a file. `places`: file and line of each key."""

    def __init__(self) -> None:
        super().__init__()
        self.places: dict[str, tuple[Path, int]] = {}


def plain(value: Any) -> Any:
    """The same of Python's own types, as yaml.safe_dump needs."""
    if isinstance(value, dict):
        return {key: plain(entry) for key, entry in value.items()}
    return [plain(entry) for entry in value] if isinstance(value, list) else value


class _Loader(yaml.SafeLoader):
    """Also reads numbers such as 30e3, as YAML 1.2 and palpated do."""

    file: Path


def _mapping(loader: _Loader, node: yaml.MappingNode) -> Mapping:
    loader.flatten_mapping(node)
    result = Mapping()
    for key_node, value_node in node.value:
        key = str(loader.construct_object(key_node, deep=True))
        result[key] = loader.construct_object(value_node, deep=True)
        result.places[key] = (loader.file, key_node.start_mark.line + 1)
    return result


_Loader.add_constructor("tag:yaml.org,2002:map", _mapping)
_Loader.add_implicit_resolver("tag:yaml.org,2002:float", re.compile(r"[-+]?(\d+\.?\d*|\.\d+)[eE][-+]?\d+$"), list("-+.0123456789"))


def _wrong(text: str) -> InputError:
    return InputError(text, WRONG_CONFIGURATION)


class Section:
    """One mapping. Keys that are read are remembered, so that check_unused() finds misspelt ones."""

    def __init__(self, values: Any, file: Path, path: str = "") -> None:
        self.values, self.file, self.path = values, file, path
        self._read: set[str] = set()
        if not isinstance(values, dict):
            raise _wrong(f"{file}{': ' + path if path else ''}: {values!r}; allowed: a mapping of keys")

    def _named(self, key: str) -> str:
        return f"{self.path}.{key}" if self.path else key

    def file_of(self, key: str) -> Path:
        """The file that states the key, to which relative names in its value refer."""
        place = getattr(self.values, "places", {}).get(key)
        return place[0] if place else self.file

    def fail(self, key: str, text: str) -> NoReturn:
        """Raises InputError with file, line and key."""
        place = getattr(self.values, "places", {}).get(key)
        where = f"{place[0]}:{place[1]}" if place else str(self.file)
        raise _wrong(f"{where}: {self._named(key)}: {text}")

    def has(self, key: str) -> bool:
        return self.values.get(key) is not None

    def _value(self, key: str, default: Any) -> Any:
        self._read.add(key)
        if self.has(key):
            return self.values[key]
        if default is REQUIRED:
            self.fail(key, "is absent; required")
        return default

    def raw(self, key: str, default: Any = REQUIRED) -> Any:
        """The value as it stands in the file, without a check of its type or range."""
        return self._value(key, default)

    def text(self, key: str, default: Any = REQUIRED) -> str:
        return str(self._value(key, default))

    def flag(self, key: str, default: bool) -> bool:
        value = self._value(key, default)
        if not isinstance(value, bool):
            self.fail(key, f"{value!r}; allowed: true, false")
        return value

    def choice(self, key: str, allowed: list[str], default: Any = REQUIRED) -> str:
        value = self.text(key, default)
        if value not in allowed:
            self.fail(key, f"{value}; allowed: {', '.join(allowed)}")
        return value

    def number(self, key: str, lower: float, upper: float, default: Any = REQUIRED) -> float:
        value = self._value(key, default)
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not lower <= value <= upper:
            self.fail(key, f"{value!r}; allowed: a number from {lower:g} to {upper:g}")
        return float(value)

    def whole(self, key: str, lower: int, upper: int, default: Any = REQUIRED) -> int:
        value = self._value(key, default)
        if isinstance(value, bool) or not isinstance(value, int) or not lower <= value <= upper:
            self.fail(key, f"{value!r}; allowed: a whole number from {lower} to {upper}")
        return value

    def numbers(self, key: str, count: int, lower: float, upper: float, default: Any = REQUIRED) -> list[float]:
        values = self._value(key, default)
        if not isinstance(values, list) or len(values) != count or not all(
            isinstance(v, (int, float)) and not isinstance(v, bool) and lower <= v <= upper for v in values
        ):
            self.fail(key, f"{values!r}; allowed: {count} numbers from {lower:g} to {upper:g}")
        return [float(value) for value in values]

    def names(self, key: str, count: int) -> list[str]:
        """Names of columns."""
        values = self._value(key, REQUIRED)
        if not isinstance(values, list) or len(values) != count:
            self.fail(key, f"{values!r}; allowed: the names of {count} columns")
        return [str(value) for value in values]

    def _below(self, key: str, value: Any) -> Section:
        if not isinstance(value, dict):
            self.fail(key, f"{value!r}; allowed: a mapping of keys")
        return Section(value, self.file_of(key), self._named(key))

    def section(self, key: str) -> Section:
        return self._below(key, self._value(key, REQUIRED))

    def optional(self, *keys: str) -> Section:
        """The section below these keys in turn; one without keys where any of them is absent."""
        result = self
        for key in keys:
            result = result._below(key, result._value(key, Mapping()))
        return result

    def sections(self, key: str, default: Any = REQUIRED) -> list[Section]:
        values = self._value(key, default)
        if not isinstance(values, list):
            self.fail(key, f"{values!r}; allowed: a list of mappings")
        return [Section(value, self.file_of(key), f"{self._named(key)}.{i}") for i, value in enumerate(values)]

    def check_unused(self) -> None:
        unknown = [key for key in self.values if key not in self._read]
        if unknown:
            self.fail(str(unknown[0]), f"is unknown; allowed: {', '.join(sorted(self._read))}")


def _load(file: Path) -> Any:
    try:
        loader = _Loader(file.read_text(encoding="utf-8"))
        loader.file = file
        return loader.get_single_data()
    except OSError as error:
        raise _wrong(f"{file}: {error.strerror}") from error
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        mark: Optional[yaml.Mark] = getattr(error, "problem_mark", None)
        line = f":{mark.line + 1}" if mark else ""
        raise _wrong(f"{file}{line}: {getattr(error, 'problem', None) or error}") from error


def read_section(file: Path) -> Section:
    """Raises InputError if the file cannot be read or is not a YAML mapping."""
    return Section(_load(file), file)


def merged(base: Mapping, over: Mapping) -> Mapping:
    """As palpated merges: mappings key by key, an empty entry removes, anything else replaces."""
    out = Mapping()
    out.update(base)
    out.places.update(base.places)
    for key, value in over.items():
        if value is None:
            out.pop(key, None)
        else:
            old = base.get(key)
            out[key] = merged(old, value) if isinstance(old, Mapping) and isinstance(value, Mapping) else value
            out.places[key] = over.places[key]
    return out


def read_configuration_section(file: Path, depth: int = 0) -> Section:
    """A configuration of palpated together with the file that it names as its `base`. Raises InputError."""
    section = read_section(file)
    base = section.values.pop("base", None)
    if base is None:
        return section
    if depth == DEEPEST:
        section.fail("base", f"{base}; allowed: at most {DEEPEST} files")
    below = read_configuration_section(file.parent / str(base), depth + 1)
    return Section(merged(below.values, section.values), file)
