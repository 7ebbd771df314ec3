"""The folder of a set-up: which steps are done, with which inputs and results."""

from __future__ import annotations

import hashlib
import json
import os
from datetime import datetime, timezone
from pathlib import Path
from typing import Any, Mapping, Optional, Sequence

from palpate_common.input_error import WRONG_CONFIGURATION, InputError
from palpate_setup.step import Result, Setting, Step

STATE, CONFIGURATION, OWN, REPORT = "setup.json", "palpate.yaml", "own.yaml", "report.html"
VERSION = 1
DONE, SKIPPED, FAILED, OPEN, OUTDATED = "done", "skipped", "failed", "open", "outdated"


def _hash(value: Any) -> str:
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()[:16]


def hash_of_file(path: Path) -> str:
    """Of its content; of a file that does not exist another one."""
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()[:16]
    except OSError:
        return "absent"


class Project:
    """Reads and writes the state file. A step whose inputs have changed since it was done is outdated: its answers and files,
    and the results of the steps that it needs."""

    def __init__(self, folder: Path, steps: Sequence[Step]) -> None:
        """Creates the folder if it does not exist. Raises InputError or OSError."""
        self.folder, self.steps = folder.resolve(), list(steps)
        self.folder.mkdir(parents=True, exist_ok=True)
        self._state = self._read()

    @property
    def configuration(self) -> Path:
        return self.folder / CONFIGURATION

    def step_folder(self, name: str) -> Path:
        """Created."""
        path = self.folder / "steps" / name
        path.mkdir(parents=True, exist_ok=True)
        return path

    def _read(self) -> dict[str, Any]:
        path = self.folder / STATE
        if not path.exists():
            return {}
        try:
            document = json.loads(path.read_text())
            if document["version"] != VERSION:
                raise InputError(f"{path}: version {document['version']}; allowed: {VERSION}", WRONG_CONFIGURATION)
            return dict(document["steps"])
        except (json.JSONDecodeError, KeyError, TypeError) as error:
            raise InputError(f"{path}: is no state of palpate-setup: {error}", WRONG_CONFIGURATION) from error

    def _write(self) -> None:
        text = json.dumps({"version": VERSION, "steps": self._state}, indent=1) + "\n"
        new = self.folder / (STATE + ".new")
        new.write_text(text)
        os.replace(new, self.folder / STATE)

    def record(self, step: Step, status: str, answers: Mapping[str, Any], result: Result, reason: str = "") -> None:
        """What became of a step."""
        settings = [[s.path, s.value, s.origin] for s in result.settings]
        self._state[step.name] = {
            "status": status, "time": datetime.now(timezone.utc).isoformat(timespec="seconds"), "reason": reason,
            "answers": dict(answers), "lines": result.lines, "settings": settings, "pictures": result.pictures,
            "data": result.data, "inputs": self._inputs(step, [self._name_of(path) for path in result.files]),
            "result": _hash([[s[:2] for s in settings], result.data]),
        }  # fmt: skip
        self._write()

    def fail(self, step: Step, answers: Mapping[str, Any], reason: str) -> None:
        """Keeps what an earlier run found, if there was one, and says why the step is not done now."""
        entry = self._state.setdefault(step.name, {"settings": [], "lines": [], "pictures": [], "data": {}, "inputs": {},
                                                   "result": ""})  # fmt: skip
        entry.update(status=FAILED, reason=reason, answers=dict(answers),
                     time=datetime.now(timezone.utc).isoformat(timespec="seconds"))  # fmt: skip
        self._write()

    def _name_of(self, path: Path) -> str:
        return os.path.relpath(path.resolve(), self.folder)

    def _inputs(self, step: Step, files: Sequence[str]) -> dict[str, Any]:
        return {"files": {name: hash_of_file(self.folder / name) for name in files},
                "steps": {name: self._state.get(name, {}).get("result", "") for name in step.needs}}  # fmt: skip

    def entry(self, name: str) -> Mapping[str, Any]:
        """What is recorded of a step; without keys if it has not been run."""
        return dict(self._state.get(name, {}))

    def data(self, name: str) -> Mapping[str, Any]:
        """Numbers of a step. Raises InputError if it is neither done nor skipped."""
        entry = self._state.get(name, {})
        if entry.get("status") not in (DONE, SKIPPED):
            raise InputError(f"step {name} has to be done first: --step {name}")
        return dict(entry["data"])

    def step(self, name: str) -> Step:
        return next(step for step in self.steps if step.name == name)

    def why_outdated(self, step: Step) -> Optional[str]:
        """The first changed input of a step that is done or skipped; None if there is none."""
        entry = self._state.get(step.name, {})
        if entry.get("status") not in (DONE, SKIPPED):
            return None
        inputs = entry["inputs"]
        for name, old in inputs["files"].items():
            if hash_of_file(self.folder / name) != old:
                return f"{name} has changed"
        for name, old in inputs["steps"].items():
            if self._state.get(name, {}).get("result", "") != old:
                return f"step {name} has another result"
            why = self.why_outdated(self.step(name))
            if why is not None:
                return f"step {name} is outdated: {why}"
        return None

    def status(self, step: Step) -> str:
        """DONE, SKIPPED, FAILED, OPEN or OUTDATED."""
        status = str(self._state.get(step.name, {}).get("status", OPEN))
        return OUTDATED if self.why_outdated(step) is not None else status

    def missing_needs(self, step: Step) -> list[str]:
        """Names of needed steps that are neither done nor skipped."""
        return [name for name in step.needs if self._state.get(name, {}).get("status") not in (DONE, SKIPPED)]

    def settings(self) -> list[Setting]:
        """Of all steps that left some, in their order."""
        return [Setting(*setting) for step in self.steps for setting in self._state.get(step.name, {}).get("settings", [])]
