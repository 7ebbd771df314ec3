"""A node of ROS 2 by Fast DDS (fast_peer), whose messages rosbags encodes and decodes."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
import time
from collections import defaultdict
from pathlib import Path
from typing import Any

SOURCE = Path(os.environ["PALPATE_SOURCE_DIR"])
BIN = Path(os.environ["PALPATE_BIN_DIR"])
sys.path.insert(0, str(SOURCE / "tests/process/bridge"))

from rosbags.typesys import Stores, get_types_from_msg, get_typestore  # noqa: E402
from steered_arm import wait_for  # noqa: E402

STORE = get_typestore(Stores.ROS2_JAZZY)
HEADER = "uint64 client\nint64 sequence_number\n"  # of rmw_cyclonedds_cpp
STORE.register(get_types_from_msg(HEADER + "uint8 unused\n", "std_srvs/msg/Trigger_Request"))
STORE.register(get_types_from_msg(HEADER + "bool success\nstring message\n", "std_srvs/msg/Trigger_Response"))


def dds_type(name: str) -> str:
    """As DDS knows std_msgs/msg/String, or a service's request."""
    package, kind, message = name.split("/")
    if message.endswith(("_Request", "_Response")):
        kind = "srv"  # rosbags has messages only
    return f"{package}::{kind}::dds_::{message}_"


def wall_clock_us() -> int:
    return time.time_ns() // 1000


def message(kind: str, /, **values: Any) -> Any:
    return STORE.types[kind](**values)


def header(utime: int, frame: str = "") -> Any:
    """utime: us."""
    stamp = message("builtin_interfaces/msg/Time", sec=utime // 1_000_000, nanosec=utime % 1_000_000 * 1000)
    return message("std_msgs/msg/Header", stamp=stamp, frame_id=frame)


def utime_of(one: Any) -> int:
    return one.header.stamp.sec * 1_000_000 + one.header.stamp.nanosec // 1000


class FastNode:
    def __init__(self, domain: int) -> None:
        self._process = subprocess.Popen(
            ["setpriv", "--pdeathsig", "KILL", BIN / "ros2_fast_peer", str(domain)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        )  # fmt: skip
        self._types: "dict[str, str]" = {}
        self._heard: "defaultdict[str, list[list[str]]]" = defaultdict(list)
        threading.Thread(target=self._listen, daemon=True).start()

    def close(self) -> None:
        assert self._process.stdin
        self._process.stdin.close()
        self._process.wait(20)
        assert self._process.stdout
        self._process.stdout.close()

    def _listen(self) -> None:
        assert self._process.stdout
        for line in self._process.stdout:
            words = line.split()
            self._heard[" ".join(words[:2]) if words[0] == "got" else words[0]].append(words[1:])

    def say(self, *words: object) -> None:
        assert self._process.stdin
        self._process.stdin.write(" ".join(str(word) for word in words) + "\n")
        self._process.stdin.flush()

    def ask(self, *words: object) -> "list[str]":
        """The answer, a line that begins with the same word."""
        answers = self._heard[str(words[0])]
        before = len(answers)
        self.say(*words)
        wait_for(lambda: len(answers) > before, f"an answer to {words[0]}")
        return answers[-1]

    def rested(self) -> "list[float]":
        """s, of all faults so far."""
        return [float(words[0]) for words in self._heard["rested"]]

    def connect(self, what: str, topic: str, name: str, quality: str = "reliable") -> None:
        """what: writer or reader of the DDS topic."""
        self._types[topic] = name
        self.say(what, topic, dds_type(name), quality)

    def wait_for_match(self, topic: str) -> None:
        wait_for(lambda: int(self.ask("matches", topic)[0]) > 0, f"a match of {topic}")

    def write(self, topic: str, one: Any) -> None:
        self.write_bytes(topic, bytes(STORE.serialize_cdr(one, self._types[topic])))

    def write_bytes(self, topic: str, data: bytes) -> None:
        self.say("write", topic, data.hex())

    def heard_bytes(self, topic: str) -> "list[bytes]":
        return [bytes.fromhex(words[1]) for words in self._heard[f"got {topic}"]]

    def check_encoding(self, topic: str) -> None:
        """Fails unless all that was read is what rosbags writes, byte for byte, but for what DDS adds at the end: how
        much that is the header states, behind the kind of encoding.
        """
        for data, one in zip(self.heard_bytes(topic), self.heard(topic)):
            expected = bytes(STORE.serialize_cdr(one, self._types[topic]))
            added = data[3]
            end = len(data) - added
            if (data[:3], data[4:end]) != (expected[:3], expected[4:]) or any(data[end:]):
                raise AssertionError(f"{topic}: {data.hex()} is not {expected.hex()}")

    def heard(self, topic: str) -> "list[Any]":
        return [STORE.deserialize_cdr(data, self._types[topic]) for data in self.heard_bytes(topic)]
