"""Where observations go: an LCM URL, a log, a table."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any, Protocol

from palpate_common import palpate_package
from palpate_common.input_error import InputError
from palpate_see.cloud import Observation

CHANNEL = "SHAPE_OBSERVATION"


class Output(Protocol):
    def write(self, observation: Observation) -> None: ...

    def close(self) -> None: ...


def message_of(observation: Observation) -> Any:
    """shape_observation_t; its seq and session are those of the sender."""
    message = palpate_package.load().messages.shape_observation_t()
    message.utime, message.count, message.deviation = observation.utime, len(observation.points), observation.deviation
    for i, point in enumerate(observation.points.tolist()):
        message.points[i] = point
    return message


class BusOutput:
    """Publishes."""

    def __init__(self, url: str, own_names: dict[str, str]) -> None:
        """own_names: as in Settings. Raises InputError for a wrong URL, OSError without a network."""
        self._channel = next((name for name, own in own_names.items() if own == CHANNEL), CHANNEL)
        try:
            self._bus = palpate_package.load().Bus(url)
        except ValueError as error:
            raise InputError(str(error)) from error

    def write(self, observation: Observation) -> None:
        message = message_of(observation)
        self._bus.stamp(CHANNEL, message)
        self._bus.publish_sealed(self._channel, message)

    def close(self) -> None:
        self._bus.close()


class LogOutput:
    """An LCM log whose events have the times of the exposures; the same input gives the same bytes."""

    SESSION = 1

    def __init__(self, path: Path) -> None:
        """Raises OSError."""
        self._writer = palpate_package.load().EventLogWriter(path)
        self._seq = 0

    def write(self, observation: Observation) -> None:
        message = message_of(observation)
        message.seq, message.session = self._seq, self.SESSION
        self._seq += 1
        self._writer.write(observation.utime, CHANNEL, message.encode())

    def close(self) -> None:
        self._writer.close()


class CsvOutput:
    """One line per point: utime, us, deviation, x, y, z, m."""

    def __init__(self, path: Path) -> None:
        """Raises OSError."""
        self._file = path.open("w", newline="", encoding="utf-8")
        self._rows = csv.writer(self._file, lineterminator="\n")
        self._rows.writerow(["utime", "deviation", "x", "y", "z"])

    def write(self, observation: Observation) -> None:
        for point in observation.points.tolist():
            self._rows.writerow([observation.utime, f"{observation.deviation:.6f}", *(f"{value:.6f}" for value in point)])

    def close(self) -> None:
        self._file.close()


def file_output(path: Path) -> Output:
    """By the suffix. Raises OSError if the file cannot be written."""
    if path.suffix.lower() == ".csv":
        return CsvOutput(path)
    return LogOutput(path)
