"""Guarded motions of a running palpated: TOUCH_REQUEST and TOUCH."""

from __future__ import annotations

import time
from typing import Any, Callable, NamedTuple, Optional, Sequence

import numpy as np

from palpate import messages
from palpate.authentication import Sealer
from palpate.bus import Bus
from palpate.channels import text_of

_REPEAT = 0.2  # s, after which an unanswered request is repeated
_FINAL = ("refused", "touched", "no contact", "stopped")
_STATES = {
    messages.touch_t.REFUSED: "refused",
    messages.touch_t.WAITING: "waiting",
    messages.touch_t.APPROACHING: "approaching",
    messages.touch_t.RETREATING: "retreating",
    messages.touch_t.TOUCHED: "touched",
    messages.touch_t.NO_CONTACT: "no contact",
    messages.touch_t.STOPPED: "stopped",
}


class Touch(NamedTuple):
    """State or result of a guarded motion. What is not known is None."""

    state: str  # waiting, approaching, retreating; touched, no contact, stopped
    reason: str  # why not touched, or why there is no deviation
    travel: float  # m, along the direction
    force: float  # N, against the motion now; of a result the largest
    point: Optional[Any]  # (3,), m, in W: the tip's foremost point at zero force
    centre: Optional[Any]  # (3,), m, in W: the tip's centre at zero force
    point_deviation: Optional[float]  # m, standard deviation of both along the direction
    stiffness: Optional[float]  # N/m, force over indentation at the largest force
    stiffness_deviation: Optional[float]  # N/m
    indentation: Optional[float]  # m, at the largest force

    @property
    def touched(self) -> bool:
        return self.state == "touched"


class TouchError(RuntimeError):
    """The request was refused (the text gives the reason)."""


class TouchTimeout(TimeoutError):
    """The daemon was silent for longer than the time-out; the motion may continue."""


def _known(value: float) -> Optional[float]:
    return float(value) if value >= 0 else None


def touch_of(message: messages.touch_t) -> Touch:
    """A TOUCH message."""
    state = _STATES.get(message.state, "stopped")
    touched = state == "touched"
    return Touch(
        state=state,
        reason=text_of(message.reason),
        travel=float(message.travel),
        force=float(message.force),
        point=np.array(message.point) if touched else None,
        centre=np.array(message.centre) if touched else None,
        point_deviation=_known(message.point_deviation),
        stiffness=_known(message.stiffness),
        stiffness_deviation=_known(message.stiffness_deviation),
        indentation=_known(message.indentation),
    )


def _request(
    direction: Sequence[float], force: float, speed: float, distance: float, retreat: float
) -> messages.touch_request_t:
    message = messages.touch_request_t()
    message.action = messages.touch_request_t.START
    # Positive, and unlike that of any other request of late.
    message.request = 1 + time.time_ns() // 1_000_000 % 2_000_000_000
    message.direction = [float(x) for x in direction]
    if len(message.direction) != 3:
        raise ValueError("direction has three numbers")
    message.force, message.speed = float(force), float(speed)
    message.distance, message.retreat = float(distance), float(retreat)
    return message


def run_touch(
    control: Bus,
    sealer: Sealer,
    timeout: float,
    direction: Sequence[float],
    force: float,
    speed: float = 0.0,
    distance: float = 0.0,
    retreat: float = 0.0,
    progress: Optional[Callable[[Touch], None]] = None,
) -> Touch:
    """Requests a guarded motion and follows it to its end; see Daemon.touch."""
    request = _request(direction, force, speed, distance, retreat)
    subscription = control.subscribe("TOUCH")

    def send(action: int) -> None:
        # Each repetition has its own counter and code; the number identifies the request.
        request.action, request.utime = action, 0
        control.stamp("TOUCH_REQUEST", request)
        sealer.put(request)
        control.publish_sealed("TOUCH_REQUEST", request)

    try:
        send(messages.touch_request_t.START)
        heard = sent = time.monotonic()
        answered = False
        while (now := time.monotonic()) - heard < timeout:
            if not answered and now - sent >= _REPEAT:
                send(messages.touch_request_t.START)
                sent = now
            try:
                message = subscription.get(_REPEAT)
            except TimeoutError:
                continue
            if message.request != request.request:
                continue
            heard, answered = time.monotonic(), True
            touch = touch_of(message)
            if touch.state == "refused":
                raise TouchError(touch.reason)
            if touch.state in _FINAL:
                return touch
            if progress is not None:
                progress(touch)
        raise TouchTimeout(f"touch: no TOUCH in {timeout:g} s; is palpated running?")
    except TouchError:
        raise
    except BaseException:  # an interrupt, or an error of `progress`: the hand must stop
        send(messages.touch_request_t.CANCEL)
        raise
    finally:
        control.unsubscribe(subscription)
