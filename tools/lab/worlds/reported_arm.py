"""The scene's arm where another program moves it: its joints are those of ROBOT_STATE, and the
wrist's wrench is published as Drake's lcmt_force_torque.
"""

from __future__ import annotations

import numpy as np
from arm import Arm
from drake import lcmt_force_torque
from palpate import Bus
from palpate.messages import ft_wrench_t, robot_state_t
from pydrake.lcm import DrakeLcm
from scene import Scene

WRENCH_CHANNEL = "FORCE_TORQUE"


class ReportedArm(Arm):
    """Accelerations are not reported, and count as zero."""

    def __init__(self, scene: Scene, control: Bus, drake_url: str) -> None:
        """Raises SceneError."""
        super().__init__(scene)
        self._lcm = DrakeLcm(drake_url)
        self._newest: robot_state_t | None = None
        control.subscribe("ROBOT_STATE", self._take)

    def _take(self, message: robot_state_t) -> None:
        self._newest = message

    @property
    def obeys(self) -> bool:
        return True

    def step(self, time: float, dt: float) -> None:
        """Commands have no effect here."""
        state, self._newest = self._newest, None
        if state is None:
            return
        self.q, self.dq = np.array(state.q[: len(self.q)]), np.array(state.dq[: len(self.q)])
        self.X_WE, self.jacobian = self.model.flange(self.q)
        self.V_WE = self.jacobian @ self.dq

    def publish(self, channel: str, message: object) -> bool:
        if isinstance(message, ft_wrench_t):
            reading = lcmt_force_torque()
            reading.timestamp = message.utime // 1000  # ms
            reading.fx, reading.fy, reading.fz = message.wrench[:3]
            reading.tx, reading.ty, reading.tz = message.wrench[3:]
            self._lcm.Publish(WRENCH_CHANNEL, reading.encode())
            return True
        return channel == "ROBOT_STATE"
