"""Clouds and joint states from the network, until a signal or for a given time."""

from __future__ import annotations

import select
import signal
import time
from typing import Any, Callable, Optional, Sequence

from palpate_common import palpate_package
from palpate_common.input_error import InputError
from palpate_see.cloud import Cloud
from palpate_see.configuration import Settings
from palpate_see.log_source import take_state
from palpate_see.outputs import Output
from palpate_see.pipeline import Pipeline
from palpate_see.point_cloud_message import MalformedCloud, decode_point_cloud
from palpate_see.robot_body import RobotBody
from palpate_see.timing import AHEAD_US

MOST_AT_ONCE = 2000  # packets of one URL before the next one's turn
WAIT = 0.1  # s, in which a signal takes effect


class Live:
    """One process's work: of the clouds that have arrived the newest is used, since the others are older than it."""

    def __init__(self, settings: Settings, pipeline: Pipeline, body: Optional[RobotBody], outputs: Sequence[Output]) -> None:
        """Raises InputError for a wrong URL, OSError without a network."""
        package = palpate_package.load()
        self._decode, self._clock = package.decode, package.authentication.wall_clock_us
        self._channel, self._pipeline, self._body, self._outputs = settings.channel, pipeline, body, outputs
        self._own_names = settings.own_names
        self._newest: Optional[tuple[Cloud, int]] = None
        self._is_over = False
        self._transports: list[Any] = []
        from palpate.udpm import Transport

        try:
            for url in dict.fromkeys((settings.clouds_url, settings.control_url)):
                self._transports.append(Transport(url))
        except ValueError as error:
            raise InputError(str(error)) from error

    def run(self, seconds: float, report: Callable[[], None]) -> None:
        """Calls `report` once a second. Ends after so many seconds, or by SIGINT or SIGTERM."""
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._end)
        now = time.monotonic()
        end, next_report = now + seconds, now + 1
        while not self._is_over and now < end:
            self._receive(max(0.0, min(WAIT, end - now, next_report - now)))
            if self._newest is not None:
                cloud, received = self._newest
                self._newest = None
                self._use(cloud, received)
            now = time.monotonic()
            if now >= next_report:
                report()
                next_report = max(next_report + 1, now)

    def close(self) -> None:
        for transport in self._transports:
            transport.close()

    def _end(self, *_: object) -> None:
        self._is_over = True

    def _receive(self, timeout: float) -> None:
        readable, _, _ = select.select(self._transports, [], [], timeout)
        for transport in readable:
            for _ in range(MOST_AT_ONCE):
                packet = transport.receive(0)
                if packet is None:
                    break
                self._take(packet.channel, packet.data)

    def _take(self, channel: str, data: bytes) -> None:
        counters = self._pipeline.counters
        if channel != self._channel:
            if self._body is not None:
                latest = self._clock() + AHEAD_US
                counters.refused_states += not take_state(self._body, self._own_names.get(channel, channel), data, self._decode, latest)
            return
        try:
            cloud = decode_point_cloud(data)
        except MalformedCloud:
            counters.refuse_cloud("malformed")
            return
        if self._newest is not None:
            counters.refuse_cloud("superseded")
        self._newest = cloud, self._clock()

    def _use(self, cloud: Cloud, received: int) -> None:
        observation = self._pipeline.process(cloud, received)
        if observation is not None:
            for output in self._outputs:
                output.write(observation)
