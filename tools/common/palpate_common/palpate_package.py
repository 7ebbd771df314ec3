"""The Python package palpate, which only LCM and its logs need."""

from __future__ import annotations

from typing import Any

from palpate_common.input_error import InputError


def load() -> Any:
    """The module. Raises InputError if it is not installed."""
    try:
        import palpate
    except ImportError as error:
        remedy = "apt-get install python3-palpate"
        raise InputError(f"LCM and its logs need the Python package palpate: {error}; remedy: {remedy}") from error
    return palpate
