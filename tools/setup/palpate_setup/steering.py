"""Moves the controlled point through a running palpated, and records what was commanded and what the arm did."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Callable, Optional, Sequence

import numpy as np
from numpy.typing import NDArray

from palpate_common.input_error import InputError
from palpate_common.rotations import from_wxyz, log_rotation

if TYPE_CHECKING:
    from palpate.daemon import Daemon

Floats = NDArray[np.float64]
AT_REST = 1e-3  # m/s, of the flange
AT_REST_TURNING = 5e-3  # rad/s
STILL = 0.3  # s of rest that end a motion
SAMPLE = 0.02  # s, between samples of a track
SILENCE = 20.0  # s without ROBOT_STATE


@dataclass
class Track:
    """Samples over time. time: s, by the robot's clock, since the start. position, commanded: (n, 3), m, of the flange since the
    start, in W; the latter is the integral of the commanded velocity. error: m, of the controlled point."""

    time: list[float] = field(default_factory=list)
    position: list[Floats] = field(default_factory=list)
    commanded: list[Floats] = field(default_factory=list)
    error: list[float] = field(default_factory=list)


class Steering:
    """Of one daemon with the feature `point`. Times are those of the robot's clock: a simulator on a busy machine is slower
    than real time."""

    def __init__(self, client: Daemon) -> None:
        self._client = client
        self.track = Track()
        self._start: Optional[tuple[int, Floats, Floats]] = None
        self._turn = np.zeros(3)
        self._now, self._since, self._patience = 0.0, 0.0, time.monotonic()
        self._integral, self._velocity = np.zeros(6), np.zeros(6)
        self._error: Optional[float] = None
        self._value: Optional[Floats] = None
        client.control.subscribe("ROBOT_STATE", self._robot)
        client.control.subscribe("TWIST_COMMAND", self._twist)
        client.control.subscribe("FEATURE", self._feature)

    def _robot(self, message: Any) -> None:
        position = np.array(message.position)
        if self._start is None:
            self._start = (message.utime, position, from_wxyz(np.array(message.quaternion)))
        before, self._now = self._now, 1e-6 * (message.utime - self._start[0])
        self._integral = self._integral + max(self._now - before, 0.0) * self._velocity
        self._patience = time.monotonic()
        self._turn = log_rotation(from_wxyz(np.array(message.quaternion)) @ self._start[2].T)
        if np.linalg.norm(message.twist[:3]) > AT_REST or np.linalg.norm(message.twist[3:]) > AT_REST_TURNING:
            self._since = self._now
        if not self.track.time or self._now > self.track.time[-1] + SAMPLE:
            self.track.time.append(self._now)
            self.track.position.append(position - self._start[1])
            self.track.commanded.append(self._integral[:3])
            self.track.error.append(np.nan if self._error is None else self._error)

    def _twist(self, message: Any) -> None:
        self._velocity = np.array(message.twist) if message.valid else np.zeros(6)

    def _feature(self, message: Any) -> None:
        self._value = np.array(message.value[:3])
        self._error = float(np.linalg.norm(message.error[: message.error_count])) if message.revision >= 0 else None

    @property
    def measured(self) -> Floats:
        """Way of the flange since the start, m, and rotation vector, rad, in W, (6,)."""
        return np.concatenate([self.track.position[-1] if self.track.position else np.zeros(3), self._turn])

    @property
    def commanded(self) -> Floats:
        """The same by the integral of the commanded twist; of small rotations."""
        return self._integral

    def _receive(self, check: Callable[[], None]) -> None:
        self._client.control.run(0.05)
        if time.monotonic() > self._patience + SILENCE:
            raise InputError(f"no ROBOT_STATE for {SILENCE:g} s")
        check()

    def wait_for_value(self) -> Floats:
        """The controlled point now, (3,), m, in O. Raises InputError where the daemon publishes none."""
        end = time.monotonic() + SILENCE
        while self._value is None or not self.track.time:
            self._client.control.run(0.05)
            if time.monotonic() > end:
                raise InputError(f"no {'FEATURE' if self._value is None else 'ROBOT_STATE'} in {SILENCE:g} s after the start")
        return self._value

    def move(self, target: Sequence[float], tolerance: float, patience: float, check: Callable[[], None]) -> float:
        """Steers the point to a place in O, m, until its error is below the tolerance and the hand rests; the remaining error.
        check: called all the time; raises InputError to stop. Raises InputError also where the daemon is no longer active, or
        the point is not there in time."""
        self._client.target("point", list(target))
        self._error = None
        begin, ask = self._now, time.monotonic() + 1.0
        while True:
            self._receive(check)
            if self._error is not None and self._error < tolerance and self._now > max(self._since, begin) + STILL:
                return self._error
            if self._now > begin + patience:
                shown = "no error is published" if self._error is None else f"{1e3 * self._error:.1f} mm are left"
                raise InputError(f"the point has not reached its target in {patience:g} s: {shown}")
            if time.monotonic() > ask:
                ask = time.monotonic() + 1.0
                state = self._client.state()
                if state not in ("active", "degraded"):
                    raise InputError(f"palpated is {state} during the motion; palpated.txt says why")

    def rest(self, seconds: float, check: Callable[[], None]) -> None:
        """Lets the hand rest."""
        end = self._now + seconds
        while self._now < end:
            self._receive(check)
