"""Lock-step with `palpated --stepped`, and real time."""

from __future__ import annotations

import time

from palpate import Bus
from palpate.messages import sim_tick_t

PATIENCE = 20.0  # s
_REPEAT = 0.005  # s until a tick is sent again: datagrams can be lost
_MOST_MADE_UP_FOR = 0.02  # s


class LockStep:
    """Sends SIM_TICK and waits for its TICK_DONE."""

    def __init__(self, control: Bus) -> None:
        self._control, self._tick = control, sim_tick_t()
        self._done = -1
        self.repeats = 0
        control.subscribe("TICK_DONE", self._take)

    def _take(self, message: object) -> None:
        self._done = max(self._done, getattr(message, "tick"))

    def send(self, tick: int, period_us: int, utime: int) -> None:
        self._tick.tick, self._tick.period_us, self._tick.utime = tick, period_us, utime
        self._control.publish("SIM_TICK", self._tick)

    def wait(self, stop: list[bool]) -> None:
        """Until the answer, or until `stop` is not empty. Raises TimeoutError if no daemon
        answers."""
        end = time.monotonic() + PATIENCE
        while self._done < self._tick.tick and not stop:
            if not self._control.handle(_REPEAT) and self._done < self._tick.tick:
                if time.monotonic() > end:
                    raise TimeoutError(
                        f"no answer to SIM_TICK {self._tick.tick} for {PATIENCE:g} s: is palpated "
                        f"running with --stepped on {self._control.url}?"
                    )
                self._control.publish("SIM_TICK", self._tick)
                self.repeats += 1
        self._control.drain()


class RealTimePacer:
    """Waits for the next point of a fixed grid; longer delays are not made up for."""

    def __init__(self, period: float) -> None:
        self._period, self._next = period, time.monotonic()
        self.overruns, self.worst, self.lost = 0, 0.0, 0.0  # worst, lost: s

    def wait(self) -> None:
        now = time.monotonic()
        if now < self._next:
            time.sleep(self._next - now)
            now = time.monotonic()
        late = now - self._next
        self.worst = max(self.worst, late)
        self.overruns += late >= self._period
        if late > _MOST_MADE_UP_FOR:
            self.lost += late
            self._next += late
        self._next += self._period
