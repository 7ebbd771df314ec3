"""Python packages that only some kinds of files need: the extra `recordings` of the Python package palpate."""

from __future__ import annotations

import importlib
from typing import Any

from palpate_common.input_error import InputError


def load(module: str, what: str) -> Any:
    """The module of an optional package. Raises InputError with the remedy where it is not installed."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        package = module.partition(".")[0]
        raise InputError(
            f"{what} need the Python package {package}: {error}; remedy: /usr/bin/python3 -m venv --system-site-packages "
            "~/palpate-venv && ~/palpate-venv/bin/pip install mcap rosbags, then start "
            "~/palpate-venv/bin/python $(command -v palpate-import)"
        ) from error
