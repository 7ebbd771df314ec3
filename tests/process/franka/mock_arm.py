"""The mock of a Franka arm as a process, and what tests with it share."""

from __future__ import annotations

import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Sequence

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "bridge"))

from steered_arm import BIN, SOURCE, wait_for  # noqa: E402

URDF = SOURCE / "tools/bridge/franka/examples/fr3.urdf"
IDLE, MOVING, REFLEX, USER_STOPPED = 1, 2, 4, 5  # robot_mode
# rad: the flange where the hand of bar_long_soft.yaml holds the bar.
HOLDING = (0.96765466, 1.36207806, -1.36894402, -2.1085352, 0.05533854, 4.26902917, -1.87965578)


@dataclass
class State:
    mode: int
    speed: float  # rad/s, of the fastest joint
    motions: int  # begun
    ended: int  # of them regularly
    commands: int
    reflexes: int
    q: "list[float]"
    violation: str  # of the protocol


class MockArm:
    """Runs until close()."""

    def __init__(
        self, q: Sequence[float] = HOLDING, address: str = "127.0.0.1", port: int = 0, urdf: "Path | str" = URDF
    ) -> None:
        words = [BIN / "franka_mock_arm", address, port, urdf, *q]
        self._process = subprocess.Popen(
            [str(word) for word in words], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1
        )
        self.port = int(self._process.stdout.readline().split()[1])

    def close(self) -> None:
        self._process.stdin.close()
        self._process.wait(10)
        self._process.stdout.close()

    def say(self, line: str) -> None:
        self._process.stdin.write(line + "\n")

    def state(self) -> State:
        self.say("state")
        numbers, _, violation = self._process.stdout.readline().strip().partition(";")
        words = numbers.split()[1:]
        counts = [int(word) for word in words[2:6]]
        return State(int(words[0]), float(words[1]), *counts, [float(word) for word in words[6:]], violation.strip())

    def seconds_to_rest(self) -> float:
        begin = time.monotonic()
        wait_for(lambda: self.state().speed < 1e-3, "the arm rests")
        return time.monotonic() - begin
