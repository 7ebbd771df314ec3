"""Publishing and receiving messages on one LCM URL."""

from __future__ import annotations

import secrets
import time
from collections import deque
from typing import Any, Callable, Deque, Dict, Iterator, List, Mapping, Optional, Protocol

from palpate import messages
from palpate.authentication import wall_clock_us
from palpate.channels import check_renamed, decode, type_of
from palpate.closing import Closing
from palpate.mesh import ShapeBuilder
from palpate.udpm import Packet, Transport

CONTROL_URL = "udpm://239.255.76.67:7667?ttl=0"
HOUSEKEEPING_URL = "udpm://239.255.76.68:7668?ttl=0"
PICTURES_URL = "udpm://239.255.76.69:7669?ttl=0"

# More than a socket's buffer holds; bounds the work per call under a message flood.
_MOST_AT_ONCE = 20000

Callback = Callable[[Any], object]


class _Transport(Protocol):
    def publish(self, channel: str, data: bytes) -> None: ...

    def receive(self, timeout: float) -> Optional[Packet]: ...

    def close(self) -> None: ...


class _LcmTransport:
    """The same through the wheel `lcm`, which is faster at high rates. One malformed datagram
    can end a process that receives through it."""

    def __init__(self, url: str) -> None:
        try:
            import lcm
        except ImportError:
            raise ValueError(
                'transport "lcm" needs the Python module lcm: pip install lcm'
            ) from None
        self._lcm = lcm.LCM(url)
        self._packets: Deque[Packet] = deque()
        self._lcm.subscribe(".*", lambda channel, data: self._packets.append(Packet(channel, data)))

    def publish(self, channel: str, data: bytes) -> None:
        self._lcm.publish(channel, data)

    def receive(self, timeout: float) -> Optional[Packet]:
        if not self._packets:
            self._lcm.handle_timeout(max(0, int(timeout * 1000)))
        return self._packets.popleft() if self._packets else None

    def close(self) -> None:
        self._packets.clear()


class Subscription:
    """Messages of one channel, oldest first; `for message in subscription` never ends. Shapes are
    whole: joined from their chunks."""

    def __init__(self, bus: "Bus", channel: str, callback: Optional[Callback], queue: int) -> None:
        self.channel = channel
        self.dropped = 0  # because the queue was full: the oldest was discarded
        self.undecodable = 0  # of another type than the channel's, or an inconsistent chunk
        self._bus, self._callback = bus, callback
        self._queue: Deque[Any] = deque(maxlen=queue)
        self._shapes = ShapeBuilder()

    def get(self, timeout: Optional[float] = None) -> Any:
        """The next message, waiting at most `timeout` s (None: without limit). Raises
        TimeoutError."""
        end = None if timeout is None else time.monotonic() + timeout
        while not self._queue:
            left = 1.0 if end is None else end - time.monotonic()
            if left > 0:
                self._bus.handle(left)
            elif not self._bus.drain(self._queue):
                raise TimeoutError(f"no {self.channel} in {timeout:g} s on {self._bus.url}")
        return self._queue.popleft()

    def latest(self, timeout: Optional[float] = None) -> Any:
        """The newest message, skipping older ones; waits as get() if there is none."""
        self._bus.drain()
        message = self.get(timeout)
        while self._queue:
            message = self._queue.popleft()
        return message

    def wait_for(self, condition: Callable[[Any], bool], timeout: float) -> Any:
        """The first message from here on that satisfies `condition`. Raises TimeoutError."""
        end = time.monotonic() + timeout
        while True:
            try:
                message = self.get(max(0.0, end - time.monotonic()))
            except TimeoutError:
                raise TimeoutError(
                    f"no {self.channel} that satisfies the condition in {timeout:g} s "
                    f"on {self._bus.url}"
                ) from None
            if condition(message):
                return message

    def __iter__(self) -> Iterator[Any]:
        while True:
            yield self.get()

    def __len__(self) -> int:
        """Number of queued messages."""
        return len(self._queue)

    def clear(self) -> None:
        """Discards the queued messages."""
        self._queue.clear()

    def _take(self, data: bytes) -> None:
        try:
            message = decode(self.channel, data)
            if isinstance(message, messages.shape_t):
                message = self._shapes.add(message)
                if message is None:
                    return
        except ValueError:
            self.undecodable += 1
            return
        if self._callback is not None:
            self._callback(message)
            return
        self.dropped += len(self._queue) == self._queue.maxlen
        self._queue.append(message)


class Bus(Closing):
    """One LCM URL. There is no background thread: messages are received, and callbacks called, in
    the thread that waits (Subscription.get, handle, run); not thread-safe.

    with Bus(HOUSEKEEPING_URL) as bus:
        for shape in bus.subscribe("SHAPE"):
            print(shape.node_count)
    """

    def __init__(
        self,
        url: str = CONTROL_URL,
        transport: str = "python",
        channels: Optional[Mapping[str, str]] = None,
    ) -> None:
        """transport: "python", or "lcm" for the wheel of that name; channels: names on the bus in
        place of palpate's own, as the key bus.channels of a configuration. Raises ValueError for
        an invalid URL or name and OSError if the socket cannot be opened."""
        if transport not in ("python", "lcm"):
            raise ValueError(f'transport "{transport}" is unknown; allowed: python, lcm')
        self.url = url
        make: Dict[str, Callable[[str], _Transport]] = {"python": Transport, "lcm": _LcmTransport}
        self._names = check_renamed(channels or {})
        self._own_names = {name: own for own, name in self._names.items()}
        self._transport = make[transport](url)
        self._session = secrets.randbits(63)
        self._seq: Dict[str, int] = {}
        self._subscriptions: Dict[str, List[Subscription]] = {}

    def publish(self, channel: str, message: Any) -> None:
        """Sends a message after setting utime (unless already set), seq and session. Raises
        TypeError if it is not of the channel's type."""
        kind = type_of(channel)
        if kind is None or not isinstance(message, kind):
            expected = "is no channel of palpate" if kind is None else f"takes {kind.__name__}"
            raise TypeError(f"{channel} {expected}, not {type(message).__name__}")
        self.stamp(channel, message)
        self.publish_sealed(channel, message)

    def stamp(self, channel: str, message: Any) -> None:
        """Sets utime (unless already set), session and the next seq of the channel."""
        message.utime = message.utime or wall_clock_us()
        message.session = self._session
        message.seq = self._seq.get(channel, 0)
        self._seq[channel] = message.seq + 1

    def publish_sealed(self, channel: str, message: Any) -> None:
        """Sends a message unchanged: one that has been stamped and signed."""
        self._transport.publish(self._names.get(channel, channel), message.encode())

    def subscribe(
        self, channel: str, callback: Optional[Callback] = None, queue: int = 1024
    ) -> Subscription:
        """Messages of a channel from now on; with a callback each is passed to it, otherwise
        to a queue of the newest `queue`. Raises ValueError for an unknown channel."""
        if type_of(channel) is None:
            raise ValueError(f"{channel}: is not a channel of palpate; see palpate.channel_names()")
        subscription = Subscription(self, channel, callback, queue)
        self._subscriptions.setdefault(channel, []).append(subscription)
        return subscription

    def unsubscribe(self, subscription: Subscription) -> None:
        """Stops the delivery of messages to it."""
        of_channel = self._subscriptions.get(subscription.channel, [])
        if subscription in of_channel:
            of_channel.remove(subscription)

    def handle(self, timeout: float = 0.0) -> bool:
        """Receives one message from the socket, waiting at most `timeout` s; False if none
        arrived."""
        packet = self._transport.receive(timeout)
        if packet is None:
            return False
        own = self._own_names.get(packet.channel)
        if own is None and packet.channel not in self._names:
            own = packet.channel
        for subscription in tuple(self._subscriptions.get(own or "", ())):
            subscription._take(packet.data)
        return True

    def drain(self, queue: Optional[Deque[Any]] = None) -> bool:
        """Receives pending messages, a bounded number, at most until `queue` holds one;
        returns whether it does."""
        for _ in range(_MOST_AT_ONCE):
            if queue or not self.handle(0):
                break
        return bool(queue)

    def run(self, seconds: float) -> None:
        """Receives for this many seconds, and calls callbacks."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            self.handle(left)

    def close(self) -> None:
        self._transport.close()
