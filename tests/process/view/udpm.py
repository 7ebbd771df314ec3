"""LCM messages, received, decoded and sent without palpate's or LCM's code."""
import collections
import socket
import struct
import threading
import time

import numpy as np

INTERESTING = {b"SHAPE", b"SHAPE_MESH", b"MANUAL_FORCE", b"COMPONENT_EVENT", b"HEALTH"}
COMMON = ">qqiq"  # fingerprint, utime, seq, session
BIOTAC = 0x899D567D1460611D  # fingerprint
DISCREPANCY = 0x5AA5CDF84DFF8D46
WORLD_STATE = 0x92EDBC9BF54DA07E


class Listener:
    """The last message of each channel of a multicast group, and their number."""

    def __init__(self, address, port):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 << 20)
        self.socket.bind((address, port))
        self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP,
                               struct.pack("4sI", socket.inet_aton(address), 0))
        self.socket.settimeout(0.2)
        self.last, self.count, self.history = {}, {}, {"MANUAL_FORCE": [], "COMPONENT_EVENT": []}
        self.shapes = collections.deque(maxlen=3000)  # half a minute
        self.mesh_chunks = {}
        self.stopped = False
        self.thread = threading.Thread(target=self.listen, daemon=True)
        self.thread.start()

    def listen(self):
        while not self.stopped:
            try:
                data = self.socket.recv(65536)
            except socket.timeout:
                continue
            # Thousands arrive per second; most are not needed here.
            end = data.find(b"\0", 8)
            if data[:4] != b"LC02" or data[8:end] not in INTERESTING:
                continue
            channel, payload = data[8:end].decode(), data[end + 1:]
            if channel in self.history:
                self.history[channel].append((time.monotonic(), payload))
            if channel == "SHAPE":
                self.shapes.append(payload)
            if channel == "SHAPE_MESH":
                self.mesh_chunks[chunk_of_mesh(payload)[0]] = payload
            self.last[channel] = payload
            self.count[channel] = self.count.get(channel, 0) + 1

    def mesh(self):
        """Rest positions and triangles of SHAPE_MESH; None until all chunks have come."""
        return mesh([self.mesh_chunks[i] for i in sorted(self.mesh_chunks)])

    def stop(self):
        self.stopped = True
        self.thread.join()
        self.socket.close()


class Sender:
    """Sends to a multicast group on this machine."""

    def __init__(self, address, port):
        self.to = (address, port)
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)

    def send(self, channel, payload):
        self.socket.sendto(b"LC02\0\0\0\0" + channel.encode() + b"\0" + payload, self.to)

    def stop(self):
        self.socket.close()


def biotac(seq, electrodes, pac, pdc):
    """BIOTAC_n with all readings valid except the temperature."""
    return struct.pack(">Qqiqi19hh22h3h", BIOTAC, seq * 10_000, seq, 5, 7, *electrodes, len(pac),
                       *pac, *[0] * (22 - len(pac)), pdc, 31, 32)


def world_state(seq, name, position, quaternion=(1, 0, 0, 0)):
    """WORLD_STATE of an obstacle at rest, without a code. Position in m, quaternion w, x, y, z, both in W."""
    return struct.pack(">Qqiqq32s24s13d", WORLD_STATE, time.time_ns() // 1000, seq, 5, seq, bytes(32), name.encode(), *position, *quaternion,
                       *(0,) * 6)


def discrepancy(seq, test, explanations=(), threshold=4.9):
    """DISCREPANCY of one hand, which `explanations` (cause, probability, place, value) explain if there are any; its
    force along z differs by -1.2 +- 0.1 N.
    """
    rows = list(explanations) + [(0, 0, (0, 0, 0), (0,) * 6)] * (8 - len(explanations))
    causes, probabilities, places, values = zip(*rows)
    difference, deviation = (0, 0, -1.2, 0, 0, 0), (0.1,) * 3 + (0.01,) * 3
    return struct.pack(">Qqiqi3diii12d12di8i8d8i24d48di", DISCREPANCY, seq * 50_000, seq, 5, bool(explanations), 2.1, test,
                       threshold, 0, 2, 1, *difference, *(0,) * 6, *deviation, *(-1,) * 6, len(explanations), *causes,
                       *probabilities, *(0,) * 8, *sum(places, ()), *sum(values, ()), 0)


def numbers(data, at, kind):
    """A count and that many numbers of 4 bytes; returns them, and their end."""
    (count,) = struct.unpack_from(">i", data, at)
    return np.frombuffer(data, kind, count, at + 4), at + 4 + 4 * count


def shape(data):
    """Positions of SHAPE or TRUTH_SHAPE, n x 3, m, and the mesh's hash."""
    at = struct.calcsize(COMMON)
    mesh_hash, _, _, _, chunks, _, _ = struct.unpack_from(">qiihhii", data, at)
    assert chunks == 1, "the test's shape fits one message"
    xyz, _ = numbers(data, at + 28, ">f4")
    return xyz.astype(float).reshape(-1, 3), mesh_hash


def chunk_of_mesh(data):
    """Number of a chunk of SHAPE_MESH, and of all chunks."""
    return struct.unpack_from(">hh", data, struct.calcsize(COMMON) + 12)


def mesh(chunks):
    """Rest positions and triangles of the chunks of one SHAPE_MESH in their order; None if some are missing."""
    if not chunks or len(chunks) < chunk_of_mesh(chunks[0])[1]:
        return None
    parts = []
    for data in chunks:
        rest, at = numbers(data, struct.calcsize(COMMON) + 24, ">f4")
        _, at = numbers(data, at + 4, ">i4")
        parts.append((rest, numbers(data, at, ">i4")[0]))
    rest, triangles = (np.concatenate(lists) for lists in zip(*parts))
    return rest.astype(float).reshape(-1, 3), triangles.reshape(-1, 3)


def manual_force(data):
    """Rest point and force of MANUAL_FORCE."""
    values = struct.unpack_from(">6d", data, struct.calcsize(COMMON) + 8 + 32)
    return np.array(values[:3]), np.array(values[3:])


def event(data):
    """Slot, component and event of COMPONENT_EVENT."""
    fields = struct.unpack_from("32s32s32s32s", data, struct.calcsize(COMMON))
    slot, _, component, name = (field.split(b"\0")[0].decode() for field in fields)
    return slot, component, name
