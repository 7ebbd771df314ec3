"""A node of ROS 2 by Dust DDS, which is written in Rust and shares nothing with the others: wrenches."""

from __future__ import annotations

import struct
from dataclasses import make_dataclass
from typing import Any, Optional, Sequence

import dust_dds
from dust_dds import TypeKind

WORDS = [f"{name}_{half}" for name in ("fx", "fy", "fz", "tx", "ty", "tz") for half in ("low", "high")]
# geometry_msgs/WrenchStamped. Dust DDS' Python has texts and some whole numbers only, so that a float64 is two uint32
# here; and the encoding has no trace of nested structures.
Wrench = make_dataclass(
    "Wrench", [("sec", TypeKind.int32), ("nanosec", TypeKind.uint32), ("frame_id", str),
               *((name, TypeKind.uint32) for name in WORDS)],
)  # fmt: skip
Wrench.__name__ = "geometry_msgs::msg::dds_::WrenchStamped_"
FRAME = "abc"  # after a name of 3 letters the words begin where a float64 may


class DustNode:
    def __init__(self, domain: int) -> None:
        factory = dust_dds.DomainParticipantFactory.get_instance()
        self._participant = factory.create_participant(domain_id=domain)

        def topic(name: str) -> Any:
            return self._participant.create_topic(topic_name=name, type_=Wrench)

        self._writer = self._participant.create_publisher().create_datawriter(topic("rt/ft"))
        self._reader = self._participant.create_subscriber().create_datareader(topic("rt/out/wrench"))

    def write(self, utime: int, numbers: Sequence[float]) -> None:
        words = struct.unpack("<12I", struct.pack("<6d", *numbers))
        self._writer.write(Wrench(utime // 1_000_000, utime % 1_000_000 * 1000, FRAME, *words))

    def heard(self) -> "Optional[tuple[float, ...]]":
        """The newest wrench."""
        try:
            samples = self._reader.read(max_samples=100)
        except Exception:  # which class is that of Dust DDS: there is no data
            return None
        one = samples[-1].get_data()
        return struct.unpack("<6d", struct.pack("<12I", *(getattr(one, name) for name in WORDS)))
