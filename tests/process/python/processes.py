"""palpated and palpate-sim as processes on private URLs, for the tests in this folder."""

from __future__ import annotations

import os
import random
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path
from typing import IO, Any, Sequence

import palpate

BIN = Path(os.environ["PALPATE_BIN_DIR"])
SOURCE = Path(os.environ["PALPATE_SOURCE_DIR"])
EXAMPLES = SOURCE / "tools/examples/python"
SANITIZED = os.environ.get("PALPATE_SANITIZED", "") != ""
RTCHECK = os.environ.get("PALPATE_RTCHECK", "OFF") == "ON"
PATIENCE = 60.0  # s, of waits on a busy machine

BAR = SOURCE / "rt/config/examples/bar_long_soft.yaml"
SCENE = SOURCE / "sim/scenes/bar_long_soft_control.yaml"
COARSE = "object.elements=[10, 1, 1]"


# If a test is killed, the processes it has started end with it.
WITH_THE_TEST = ("setpriv", "--pdeathsig", "KILL")


class Program:
    """A program with its output in a file; ended with the test."""

    def __init__(self, test: unittest.TestCase, words: Sequence[object]) -> None:
        self._output: IO[str] = tempfile.TemporaryFile("w+")  # noqa: SIM115
        self.process = subprocess.Popen(
            [*WITH_THE_TEST, *(str(word) for word in words)],
            stdout=self._output,
            stderr=subprocess.STDOUT,
        )
        test.addCleanup(self._output.close)
        test.addCleanup(self.end)

    def output(self) -> str:
        self._output.seek(0)
        return self._output.read()

    def wait_for(self, text: str) -> None:
        """Raises AssertionError if it does not print this."""
        end = time.monotonic() + PATIENCE
        while text not in self.output():
            if self.process.poll() is not None or time.monotonic() > end:
                raise AssertionError(f"{text!r} is not in: {self.output()}")
            time.sleep(0.02)

    def end(self) -> int:
        """By SIGTERM; its exit code."""
        if self.process.poll() is None:
            self.process.terminate()
        try:
            return self.process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            self.process.kill()
            return self.process.wait()


class ProcessTest(unittest.TestCase):
    """Separate URLs and a separate folder for each test."""

    def setUp(self) -> None:
        generator = random.SystemRandom()
        group = f"239.255.{generator.randint(160, 250)}.{generator.randint(1, 250)}"
        port = generator.randint(10000, 32000)
        self.control = f"udpm://{group}:{port}?ttl=0"
        self.housekeeping = f"udpm://{group}:{port + 1}?ttl=0"
        self.urls = ["--set", f"bus.control={self.control}",
                     "--set", f"bus.housekeeping={self.housekeeping}"]  # fmt: skip
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        try:
            palpate.Bus(self.control).close()
        except OSError as error:
            self.skipTest(f"multicast does not work here: {error}")

    def start_daemon(self, configuration: Path = BAR, *more: object, **sets: str) -> Program:
        words: list[object] = [BIN / "palpated", "--config", configuration, *self.urls, *more]
        for key, value in sets.items():
            words += ["--set", f"{key.replace('__', '.')}={value}"]
        program = Program(self, words)
        program.wait_for("waits for start")
        return program

    def start_simulator(self, *more: object) -> Program:
        return Program(self, [BIN / "palpate-sim", SCENE, *self.urls, "--set", COARSE, *more])

    def connect(self, **more: Any) -> palpate.Daemon:
        daemon = palpate.Daemon(self.control, self.housekeeping, timeout=PATIENCE, **more)
        self.addCleanup(daemon.close)
        return daemon

    def run_example(self, name: str, *words: object) -> "subprocess.CompletedProcess[str]":
        """An example with the URLs of this test, unless it reads logs alone."""
        place: list[object] = ["--url", self.control, "--housekeeping", self.housekeeping,
                               "--timeout", PATIENCE]  # fmt: skip
        if name == "plot_shape_error.py":
            place = []
        command = [sys.executable, EXAMPLES / name, *place, *words]
        return subprocess.run(
            [*WITH_THE_TEST, *(str(word) for word in command)],
            capture_output=True,
            text=True,
            timeout=3 * PATIENCE,
        )
