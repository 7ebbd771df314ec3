"""A draw that palpate-sim plays and palpate-replay estimates."""

from __future__ import annotations

import importlib
import subprocess
import sys
from pathlib import Path
from typing import Any

SOURCE = Path(__file__).resolve().parents[3]
LOGS = ("sensors.log", "truth.log", "replay.log")


def run(*words: object) -> None:
    """Runs a program to its end. Raises RuntimeError with what it printed if it fails."""
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(map(str, words))}: exit code {done.returncode}\n{done.stderr}")


def palpate_package() -> Any:
    """The Python package of palpate: the installed one, or that of the release build."""
    try:
        return importlib.import_module("palpate")
    except ImportError:
        sys.path.append(str(SOURCE / "build/release/python"))
        return importlib.import_module("palpate")


def remove_logs(folder: Path) -> None:
    """Frees the space of a draw that has been scored."""
    for name in LOGS:
        (folder / name).unlink(missing_ok=True)
