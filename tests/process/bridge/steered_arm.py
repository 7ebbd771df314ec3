"""palpated, a bridge and an arm behind it: what tests of bridges share."""

from __future__ import annotations

import os
import sys
import tempfile
import time
import unittest
from pathlib import Path
from typing import Callable, Sequence

SOURCE = Path(os.environ["PALPATE_SOURCE_DIR"])
BIN = Path(os.environ["PALPATE_BIN_DIR"])
sys.path.insert(0, str(SOURCE / "tools/lab/worlds"))

import palpate  # noqa: E402
from live_run import Program, private_urls  # noqa: E402
from palpate.messages import feature_t, robot_state_t  # noqa: E402

REST_POINT = (0.25, 0.03, 0.06)
STOP = 0.1  # s
PATIENCE = 40.0  # s
# Of a machine that other programs load: lateness neither degrades nor stops.
PATIENT = ["loop.degraded_after_ms=9000", "loop.overrun_window_ms=10000", "loop.safe_stop_after_ms=9000"]


def wait_for(condition: Callable[[], bool], what: str) -> None:
    end = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > end:
            raise AssertionError(f"not within {PATIENCE:g} s: {what}")
        time.sleep(0.001)


def holds(test: unittest.TestCase, condition: Callable[[], bool], seconds: float, what: str) -> None:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        test.assertTrue(condition(), what)
        time.sleep(0.002)


class SteeredArm(unittest.TestCase):
    """Runs the bridge `program` by the configuration of start(), and palpated with the soft bar."""

    program = ""
    connected = "connected"  # what it then prints

    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.control, self.housekeeping = private_urls(2)

    def speed(self) -> float:
        """rad/s, of the arm's fastest joint."""
        raise NotImplementedError

    def start(self, bridge: str, overrides: Sequence[str]) -> None:
        """`bridge`: its configuration; `overrides`: of palpated's."""
        (self.folder / "bridge.yaml").write_text(bridge)
        self.bridge = self.start_bridge()
        sets = [f"bus.control={self.control}", f"bus.housekeeping={self.housekeeping}", *PATIENT, *overrides]
        configuration = SOURCE / "rt/config/examples/bar_long_soft.yaml"
        words = [word for text in sets for word in ("--set", text)]
        self.palpated = Program("palpated", [BIN / "palpated", "--config", configuration, *words], self.folder)
        self.addCleanup(self.palpated.end)
        self.palpated.wait_for("waits for start")
        self.states: "list[robot_state_t]" = []
        self.features: "list[feature_t]" = []
        self.bus = palpate.Bus(self.control)
        self.addCleanup(self.bus.close)
        self.bus.subscribe("ROBOT_STATE", self.states.append)
        self.bus.subscribe("FEATURE", self.features.append)
        self.daemon = palpate.Daemon(self.control, self.housekeeping, timeout=30)
        self.addCleanup(self.daemon.close)

    def start_bridge(self) -> Program:
        bridge = Program(self.program, [BIN / self.program, "--config", self.folder / "bridge.yaml"], self.folder)
        self.addCleanup(bridge.end)
        bridge.wait_for(self.connected)
        return bridge

    def move(self, height: float) -> None:
        """Until the arm moves: stops and starts palpated, as after any stop, and again where a
        loaded machine has stopped it meanwhile.
        """

        def moves() -> bool:
            self.daemon.stop()
            wait_for(lambda: self.speed() < 1e-3, "the arm rests")
            self.daemon.start()
            self.daemon.target("point", (0.25, 0.03, 0.06 + height), points=[REST_POINT])
            end = time.monotonic() + 3
            while self.speed() < 0.01 and time.monotonic() < end:
                time.sleep(0.001)
            return self.speed() >= 0.01

        wait_for(moves, f"the arm moves; {self.bridge.output()}")

    def latest(self, messages: "list") -> object:
        self.bus.drain()
        return messages[-1]
