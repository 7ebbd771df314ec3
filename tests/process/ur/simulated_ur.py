"""The simulated controller of tools/lab/worlds, in a thread of a test."""

from __future__ import annotations

import random
import sys
import threading
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "bridge"))

from steered_arm import wait_for  # noqa: E402  first: finds the next

# isort: split
from rtde_server import Servers  # noqa: E402
from ur_controller import Controller  # noqa: E402

# rad: the flange where the hand of bar_long_soft.yaml holds the bar.
HOLDING = (0.2752826172, -2.1443954204, -1.9052753196, 0.9080780819, 1.2955137063, 1.5707963284)


def private_address() -> str:
    """On the loopback device, where the ports are those of a controller."""
    return f"127.{random.randint(1, 250)}.{random.randint(1, 250)}.{random.randint(2, 250)}"


class SimulatedUr:
    """Runs until close()."""

    def __init__(self, hand: float = 0.0) -> None:
        self.address = private_address()
        self.controller = Controller(HOLDING)
        self.servers = Servers(self.controller, self.address, hand)
        self._is_ended = False
        self._thread = threading.Thread(target=self.servers.run, args=(lambda: self._is_ended,))
        self._thread.start()

    def close(self) -> None:
        self._is_ended = True
        self._thread.join()
        self.servers.close()

    def seconds_to_rest(self) -> float:
        """By the controller's clock, from now on."""
        begin = self.controller.time
        wait_for(lambda: self.controller.speed < 1e-3, "the arm rests")
        return self.controller.time - begin
