"""The servers of a simulated controller of Universal Robots: RTDE, version 2, which refuses what the
protocol does not allow; the interfaces for scripts; and the stream of a Robotiq FT 300.
"""

from __future__ import annotations

import math
import random
import selectors
import socket
import struct
import time
from typing import Any, Callable, Optional

import numpy as np
from ur_controller import REGISTERS, STEP, Controller, flange_pose

RTDE_PORT, SCRIPT_PORTS, FT300_PORT = 30004, (30002, 30003), 63351
_FT300_CYCLES = 5  # 100 Hz
_LONGEST = 2048  # bytes of names in a recipe
_MOST_MADE_UP_FOR = 0.02  # s

_FORMATS = {"DOUBLE": "d", "VECTOR3D": "3d", "VECTOR6D": "6d", "VECTOR6INT32": "6i", "INT32": "i",
            "UINT32": "I", "UINT8": "B", "UINT64": "Q"}  # fmt: skip
# As the guide lists them; those that Controller.values() does not have are zero.
_OUTPUTS = {
    name: kind
    for kind, names in {
        "DOUBLE": "timestamp actual_execution_time speed_scaling target_speed_fraction "
        "actual_momentum actual_main_voltage actual_robot_voltage actual_robot_current payload "
        "standard_analog_input0 standard_analog_input1 standard_analog_output0 "
        "standard_analog_output1",
        "VECTOR3D": "actual_tool_accelerometer payload_cog",
        "VECTOR6D": "target_q target_qd target_qdd target_current target_moment actual_q actual_qd "
        "actual_current joint_control_output actual_TCP_pose actual_TCP_speed actual_TCP_force "
        "target_TCP_pose target_TCP_speed joint_temperatures actual_joint_voltage tcp_offset "
        "ft_raw_wrench payload_inertia",
        "VECTOR6INT32": "joint_mode",
        "INT32": "robot_mode safety_mode",
        "UINT32": "safety_status_bits runtime_state robot_status_bits",
        "UINT64": "actual_digital_input_bits actual_digital_output_bits",
    }.items()
    for name in names.split()
}
_INPUTS = {
    "speed_slider_mask": "UINT32", "speed_slider_fraction": "DOUBLE",
    "standard_digital_output_mask": "UINT8", "standard_digital_output": "UINT8",
    "configurable_digital_output_mask": "UINT8", "configurable_digital_output": "UINT8",
    "tool_digital_output_mask": "UINT8", "tool_digital_output": "UINT8",
    "standard_analog_output_mask": "UINT8", "standard_analog_output_type": "UINT8",
    "standard_analog_output_0": "DOUBLE", "standard_analog_output_1": "DOUBLE",
}  # fmt: skip
for _kind, _type in (("int", "INT32"), ("double", "DOUBLE")):
    for _i in range(REGISTERS):
        _OUTPUTS[f"output_{_kind}_register_{_i}"] = _type
        _INPUTS[f"input_{_kind}_register_{_i}"] = _type


class Violation(Exception):
    """What a client may not send."""


class RtdeConnection:
    """One client: set-up in its order, then data in both directions."""

    def __init__(self, servers: "Servers", peer: socket.socket) -> None:
        self._servers, self.peer = servers, peer
        self._received = b""
        self._is_agreed = self.is_started = False
        self._outputs: list[str] = []
        self._inputs: dict[int, list[str]] = {}
        self._cycles = 1

    def registers(self) -> set[str]:
        return {name for names in self._inputs.values() for name in names}

    def receive(self, data: bytes) -> None:
        """Raises Violation."""
        self._received += data
        while len(self._received) >= 3:
            size, kind = struct.unpack_from(">HB", self._received)
            if size < 3:
                raise Violation(f"a package of {size} bytes")
            if len(self._received) < size:
                return
            fields, self._received = self._received[3:size], self._received[size:]
            self._handle(chr(kind), fields)

    def _handle(self, kind: str, fields: bytes) -> None:
        if kind == "V":
            (version,) = self._unpack(">H", fields)
            self._is_agreed = version == 2 and not self._servers.refuses_version
            return self._answer("V", bytes([self._is_agreed]))
        if not self._is_agreed:
            raise Violation(f"a package {kind} before version 2 is agreed")
        if kind == "v":
            self._unpack(">", fields)
            return self._answer("v", struct.pack(">4I", *self._servers.version))
        if kind == "O":
            return self._set_up_outputs(fields)
        if kind == "I":
            return self._set_up_inputs(fields)
        if kind in "SP":
            self._unpack(">", fields)
            self.is_started = kind == "S" and bool(self._outputs)
            return self._answer(kind, bytes([self.is_started or kind == "P"]))
        if kind == "U":
            return self._take_inputs(fields)
        raise Violation(f"a package of type {kind!r}")

    @staticmethod
    def _unpack(layout: str, fields: bytes) -> tuple[Any, ...]:
        try:
            return struct.unpack(layout, fields)
        except struct.error as error:
            raise Violation(f"{len(fields)} bytes: {error}") from error

    @staticmethod
    def _names(fields: bytes) -> list[str]:
        if len(fields) > _LONGEST:
            raise Violation(f"a recipe of {len(fields)} bytes")
        try:
            # Controllers tolerate a comma at the end, with which ur_rtde's client sends it.
            return fields.decode("ascii").removesuffix(",").split(",")
        except UnicodeDecodeError as error:
            raise Violation("a recipe that is not ASCII") from error

    def _set_up_outputs(self, fields: bytes) -> None:
        (rate,) = self._unpack(">d", fields[:8])
        if not 1 <= rate <= 1 / STEP:
            raise Violation(f"a rate of {rate}")
        self._cycles = max(1, round(1 / (STEP * rate)))
        names = self._names(fields[8:])
        types = [_OUTPUTS.get(name, "NOT_FOUND") for name in names]
        is_sound = "NOT_FOUND" not in types
        self._outputs = names if is_sound else []
        self._answer("O", bytes([1 if is_sound else 0]) + ",".join(types).encode())

    def _set_up_inputs(self, fields: bytes) -> None:
        names = self._names(fields)
        used = self._servers.registers_of_others(self)
        types = ["IN_USE" if name in used else _INPUTS.get(name, "NOT_FOUND") for name in names]
        recipe = 0
        if not {"IN_USE", "NOT_FOUND"} & set(types):
            recipe = len(self._inputs) + 1
            self._inputs[recipe] = names
        self._answer("I", bytes([recipe]) + ",".join(types).encode())

    def _take_inputs(self, fields: bytes) -> None:
        names = self._inputs.get(fields[0] if fields else 0)
        if names is None:  # start is for outputs alone: ur_rtde's client sends inputs without
            raise Violation("inputs without set-up")
        layout = ">" + "".join(_FORMATS[_INPUTS[name]] for name in names)
        for name, value in zip(names, self._unpack(layout, fields[1:])):
            if not math.isfinite(value):
                raise Violation(f"{name} is {value}")
            self._servers.controller.registers[name] = value

    def send_outputs(self, cycle: int) -> None:
        if not self.is_started or cycle % self._cycles != 0:
            return
        known = self._servers.controller.values()
        fields = b"\x01"
        for name in self._outputs:
            layout = ">" + _FORMATS[_OUTPUTS[name]]
            value = known.get(name)
            if value is None:
                fields += bytes(struct.calcsize(layout))
            elif _OUTPUTS[name].startswith("VECTOR"):
                fields += struct.pack(layout, *value)
            else:
                fields += struct.pack(layout, value)
        self._answer("U", fields)

    def _answer(self, kind: str, fields: bytes) -> None:
        self._servers.send(self.peer, struct.pack(">HB", len(fields) + 3, ord(kind)) + fields)


class ScriptConnection:
    """A client that sends programs."""

    def __init__(self, controller: Controller) -> None:
        self._controller, self._text = controller, ""

    def receive(self, data: bytes) -> None:
        self._text += data.decode("ascii", "replace")
        while "\nend\n" in self._text:
            program, self._text = self._text.split("\nend\n", 1)
            self._controller.load(program + "\nend\n")


class Servers:
    """All of them, in one thread. Attributes are faults."""

    def __init__(self, controller: Controller, address: str = "127.0.0.1", hand: float = 0.0) -> None:
        """`hand`: kg, on the FT 300, 0.1 m above its origin. Raises OSError if a port is in use."""
        self.controller = controller
        self.version = (5, 12, 0, 1101)
        self.violations: list[str] = []
        self.refuses_version = False
        self.is_silent = False  # neither takes nor sends
        self.delay = 0.0  # s, of RTDE's data
        self._hand, self._random = hand, random.Random(1)
        self._selector = selectors.DefaultSelector()
        self._clients: dict[socket.socket, Any] = {}
        self._ft300: list[socket.socket] = []
        self._waiting: list[tuple[float, socket.socket, bytes]] = []
        self._cycle = 0
        self._listeners = []
        for port, accept in (
            (RTDE_PORT, lambda peer: RtdeConnection(self, peer)),
            *((port, lambda peer: ScriptConnection(controller)) for port in SCRIPT_PORTS),
            (FT300_PORT, self._accept_ft300),
        ):
            listener = socket.create_server((address, port))
            listener.setblocking(False)
            self._listeners.append(listener)
            self._selector.register(listener, selectors.EVENT_READ, accept)

    def close(self) -> None:
        for peer in (*self._clients, *self._listeners):
            peer.close()
        self._selector.close()

    def drop(self) -> None:
        """Closes all connections, as a controller that restarts."""
        for peer in list(self._clients):
            self._end(peer)

    def registers_of_others(self, connection: RtdeConnection) -> set[str]:
        used: set[str] = set()
        for other in self._clients.values():
            if isinstance(other, RtdeConnection) and other is not connection:
                used |= other.registers()
        return used

    def _accept_ft300(self, peer: socket.socket) -> Optional[RtdeConnection]:
        self._ft300.append(peer)
        return None

    def send(self, peer: socket.socket, data: bytes) -> None:
        self._waiting.append((time.monotonic() + self.delay, peer, data))

    def _end(self, peer: socket.socket) -> None:
        self._selector.unregister(peer)
        del self._clients[peer]
        if peer in self._ft300:
            self._ft300.remove(peer)
        peer.close()

    def _serve(self) -> None:
        for key, _ in self._selector.select(0):
            peer: Any = key.fileobj
            if peer in self._listeners:
                client, _ = peer.accept()
                client.setblocking(False)
                client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                self._clients[client] = key.data(client)
                self._selector.register(client, selectors.EVENT_READ)
                continue
            try:
                data = peer.recv(65536)
            except OSError:
                data = b""
            if not data:
                self._end(peer)
                continue
            try:
                if self._clients[peer] is not None:
                    self._clients[peer].receive(data)
            except Violation as error:
                self.violations.append(str(error))
                self._end(peer)

    def _flush(self) -> None:
        now = time.monotonic()
        ready = [item for item in self._waiting if item[0] <= now]
        self._waiting = [item for item in self._waiting if item[0] > now]
        for _, peer, data in ready:
            if peer not in self._clients:
                continue
            try:
                peer.sendall(data)
            except OSError:
                self._end(peer)

    def _ft300_text(self) -> bytes:
        """Wrench of the hand on the sensor, whose axes are those of the flange."""
        force = flange_pose(self.controller.q)[:3, :3].T @ np.array([0, 0, -9.81 * self._hand])
        torque = np.cross([0.0, 0.0, 0.1], force)
        numbers = [n + self._random.gauss(0, 0.02) for n in force]
        numbers += [n + self._random.gauss(0, 0.001) for n in torque]
        return ("( " + " , ".join(f"{n:.4f}" for n in numbers) + " )").encode()

    def step(self) -> None:
        """One control cycle."""
        if not self.is_silent:
            self._serve()
        self.controller.cycle()
        self._cycle += 1
        if self.is_silent:
            return
        for client in list(self._clients.values()):
            if isinstance(client, RtdeConnection):
                client.send_outputs(self._cycle)
        if self._cycle % _FT300_CYCLES == 0 and self._ft300:
            text = self._ft300_text()
            for peer in self._ft300:
                self.send(peer, text)
        self._flush()

    def run(self, is_ended: Callable[[], bool]) -> None:
        """In real time; delays of more than 20 ms are not made up for."""
        due = time.monotonic()
        while not is_ended():
            self.step()
            due += STEP
            now = time.monotonic()
            if now < due:
                time.sleep(due - now)
            elif now - due > _MOST_MADE_UP_FOR:
                due = now
