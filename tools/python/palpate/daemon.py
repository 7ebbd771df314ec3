"""Commands to a running palpated, and its published state."""

from __future__ import annotations

import json
import os
import time
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Sequence, Union

import numpy as np

from palpate import messages
from palpate.authentication import Sealer, read_key_file
from palpate.bus import CONTROL_URL, HOUSEKEEPING_URL, Bus
from palpate.channel_table import CHANNELS
from palpate.channels import field_of, text_of
from palpate.closing import Closing
from palpate.mesh import Mesh, MeshBuilder
from palpate.touch import Touch, TouchError, TouchTimeout, run_touch

STATES = ("unconfigured", "inactive", "active", "degraded", "faulted", "finalized")
_REPEAT = 0.2  # s, after which an unanswered command is repeated
_RENEW = 0.03  # s; a manual force expires after 0.1 s
_BUSY = "another replacement is under way"
_MOST_POINTS, _MOST_VALUES, _MOST_CHUNKS = 64, 192, 8  # the first two of a chunk


class Refused(RuntimeError):
    """The daemon rejected a command; the text gives the reason."""


class NoAnswer(TimeoutError):
    """No answer within the time-out."""


class Answer(NamedTuple):
    """The daemon's answer to a command: start, replaced, target, ..., and the reason."""

    event: str
    reason: str


class Daemon(Closing):
    """Commands palpated over its two URLs. Each command is sent again until it is answered, and
    carried out once; it raises Refused with the daemon's reason, or NoAnswer.

    with Daemon() as daemon:
        daemon.start()
        daemon.target("point", [0.25, 0.03, 0.08])
    """

    def __init__(
        self,
        control: str = CONTROL_URL,
        housekeeping: str = HOUSEKEEPING_URL,
        key_file: Union[str, "os.PathLike[str]", None] = None,
        timeout: float = 10.0,
        transport: str = "python",
        channels: Optional[Mapping[str, str]] = None,
    ) -> None:
        """key_file, channels: as the daemon's access.key_file and bus.channels; timeout: s, for
        each command. Raises ValueError for an invalid URL, key file or name of a channel, OSError
        if the system refuses them."""
        key = None if key_file is None else read_key_file(key_file)
        self.timeout = timeout
        self.control = Bus(control, transport, channels)
        try:
            self.housekeeping = Bus(housekeeping, transport, channels)
        except BaseException:
            self.control.close()
            raise
        self._events = self.housekeeping.subscribe("COMPONENT_EVENT")
        self._health = self.housekeeping.subscribe("HEALTH", queue=1)
        self._shapes = self.housekeeping.subscribe("SHAPE", queue=1)
        self._meshes = MeshBuilder()
        self.housekeeping.subscribe("SHAPE_MESH", self._meshes.add)
        self._sealers = {
            channel: Sealer(channel, key)
            for channel, entry in CHANNELS.items()
            if entry.sender == "user"
        }
        self._revision = 0

    def start(self) -> Answer:
        """Activates the daemon: it senses, and follows a target once one is received."""
        return self.command("start")

    def stop(self) -> Answer:
        """Zero command, inactive."""
        return self.command("stop")

    def reset(self) -> Answer:
        """Leaves the fault state: back to the rest shape, inactive; call start() afterwards."""
        return self.command("reset")

    def zero(self) -> Answer:
        """Tares the sensors; the hand must not hold anything."""
        return self.command("zero")

    def calibrate(self) -> Answer:
        """The same, by its other name."""
        return self.command("calibrate")

    def replace(
        self,
        slot: str,
        component: str = "",
        parameters: Union[str, Mapping[str, Any], None] = None,
        instance: str = "",
    ) -> Answer:
        """Another component in a slot while the loop runs, or other parameters for the
        current one if `component` is empty. `parameters`: a mapping as in the configuration,
        or its YAML; slot "all": sections. Returns once the new one is active."""
        text = parameters if isinstance(parameters, str) else ""
        if isinstance(parameters, Mapping):
            text = json.dumps(parameters, allow_nan=False)  # which is YAML
        end = time.monotonic() + self.timeout
        while True:
            try:
                return self.command("replace", slot, component, text, instance)
            except Refused as refused:
                # The previous one is being destroyed.
                if _BUSY not in str(refused) or time.monotonic() > end:
                    raise
            self.housekeeping.run(0.05)

    def command(
        self,
        event: str,
        slot: str = "all",
        component: str = "",
        parameters: str = "",
        instance: str = "",
    ) -> Answer:
        """Sends one COMPONENT_COMMAND and waits for its completion."""
        message = messages.component_command_t()
        message.event = field_of(event, 16, "event")
        message.slot = field_of(slot, 32, "slot")
        message.instance = field_of(instance, 32, "instance")
        message.component = field_of(component, 32, "component")
        message.parameters = field_of(parameters, 2048, "parameters")

        def renew() -> None:
            message.utime = 0
            self.control.stamp("COMPONENT_COMMAND", message)
            self._sealers["COMPONENT_COMMAND"].put(message)

        def send() -> int:  # identical in each repetition, so that the daemon recognises it
            self.control.publish_sealed("COMPONENT_COMMAND", message)
            counter: int = message.counter
            return counter

        renew()
        return self._ask(event, send, renew)

    def target(
        self,
        kind: str,
        values: Sequence[float],
        points: Optional[Sequence[Sequence[float]]] = None,
    ) -> Answer:
        """Target of the feature: m, rad, 1/m; a pose as position and quaternion w x y z, in
        O. `points`: (n, 3), rest points in O, m, as configured; needed for
        evaluate.feature_error(). More than 64 points are sent in chunks, up to 512."""
        numbers = np.asarray(values, float).ravel()
        rest = np.asarray([] if points is None else points, float).reshape(-1, 3)
        chunks = _chunks(kind, rest, numbers)

        def send() -> int:
            # The daemon does not answer a repeated target: a new revision of it is answered, with
            # the counter of the chunk that completed it.
            self._revision += 1
            counter = 0
            for message in chunks:
                message.revision = self._revision
                message.utime = 0
                self.control.stamp("SHAPE_TARGET", message)
                counter = self._sealers["SHAPE_TARGET"].put(message)
                self.control.publish_sealed("SHAPE_TARGET", message)
            return counter

        return self._ask("target", send)

    def push(
        self, rest_point: Sequence[float], force: Sequence[float], duration: float = 0.0
    ) -> None:
        """Applies a force (N, in O) to the object at a rest point (m, in O), renewed for
        `duration` s; it ends 0.1 s after the last renewal. The configuration needs a sensor
        `component: manual`. Receives the daemon's messages meanwhile."""
        end = time.monotonic() + duration
        while True:
            message = messages.manual_force_t()
            message.rest_point = [float(x) for x in rest_point]
            message.force = [float(x) for x in force]
            if len(message.rest_point) != 3 or len(message.force) != 3:
                raise ValueError("rest_point and force have three numbers each")
            self.control.stamp("MANUAL_FORCE", message)
            self._sealers["MANUAL_FORCE"].put(message)
            self.control.publish_sealed("MANUAL_FORCE", message)
            left = end - time.monotonic()
            if left <= 0:
                return
            self.housekeeping.run(min(left, _RENEW))

    def touch(
        self,
        direction: Sequence[float],
        force: float,
        speed: float = 0.0,
        distance: float = 0.0,
        retreat: float = 0.0,
        progress: Optional[Callable[[Touch], None]] = None,
    ) -> Touch:
        """Guarded motion: moves along `direction` (in W, of any length) until the force against
        the motion reaches `force` (N), backs off, and returns the touched point. speed (m/s),
        distance (m, after which it ends without contact) and retreat (m): 0 as configured.
        `progress` is called with each state on the way. The configuration needs the control law
        guarded_motion. Raises Refused, or NoAnswer if the daemon is silent for the time-out; an
        exception, also of `progress`, stops the motion."""
        sealer = self._sealers["TOUCH_REQUEST"]
        try:
            return run_touch(
                self.control, sealer, self.timeout, direction, force, speed, distance, retreat,
                progress,
            )  # fmt: skip
        except TouchError as error:
            raise Refused(f"touch: {error}") from None
        except TouchTimeout as error:
            raise NoAnswer(str(error)) from None

    def health(self, timeout: Optional[float] = None) -> messages.health_t:
        """The next HEALTH published from now on. Raises NoAnswer."""
        message: messages.health_t = self._fresh(self._health, timeout)
        return message

    def shape(self, timeout: Optional[float] = None) -> messages.shape_t:
        """The next SHAPE from now on; positions of all nodes are np.reshape(shape.xyz, (-1, 3)),
        m in O.
        Raises NoAnswer."""
        message: messages.shape_t = self._fresh(self._shapes, timeout)
        return message

    def mesh(self, timeout: float = 20.0) -> Mesh:
        """The mesh of the current shape, which the daemon publishes once a second. Raises
        NoAnswer.
        """
        wanted = self.shape(timeout).mesh_hash
        end = time.monotonic() + timeout
        while wanted not in self._meshes.meshes:
            left = end - time.monotonic()
            if left <= 0:
                raise NoAnswer(f"no whole mesh in {timeout} s on {self.housekeeping.url}")
            self.housekeeping.handle(left)
        return self._meshes.meshes[wanted]

    def state(self) -> str:
        """unconfigured, inactive, active, degraded, faulted or finalized, as published from
        now on.
        """
        number = self.health().state
        return STATES[number] if 0 <= number < len(STATES) else str(number)

    def wait_for(self, condition: Callable[[messages.health_t], bool], timeout: float) -> Any:
        """The first HEALTH that satisfies `condition`. Raises NoAnswer."""
        try:
            return self._health.wait_for(condition, timeout)
        except TimeoutError as error:
            raise NoAnswer(str(error)) from None

    def close(self) -> None:
        self.control.close()
        self.housekeeping.close()

    def _fresh(self, subscription: Any, timeout: Optional[float]) -> Any:
        self.housekeeping.drain()
        subscription.clear()
        try:
            return subscription.get(self.timeout if timeout is None else timeout)
        except TimeoutError as error:
            raise NoAnswer(str(error)) from None

    def _ask(
        self, what: str, send: Callable[[], int], renew: Callable[[], None] = lambda: None
    ) -> Answer:
        """`renew` is called if the command was signed before the daemon's start, which would
        never accept it."""
        self.housekeeping.drain()
        self._events.clear()  # published before
        end = time.monotonic() + self.timeout
        first = last = send()
        again = time.monotonic() + _REPEAT
        known = f"is palpated running on {self.control.url} and {self.housekeeping.url}?"
        while (now := time.monotonic()) < end:
            if now >= again:
                last = send()
                again = now + _REPEAT
            try:
                event = self._events.get(min(again, end) - now)
            except TimeoutError:
                continue
            name, reason = text_of(event.event), text_of(event.reason)
            if name == "no_access":
                known = f"{name}: {reason}"
            if not first <= event.command_counter <= last:
                continue
            if name == "no_access":
                if event.command_counter == last:
                    renew()
            elif name == "replacing":
                known = "the replacement has begun, but its end was not reported"
            elif name == "refused":
                raise Refused(f"{what}: {reason}")
            else:
                return Answer(name, reason)
        raise NoAnswer(f"{what}: no answer in {self.timeout:g} s; {known}")


def _chunks(kind: str, rest: Any, numbers: Any) -> List[messages.shape_target_t]:
    """A target as messages, all full except the last."""
    by_points = -(-len(rest) // _MOST_POINTS)
    by_values = -(-len(numbers) // _MOST_VALUES)
    count = max(1, by_points, by_values)
    if count > _MOST_CHUNKS:
        raise ValueError(
            f"at most {_MOST_CHUNKS * _MOST_VALUES} values and {_MOST_CHUNKS * _MOST_POINTS} "
            "points fit"
        )
    if count > 1 and len(rest) > 0 and by_points != by_values:
        raise ValueError(f"more than {_MOST_POINTS} points have three values each")
    chunks = []
    for chunk in range(count):
        points = rest[chunk * _MOST_POINTS : (chunk + 1) * _MOST_POINTS]
        values = numbers[chunk * _MOST_VALUES : (chunk + 1) * _MOST_VALUES]
        message = messages.shape_target_t()
        message.kind = field_of(kind, 32, "kind")
        message.chunk, message.chunks = chunk, count
        message.point_count, message.value_count = len(points), len(values)
        message.rest_points = _padded(points, _MOST_POINTS).tolist()
        message.values = _padded(values, _MOST_VALUES).tolist()
        chunks.append(message)
    return chunks


def _padded(numbers: Any, length: int) -> Any:
    padded = np.zeros((length, *numbers.shape[1:]))
    padded[: len(numbers)] = numbers
    return padded


def health_inputs(health: messages.health_t) -> Dict[str, Dict[str, float]]:
    """For each input: received, lost, rejected, frozen (messages) and age_ms."""
    return {
        text_of(health.input_name[i]): {
            "received": health.received[i],
            "lost": health.lost[i],
            "rejected": health.rejected[i],
            "frozen": health.frozen[i],
            "age_ms": health.age_ms[i],
        }
        for i in range(health.input_count)
    }
