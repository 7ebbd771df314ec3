"""MCAP files whose messages are JSON or ROS 2's CDR."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Callable, Iterator

from palpate_common.input_error import InputError
from palpate_import import extras
from palpate_import.ros_types import RosTypes
from palpate_import.topic_table import Stored

ENCODINGS = ("json", "cdr")


class McapSource:
    """Needs the Python package mcap, and for CDR rosbags. Messages come in the order of their log times."""

    def __init__(self, path: Path) -> None:
        """Raises InputError."""
        self.path = str(path)
        self._reader = extras.load("mcap.reader", "MCAP files")
        self._errors = (extras.load("mcap.exceptions", "MCAP files").McapError, OSError, ValueError, EOFError)
        self._types = RosTypes(self.path)
        try:
            with open(self.path, "rb") as file:
                summary = self._reader.make_reader(file).get_summary()
        except self._errors as error:
            raise InputError(f"{self.path}: {getattr(error, 'strerror', None) or error or 'is no MCAP file'}") from error
        if summary is None or not summary.channels:
            raise InputError(f"{self.path}: has no summary of its channels; remedy: mcap recover, of the program mcap")
        self._encodings = {channel.topic: channel.message_encoding for channel in summary.channels.values()}

    @property
    def topics(self) -> list[str]:
        return list(self._encodings)

    def messages(self, topics: set[str]) -> Iterator[Stored]:
        decoders: dict[int, Callable[[bytes], Any]] = {}
        count = 0
        try:
            with open(self.path, "rb") as file:
                for schema, channel, message in self._reader.make_reader(file).iter_messages(topics=sorted(topics)):
                    count += 1
                    if channel.id not in decoders:
                        decoders[channel.id] = self._decoder(schema, channel)
                    yield Stored(channel.topic, message.log_time, decoders[channel.id](message.data))
        except self._errors as error:
            raise InputError(f"{self.path}: {', '.join(sorted(topics))}: message {count}: {error}") from error

    def _decoder(self, schema: Any, channel: Any) -> Callable[[bytes], Any]:
        where = f"{self.path}:{channel.topic}"
        if channel.message_encoding == "json":
            return json.loads
        if channel.message_encoding != "cdr":
            raise InputError(f"{where}: encoding '{channel.message_encoding}'; allowed: {', '.join(ENCODINGS)}")
        if schema is None or schema.encoding not in ("ros2msg", "ros2idl"):
            encoding = "" if schema is None else schema.encoding
            raise InputError(f"{where}: schema of encoding '{encoding}'; allowed with cdr: ros2msg, ros2idl")
        return self._types.decoder(schema.name, schema.encoding, schema.data.decode("utf-8", "replace"))
