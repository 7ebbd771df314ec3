"""Mappings of a YAML file, read with checks that name file, key, value and what is allowed."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NoReturn

import yaml

REQUIRED = object()


class SectionError(Exception):
    """A wrong description or configuration."""


class Section:
    """One mapping. Keys that are read are remembered, so that check_unused() finds misspelt ones."""

    def __init__(self, values: Any, file: Path, path: str = "") -> None:
        self.values, self.file, self.path = values, file, path
        self._read: set[str] = set()
        if not isinstance(values, dict):
            raise SectionError(f"{file}{': ' + path if path else ''}: {values!r}; allowed: a mapping of keys")

    def fail(self, key: str, text: str) -> NoReturn:
        raise SectionError(f"{self.file}: {self.path + '.' if self.path else ''}{key}: {text}")

    def has(self, key: str) -> bool:
        return self.values.get(key) is not None

    def _value(self, key: str, default: Any) -> Any:
        self._read.add(key)
        if self.has(key):
            return self.values[key]
        if default is REQUIRED:
            self.fail(key, "is absent; required")
        return default

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

    def section(self, key: str) -> Section:
        return Section(self._value(key, REQUIRED), self.file, f"{self.path}.{key}" if self.path else key)

    def sections(self, key: str) -> list[Section]:
        values = self._value(key, REQUIRED)
        if not isinstance(values, list):
            self.fail(key, f"{values!r}; allowed: a list of mappings")
        path = f"{self.path + '.' if self.path else ''}{key}"
        return [Section(value, self.file, f"{path}.{i}") for i, value in enumerate(values)]

    def check_unused(self) -> None:
        unknown = [key for key in self.values if key not in self._read]
        if unknown:
            self.fail(str(unknown[0]), f"is unknown; allowed: {', '.join(sorted(self._read))}")


def read_section(file: Path) -> Section:
    """Raises SectionError if the file cannot be read or is not YAML."""
    try:
        return Section(yaml.safe_load(file.read_text()), file)
    except (OSError, UnicodeDecodeError) as error:
        raise SectionError(f"{file}: {error}") from error
    except yaml.YAMLError as error:
        raise SectionError(f"{file}: {str(error).splitlines()[0]}") from error
