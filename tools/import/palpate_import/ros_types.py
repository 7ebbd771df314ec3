"""Types of ROS 2 messages by the definitions in a file."""

from __future__ import annotations

from typing import Any, Callable

from palpate_common.input_error import InputError
from palpate_import import extras

_SEPARATOR = "=" * 80 + "\n"


class RosTypes:
    """Needs the Python package rosbags, once a type is asked for."""

    def __init__(self, path: str) -> None:
        self._path = path
        self._store: Any = None

    def decoder(self, name: str, encoding: str, text: str) -> Callable[[bytes], Any]:
        """Of CDR messages of a type that `text` defines. encoding: ros2msg or ros2idl. Raises InputError; the decoder raises
        ValueError."""
        typesys = extras.load("rosbags.typesys", "ROS 2 messages")
        serde = extras.load("rosbags.serde", "ROS 2 messages")
        full = name if "/msg/" in name else name.replace("/", "/msg/", 1)
        if self._store is None:
            self._store = typesys.get_typestore(typesys.Stores.EMPTY)
        try:
            found = {}
            if encoding == "ros2msg":
                found = typesys.get_types_from_msg(text, full)
            else:
                for part in text.split(_SEPARATOR)[1:] if text.startswith(_SEPARATOR) else ["IDL: \n" + text]:
                    found.update(typesys.get_types_from_idl(part.split("\n", 1)[1]))
            self._store.register(found)
        except typesys.TypesysError as error:
            raise InputError(f"{self._path}: definition of {name}: {error}") from error
        store = self._store

        def decode(data: bytes) -> Any:
            try:
                return store.deserialize_cdr(data, full)
            except serde.SerdeError as error:
                raise ValueError(f"{name}: {error}") from error

        return decode
