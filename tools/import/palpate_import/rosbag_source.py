"""ROS 2 bags: a folder with metadata.yaml, or one .db3 file."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Iterator

from palpate_common.input_error import InputError
from palpate_import import extras
from palpate_import.topic_table import Stored


class RosbagSource:
    """Needs the Python package rosbags. Of bags without definitions of their types those of ROS 2 itself are known."""

    def __init__(self, path: Path) -> None:
        """Raises InputError."""
        self.path, self._folder = str(path), path
        self._rosbags = extras.load("rosbags.highlevel", "ROS 2 bags")
        self._typesys = extras.load("rosbags.typesys", "ROS 2 bags")
        self._errors = (self._rosbags.AnyReaderError, OSError, ValueError, KeyError)
        try:
            with self._reader() as reader:
                self._topics = [topic for topic, info in reader.topics.items() if info.msgcount]
        except self._errors as error:
            raise InputError(f"{self.path}: {error}") from error

    def _reader(self) -> Any:
        store = self._typesys.get_typestore(self._typesys.Stores.LATEST)
        return self._rosbags.AnyReader([self._folder], default_typestore=store)

    @property
    def topics(self) -> list[str]:
        return self._topics

    def messages(self, topics: set[str]) -> Iterator[Stored]:
        count = 0
        try:
            with self._reader() as reader:
                connections = [one for one in reader.connections if one.topic in topics]
                for connection, nanoseconds, data in reader.messages(connections):
                    count += 1
                    yield Stored(connection.topic, nanoseconds, reader.deserialize(data, connection.msgtype))
        except self._errors as error:
            raise InputError(f"{self.path}: {', '.join(sorted(topics))}: message {count}: {error}") from error
