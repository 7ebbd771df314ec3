"""LCM's UDP multicast in Python alone: URLs, framing, fragments, and one socket per bus.

A short message is one datagram: the magic "LC02", a 32-bit sequence number, the channel's name
with its zero, the payload. A longer one is sent in fragments, "LC03": sequence number, size of the
whole payload, offset of this part, index of this part and their number (16 bits each); the first
part begins with the channel's name. All numbers are in network order. Malformed input is only
counted.
"""

from __future__ import annotations

import errno
import ipaddress
import select
import socket
import struct
import time
from dataclasses import dataclass
from typing import NamedTuple, Optional
from urllib.parse import parse_qsl

SHORT_MAGIC, FRAGMENT_MAGIC = b"LC02", b"LC03"
LONGEST_CHANNEL = 63
LARGEST_DATAGRAM = 65507
# Payload of one fragment, as in LCM.
FRAGMENT_SIZE = 65487 - LONGEST_CHANNEL - 1
LARGEST_MESSAGE = 64 << 20
_SHORT_HEADER = struct.Struct(">4sI")
_FRAGMENT_HEADER = struct.Struct(">4sIIIHH")
_EXAMPLE = "udpm://239.255.76.67:7667?ttl=0"


@dataclass(frozen=True)
class Url:
    """A multicast group, as in udpm://239.255.76.67:7667?ttl=0; ttl 0: this machine only."""

    address: str = "239.255.76.67"
    port: int = 7667
    ttl: int = 0
    receive_buffer: int = 1 << 21  # bytes requested from the system


def parse_url(text: str) -> Url:
    """Reads udpm://[ADDRESS[:PORT]][?ttl=N][&recv_buf_size=BYTES]. Raises ValueError."""

    def refuse(why: str) -> ValueError:
        return ValueError(f'LCM URL "{text}": {why}; expected e.g. {_EXAMPLE}')

    def number(name: str, value: str, low: int, high: int) -> int:
        if not value.isdecimal() or not low <= int(value) <= high:
            raise refuse(f'{name} must be {low} to {high}, not "{value}"')
        return int(value)

    scheme, _, rest = text.partition("://")
    if scheme != "udpm" or "://" not in text:
        raise refuse("not of the kind udpm")
    group, _, query = rest.partition("?")
    address, colon, port = group.partition(":")
    address = address or Url.address
    try:
        multicast = ipaddress.IPv4Address(address).is_multicast
    except ValueError:
        raise refuse(f'"{address}" is not an IPv4 address') from None
    if not multicast:
        raise refuse(f"{address} is not a multicast address (224.0.0.0 to 239.255.255.255)")
    ttl, buffer = Url.ttl, Url.receive_buffer
    for key, value in parse_qsl(query, keep_blank_values=True):
        if key == "ttl":
            ttl = number(key, value, 0, 255)
        elif key == "recv_buf_size":
            buffer = number(key, value, 0, 1 << 30) or buffer
        else:
            raise refuse(f'unknown option "{key}"; allowed: ttl, recv_buf_size')
    return Url(address, number("port", port, 1, 65535) if colon else Url.port, ttl, buffer)


class Packet(NamedTuple):
    """One received message: channel and payload, not yet decoded."""

    channel: str
    data: bytes


def encode_packet(channel: str, data: bytes, number: int) -> list[bytes]:
    """The datagrams of a message: one, or its fragments. Raises ValueError."""
    name = channel.encode("ascii")
    if not 1 <= len(name) <= LONGEST_CHANNEL or b"\0" in name:
        raise ValueError(f"channel {channel!r}: 1 to {LONGEST_CHANNEL} characters")
    number &= 0xFFFFFFFF
    short = _SHORT_HEADER.pack(SHORT_MAGIC, number) + name + b"\0" + data
    if len(short) <= LARGEST_DATAGRAM:
        return [short]
    if len(data) > LARGEST_MESSAGE:
        raise ValueError(f"{channel}: {len(data)} bytes; at most {LARGEST_MESSAGE} are sent")
    count = -(-len(data) // FRAGMENT_SIZE)
    datagrams = []
    for index in range(count):
        begin = index * FRAGMENT_SIZE
        header = _FRAGMENT_HEADER.pack(FRAGMENT_MAGIC, number, len(data), begin, index, count)
        part = data[begin : begin + FRAGMENT_SIZE]
        datagrams.append(header + (name + b"\0" if index == 0 else b"") + part)
    return datagrams


class _Partial:
    """A partially received message."""

    def __init__(self, size: int, count: int) -> None:
        self.size, self.count = size, count
        self.parts: dict[int, tuple[int, bytes]] = {}  # by number: place and bytes
        self.held = 0  # bytes of the parts
        self.channel: Optional[str] = None

    def whole(self) -> Optional[bytes]:
        """All parts joined; None if they are inconsistent."""
        end, pieces = 0, []
        for begin, part in sorted(self.parts.values()):
            if begin != end:
                return None
            pieces.append(part)
            end += len(part)
        return b"".join(pieces) if end == self.size else None


class Decoder:
    """Assembles datagrams into messages; keeps the fragments of incomplete ones."""

    MOST_PARTIAL = 8  # messages; the oldest is discarded
    MOST_BYTES = 2 * LARGEST_MESSAGE

    def __init__(self) -> None:
        self.malformed = 0
        self._partial: dict[tuple[object, int], _Partial] = {}

    def take(self, datagram: bytes, sender: object = None) -> Optional[Packet]:
        """The message that this datagram is, or completes."""
        magic = datagram[:4]
        if magic == SHORT_MAGIC and len(datagram) >= _SHORT_HEADER.size:
            packet = self._named(datagram[_SHORT_HEADER.size :])
        elif magic == FRAGMENT_MAGIC and len(datagram) >= _FRAGMENT_HEADER.size:
            return self._fragment(datagram, sender)
        else:
            packet = None
        self.malformed += packet is None
        return packet

    @staticmethod
    def _named(rest: bytes) -> Optional[Packet]:
        end = rest.find(b"\0", 0, LONGEST_CHANNEL + 1)
        if end < 1:
            return None
        try:
            return Packet(rest[:end].decode("ascii"), rest[end + 1 :])
        except UnicodeDecodeError:
            return None

    def _fragment(self, datagram: bytes, sender: object) -> Optional[Packet]:
        _, number, size, begin, index, count = _FRAGMENT_HEADER.unpack_from(datagram)
        part = datagram[_FRAGMENT_HEADER.size :]
        channel = None
        if index == 0:
            first = self._named(part)
            if first is None:
                self.malformed += 1
                return None
            channel, part = first
        if index >= count or size > LARGEST_MESSAGE or begin + len(part) > size:
            self.malformed += 1
            return None
        key = (sender, number)
        partial = self._partial.get(key)
        if partial is None or (partial.size, partial.count) != (size, count):
            self._partial.pop(key, None)
            self._make_room(len(part))
            partial = self._partial[key] = _Partial(size, count)
        if partial.held + len(part) > size and index not in partial.parts:  # they overlap
            del self._partial[key]
            self.malformed += 1
            return None
        if index not in partial.parts:
            self._make_room(len(part), key)
            partial.parts[index] = (begin, part)
            partial.held += len(part)
        partial.channel = channel or partial.channel
        if len(partial.parts) < count:
            return None
        del self._partial[key]
        data = partial.whole()
        if data is None or partial.channel is None:
            self.malformed += 1
            return None
        return Packet(partial.channel, data)

    def _make_room(self, size: int, but: object = None) -> None:
        """Discards the oldest ones, except that of key `but`, to make room for `size` more
        bytes or another message."""
        for key in [key for key in self._partial if key != but]:
            crowded = but is None and len(self._partial) >= self.MOST_PARTIAL
            if not crowded and size + self.held <= self.MOST_BYTES:
                return
            del self._partial[key]

    @property
    def held(self) -> int:
        """Bytes of incomplete messages."""
        return sum(partial.held for partial in self._partial.values())


def _explain(doing: str, url: Url, error: OSError) -> OSError:
    text = f"cannot {doing} udpm://{url.address}:{url.port}: {error.strerror}"
    if error.errno in (errno.ENETUNREACH, errno.ENODEV, errno.EHOSTUNREACH):
        text += (
            ". There is no route for multicast; add one, for one machine alone with\n"
            "  ip link set lo multicast on\n  ip route add 224.0.0.0/4 dev lo"
        )
    return OSError(error.errno, text)


class Transport:
    """One bus: sends to its group and receives everything sent to it."""

    def __init__(self, url: str) -> None:
        """Raises ValueError for an invalid URL, OSError if the socket cannot be opened."""
        self.url = parse_url(url)
        self._decoder = Decoder()
        self._number = 0
        self._group = (self.url.address, self.url.port)
        self._in = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._open()
        except OSError as error:
            self.close()
            raise _explain("listen to", self.url, error) from None

    def _open(self) -> None:
        self._out.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, self.url.ttl)
        for option in (socket.SO_REUSEADDR, socket.SO_REUSEPORT):
            self._in.setsockopt(socket.SOL_SOCKET, option, 1)
        self._in.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, self.url.receive_buffer)
        self._in.bind(self._group)
        group = socket.inet_aton(self.url.address) + struct.pack("=I", socket.INADDR_ANY)
        self._in.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, group)
        self._in.setblocking(False)

    @property
    def malformed(self) -> int:
        """Number of datagrams that were not LCM messages."""
        return self._decoder.malformed

    def fileno(self) -> int:
        """For select() and event loops: readable when data have arrived."""
        return self._in.fileno()

    def publish(self, channel: str, data: bytes) -> None:
        """Sends bytes. Raises ValueError or OSError."""
        try:
            for datagram in encode_packet(channel, data, self._number):
                self._out.sendto(datagram, self._group)
        except OSError as error:
            raise _explain("send to", self.url, error) from None
        self._number += 1

    def receive(self, timeout: float) -> Optional[Packet]:
        """The next message, waiting at most `timeout` s; None if none arrived."""
        end = time.monotonic() + timeout
        while True:
            try:
                datagram, sender = self._in.recvfrom(65536)
            except BlockingIOError:
                left = end - time.monotonic()
                if left <= 0 or not select.select([self._in], [], [], left)[0]:
                    return None
                continue
            packet = self._decoder.take(datagram, sender)
            if packet is not None:
                return packet
            if time.monotonic() > end:  # bounds the time spent on a flood of malformed datagrams
                return None

    def close(self) -> None:
        self._in.close()
        self._out.close()
