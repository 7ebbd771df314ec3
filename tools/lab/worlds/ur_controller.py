"""A controller of Universal Robots, as far as its clients see it: registers, modes, one program, and
six joints that follow speedj. Kinematics of a UR5e.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, Optional

import numpy as np
import urscript

STEP = 0.002  # s, control cycle of an e-Series
JOINTS = 6
REGISTERS = 48
_LAG = 0.002  # s, of the joints
_BRAKES = 30.0  # rad/s^2, of its own stops
_START_UP = 40  # cycles until a program runs

# Denavit-Hartenberg parameters of a UR5e as its manufacturer publishes them: d, a in m, alpha.
_D = (0.1625, 0.0, 0.0, 0.1333, 0.0997, 0.0996)
_A = (0.0, -0.425, -0.3922, 0.0, 0.0, 0.0)
_ALPHA = (math.pi / 2, 0.0, 0.0, math.pi / 2, -math.pi / 2, 0.0)

ROBOT_MODE_POWER_OFF, ROBOT_MODE_RUNNING = 3, 7
STOPPED, PLAYING, PAUSED = 1, 2, 4  # runtime_state
_NORMAL, _PROTECTIVE, _EMERGENCY = 1, 1 << 2, 1 << 6 | 1 << 7  # safety_status_bits


def flange_pose(q: "np.ndarray[Any, Any]") -> "np.ndarray[Any, Any]":
    """4 x 4, in the base."""
    pose = np.eye(4)
    for angle, d, a, alpha in zip(q, _D, _A, _ALPHA):
        c, s, ca, sa = math.cos(angle), math.sin(angle), math.cos(alpha), math.sin(alpha)
        pose = pose @ np.array(
            [[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]]
        )
    return pose


def rotation_vector(rotation: "np.ndarray[Any, Any]") -> "np.ndarray[Any, Any]":
    """Axis times angle."""
    angle = math.acos(min(1.0, max(-1.0, (np.trace(rotation) - 1) / 2)))
    if angle < 1e-9:
        return np.zeros(3)
    if math.pi - angle < 1e-6:
        axis = np.sqrt(np.maximum(0.0, (np.diag(rotation) + 1) / 2))
        k = int(np.argmax(axis))
        signs = np.sign(rotation[k] + rotation[:, k])
        signs[k] = 1
        half_turn: "np.ndarray[Any, Any]" = angle * axis * np.where(signs == 0, 1, signs)
        return half_turn
    skew = rotation - rotation.T
    turn: "np.ndarray[Any, Any]" = np.array([skew[2, 1], skew[0, 2], skew[1, 0]])
    turn *= angle / (2 * math.sin(angle))
    return turn


@dataclass
class Controller:
    """Its attributes may be changed while it runs: faults."""

    q: "np.ndarray[Any, Any]"  # rad
    payload: float = 0.0  # kg
    tcp_offset: tuple[float, ...] = (0.0,) * 6  # m, rotation vector
    tcp_force: tuple[float, ...] = (0.0,) * 6  # N, N m, in the base
    is_emergency_stopped: bool = False
    is_protectively_stopped: bool = False
    takes_programs: bool = True  # remote control
    has_nan: bool = False  # in actual_q

    time: float = 0.0  # s
    runtime_state: int = STOPPED
    program: str = ""
    programs: int = 0  # started
    errors: list[str] = field(default_factory=list)  # of programs
    registers: dict[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.q = np.array(self.q, dtype=float)
        self.qd = np.zeros(JOINTS)
        self._wanted = np.zeros(JOINTS)
        self._run: Optional[urscript.Cycles] = None
        self._begins_in = 0
        for way in ("input", "output"):
            for kind in ("int", "double"):
                for i in range(REGISTERS):
                    self.registers[f"{way}_{kind}_register_{i}"] = 0

    # Programs

    def load(self, text: str) -> None:
        """As sent to the interface for scripts: takes the place of the present program."""
        if not self.takes_programs or self._stop_bits or self.robot_mode != ROBOT_MODE_RUNNING:
            return
        try:
            self.program, self._run = urscript.load(
                text,
                {
                    "get_steptime": lambda: STEP,
                    "norm": abs,
                    "read_input_integer_register": lambda i: int(self._input("int", i)),
                    "read_input_float_register": lambda i: self._input("double", i),
                    "write_output_integer_register": self._write_output,
                },
                {"speedj": self._speedj, "stopj": self._stopj},
            )
        except urscript.ScriptError as error:
            self.errors.append(str(error))
            return
        self.programs += 1
        self.runtime_state, self._begins_in = PLAYING, _START_UP

    def stop(self) -> None:
        """Ends the program, as its button does."""
        self._run, self.program, self.runtime_state = None, "", STOPPED

    def _input(self, kind: str, index: int) -> float:
        return self.registers[f"input_{kind}_register_{index}"]

    def _write_output(self, index: int, value: int) -> None:
        name = f"output_int_register_{index}"
        if name not in self.registers or not isinstance(value, int):
            raise urscript.ScriptError(f"{name} = {value!r}")
        self.registers[name] = value

    def _speedj(self, qd: list[float], acceleration: float, seconds: float) -> urscript.Cycles:
        if len(qd) != JOINTS or not all(map(math.isfinite, qd)) or acceleration <= 0:
            raise urscript.ScriptError(f"speedj({qd}, {acceleration}, {seconds})")
        for _ in range(max(1, round(seconds / STEP))):
            self._approach(np.array(qd), acceleration)
            yield

    def _stopj(self, acceleration: float) -> urscript.Cycles:
        while self._wanted.any():
            self._approach(np.zeros(JOINTS), acceleration)
            yield

    def _approach(self, wanted: "np.ndarray[Any, Any]", acceleration: float) -> None:
        step = acceleration * STEP
        self._wanted = self._wanted + np.clip(wanted - self._wanted, -step, step)

    # Cycle

    @property
    def _stop_bits(self) -> int:
        return self.is_emergency_stopped * _EMERGENCY | self.is_protectively_stopped * _PROTECTIVE

    @property
    def robot_mode(self) -> int:
        return ROBOT_MODE_POWER_OFF if self.is_emergency_stopped else ROBOT_MODE_RUNNING

    @property
    def speed(self) -> float:
        """rad/s, of the fastest joint."""
        return float(np.abs(self.qd).max())

    def cycle(self) -> None:
        self.time += STEP
        if self.is_emergency_stopped and self._run is not None:
            self.stop()
        if self._run is not None:
            self.runtime_state = PAUSED if self.is_protectively_stopped else PLAYING
        if self.runtime_state == PLAYING and self._run is not None:
            self._advance()
        else:
            self._approach(np.zeros(JOINTS), _BRAKES if self._stop_bits else 10.0)
        self.qd = self.qd + min(1.0, STEP / _LAG) * (self._wanted - self.qd)
        self.q = self.q + STEP * self.qd

    def _advance(self) -> None:
        if self._begins_in > 0:
            self._begins_in -= 1
            return
        assert self._run is not None
        try:
            next(self._run)
        except StopIteration:
            self.stop()
        except (urscript.ScriptError, TypeError, NameError, KeyError) as error:
            self.errors.append(f"{self.program}: {error}")
            self.stop()

    # Outputs

    def values(self) -> dict[str, Any]:
        """Outputs of RTDE by name: numbers, or sequences of them."""
        pose = flange_pose(self.q)
        q = [math.nan, *self.q[1:]] if self.has_nan else self.q
        safety_mode = 7 if self.is_emergency_stopped else 3 if self.is_protectively_stopped else 1
        status = (self.robot_mode == ROBOT_MODE_RUNNING) | (self.runtime_state == PLAYING) << 1
        return {
            **self.registers, "timestamp": self.time, "actual_q": q, "target_q": q,
            "actual_qd": self.qd, "target_qd": self._wanted, "actual_current": 0.1 * self.qd,
            "actual_TCP_pose": [*pose[:3, 3], *rotation_vector(pose[:3, :3])],
            "actual_TCP_force": self.tcp_force, "tcp_offset": self.tcp_offset,
            "payload": self.payload, "robot_mode": self.robot_mode, "safety_mode": safety_mode,
            "safety_status_bits": self._stop_bits or _NORMAL, "runtime_state": self.runtime_state,
            "robot_status_bits": status, "speed_scaling": 1.0,
        }  # fmt: skip
