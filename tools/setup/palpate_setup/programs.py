"""palpate's other programs, as processes."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import time
from pathlib import Path
from typing import Any, Callable, Optional, Sequence

from palpate_common.input_error import InputError

PATIENCE = 60.0  # s, until a program is ready or has ended after a signal
WITH_THIS_PROGRAM = ("setpriv", "--pdeathsig", "TERM", "--")
LINES = 8  # of a program's last words in an error


class Child:
    """A program that runs at the same time, with its output in a file; ended with the block, or with this program."""

    def __init__(self, words: Sequence[object], log: Path, shell: bool = False, cwd: Optional[Path] = None) -> None:
        self.name, self.log = Path(str(words[0]).split()[0]).name, log
        command = ["sh", "-c", str(words[0])] if shell else [str(word) for word in words]
        with log.open("w") as output:
            self.process = subprocess.Popen([*WITH_THIS_PROGRAM, *command], cwd=cwd, stdin=subprocess.DEVNULL, stdout=output,
                                            stderr=subprocess.STDOUT, start_new_session=True)  # fmt: skip

    def __enter__(self) -> Child:
        return self

    def __exit__(self, *_: object) -> None:
        self.end()

    def said(self) -> str:
        return self.log.read_text(errors="replace")

    def wait_for(self, text: str, patience: float = PATIENCE) -> None:
        """Until it prints this. Raises InputError with its last lines if it ends or is too late."""
        end = time.monotonic() + patience
        while text not in self.said():
            if self.process.poll() is not None:
                raise InputError(f"{self.name} has ended with {self.process.returncode}:\n{last_lines(self.said())}")
            if time.monotonic() > end:
                raise InputError(f"{self.name} does not report {text!r} in {patience:g} s:\n{last_lines(self.said())}")
            time.sleep(0.05)

    def is_running(self) -> bool:
        return self.process.poll() is None

    def end(self) -> None:
        """By SIGTERM to it and what it started; by SIGKILL where that does not suffice."""
        for number, patience in ((signal.SIGTERM, 10.0), (signal.SIGKILL, PATIENCE)):
            if self.process.poll() is not None:
                break
            os.killpg(self.process.pid, number)
            try:
                self.process.wait(patience)
            except subprocess.TimeoutExpired:
                continue


class Programs:
    """Finds programs in one folder, or else on the PATH."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def path(self, name: str) -> Path:
        """Raises InputError if it is not installed."""
        here = self._folder / name
        found = str(here) if here.is_file() else shutil.which(name)
        if found is None:
            raise InputError(f"{name} is neither in {self._folder} nor on the PATH; is palpate installed completely?")
        return Path(found)

    def run(self, name: str, *words: object, allowed: Sequence[int] = (0,), say: Optional[Callable[[str], None]] = None) -> str:
        """Its standard output. Raises InputError with its last lines for another exit code."""
        if say is not None:
            say(f"runs {name}")
        done = subprocess.run([self.path(name), *map(str, words)], capture_output=True, text=True, stdin=subprocess.DEVNULL)
        if done.returncode not in allowed:
            raise InputError(f"{name}: {last_lines(done.stderr or done.stdout)}")
        return done.stdout

    def run_json(self, name: str, *words: object, allowed: Sequence[int] = (0,)) -> Any:
        """What it prints as JSON."""
        text = self.run(name, *words, allowed=allowed)
        try:
            return json.loads(text)
        except json.JSONDecodeError as error:
            raise InputError(f"{name}: prints no JSON: {error}") from error

    def start(self, name: str, *words: object, log: Path) -> Child:
        return Child([self.path(name), *words], log)


def last_lines(text: str) -> str:
    """For an error."""
    return "\n".join(line for line in text.strip().splitlines()[-LINES:])
