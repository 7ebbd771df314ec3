"""Records buses to a log from Python, in the background of a program."""

from __future__ import annotations

import os
import select
import threading
from typing import Sequence, Union

from palpate.authentication import wall_clock_us
from palpate.bus import CONTROL_URL, HOUSEKEEPING_URL
from palpate.closing import Closing
from palpate.event_log import EventLogWriter
from palpate.udpm import Transport


class Recorder(Closing):
    """Writes all messages on some URLs to one log, in a background thread; for read_log(). (For
    long recordings palpate-record and lcm-logger lose fewer messages.)

    with Recorder("run.log"):
        ...
    """

    def __init__(
        self,
        path: Union[str, "os.PathLike[str]"],
        urls: Sequence[str] = (CONTROL_URL, HOUSEKEEPING_URL),
    ) -> None:
        """Starts immediately. Raises OSError or ValueError."""
        self._transports = [Transport(url) for url in urls]
        self._writer = EventLogWriter(path)
        self._over = threading.Event()
        self.events = 0  # written so far
        self._thread = threading.Thread(target=self._work, name="recorder", daemon=True)
        self._thread.start()

    def _work(self) -> None:
        while True:
            over = self._over.is_set()
            readable, _, _ = select.select(self._transports, [], [], 0.0 if over else 0.05)
            for transport in readable:
                for _ in range(256):  # give the other buses their turn
                    packet = transport.receive(0)
                    if packet is None:
                        break
                    self._writer.write(wall_clock_us(), packet.channel, packet.data)
                    self.events += 1
            if over and not readable:
                return

    def close(self) -> None:
        """Records pending messages, and ends."""
        self._over.set()
        self._thread.join(10)
        self._writer.close()
        for transport in self._transports:
            transport.close()
