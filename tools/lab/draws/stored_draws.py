"""Results of a study's draws, kept in files so that an interrupted study resumes."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any, Callable, Iterable


def fingerprint(sources: Iterable[Path]) -> str:
    """Hash of the bytes and names of files, and of all Python sources and programs in folders."""
    digest = hashlib.sha256()
    for source in sources:
        files = sorted(f for f in source.rglob("*") if _is_code(f)) if source.is_dir() else [source]
        if not files:
            raise ValueError(f"{source}: has no sources")
        for file in files:
            digest.update(str(file.relative_to(source.parent)).encode() + b"\0")
            digest.update(hashlib.sha256(file.read_bytes()).digest())
    return digest.hexdigest()[:16]


def _is_code(file: Path) -> bool:
    return file.is_file() and file.suffix in ("", ".py", ".yaml") and file.parent.name != "__pycache__"


class StoredDraws:
    """Results of draws in `folder`, which is made. `sources` are the files and folders with the code that
    makes a result (programs, packages, the study itself, configurations): a result that others made is
    computed again. An interrupted draw leaves no result."""

    def __init__(self, folder: Path, sources: Iterable[Path]):
        self._folder = folder
        self._made_by = fingerprint(sources)
        folder.mkdir(parents=True, exist_ok=True)

    def get(self, name: str, compute: Callable[[], Any]) -> Any:
        """The stored result `name`, or else that of `compute`: numbers, text, lists and dictionaries."""
        file = self._folder / f"{name}.json"
        stored = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
        if stored.get("made_by") != self._made_by:
            stored = {"made_by": self._made_by, "result": compute()}
            partial = file.with_suffix(".partial")
            partial.write_text(json.dumps(stored, indent=1), encoding="utf-8")
            partial.replace(file)
        return json.loads(json.dumps(stored["result"]))
