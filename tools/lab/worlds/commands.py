"""TWIST_COMMAND and JOINT_VELOCITY_COMMAND for the arm: checked as sim/scenes/command_receiver.cpp
does.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any, Optional

import numpy as np
from arm import Arm
from palpate import Bus, read_key_file, verify
from palpate.authentication import wall_clock_us


class CommandReceiver:
    """Passes commands on that are signed where there is a key, newer than all before, for the
    first arm, and finite."""

    def __init__(self, bus: Bus, arm: Arm, key_file: Optional[Path]) -> None:
        """Raises ValueError or OSError for the key file."""
        self._arm = arm
        self._key = None if key_file is None else read_key_file(key_file)
        self._counters = dict.fromkeys(("TWIST_COMMAND", "JOINT_VELOCITY_COMMAND"), 0)
        if self._key is not None:
            self._counters = dict.fromkeys(self._counters, wall_clock_us())
        self._last: dict[str, tuple[int, int]] = {}
        self.accepted = self.rejected = 0
        for channel in self._counters:
            bus.subscribe(channel, partial(self._take, channel))

    def _take(self, channel: str, message: Any) -> None:
        good = self._is_fresh(channel, message) and self._apply(channel, message)
        self.accepted += good
        self.rejected += not good

    def _is_fresh(self, channel: str, message: Any) -> bool:
        if self._key is not None:
            if message.counter <= self._counters[channel]:
                return False
            if not verify(self._key, channel, message):
                return False
            self._counters[channel] = message.counter
        session, seq = self._last.get(channel, (message.session, -1))
        if message.session == session and message.seq <= seq:
            return False
        self._last[channel] = (message.session, message.seq)
        return True

    def _apply(self, channel: str, message: Any) -> bool:
        if channel == "TWIST_COMMAND":
            values = np.array(message.twist)
        else:
            if message.joint_count != len(self._arm.q):
                return False
            values = np.array(message.dq[: message.joint_count])
        if message.grasp != 0 or not np.isfinite(values).all():
            return False
        if message.valid != 1:
            self._arm.stop()
        elif channel == "TWIST_COMMAND":
            self._arm.command_twist(values)
        else:
            self._arm.command_joints(values)
        return True
