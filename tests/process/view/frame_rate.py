"""How fast palpate-view shows a large shape, and what limits it: its server, or the browser.

usage: frame_rate.py BINARIES SOURCE [--nodes N] [--seconds S] [--picture PNG]

Publishes a bar of N nodes that swings, at 100 Hz as palpated does, and looks at it with a browser
that draws in software. Prints frames a second, apart for a page that draws and for a reader that does not.
"""
import argparse
import math
import socket
import struct
import sys
import threading
import time

import numpy as np

from cell import Cell, wait_for

# Fingerprints of shape_t and shape_mesh_t, which a test checks.
FINGERPRINTS = {}


def fingerprints(source):
    """As computed by lcm-gen, from its generated code."""
    import re
    for name in ("shape_t", "shape_mesh_t", "estimate_t"):
        with open(f"{source}/{name}.hpp") as file:
            text = file.read()
        base = int(re.search(r"hash = (0x[0-9a-f]+)LL", text).group(1), 16)
        value = ((base << 1) + ((base >> 63) & 1)) & 0xFFFFFFFFFFFFFFFF
        FINGERPRINTS[name] = value


def bar(nodes):
    """A grid of about this many nodes: positions, tetrahedra, surface triangles."""
    side = max(2, round((nodes / 12) ** (1 / 3)))
    length = max(2, nodes // (side * side))
    count = (length, side, side)
    index = lambda i, j, k: i + count[0] * (j + count[1] * k)
    grid = np.stack(np.meshgrid(*[np.arange(c) for c in count], indexing="ij"), -1)
    xyz = np.zeros((np.prod(count), 3))
    for i, j, k in grid.reshape(-1, 3):
        xyz[index(i, j, k)] = (0.5 * i / (count[0] - 1), 0.06 * j / (side - 1), 0.06 * k / (side - 1))
    tetrahedra = []
    ways = [(1, 3), (1, 5), (2, 3), (2, 6), (4, 5), (4, 6)]
    for i in range(count[0] - 1):
        for j in range(side - 1):
            for k in range(side - 1):
                corner = [index(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)) for c in range(8)]
                tetrahedra += [(corner[0], corner[a], corner[b], corner[7]) for a, b in ways]
    tetrahedra = np.array(tetrahedra)
    # Positive orientation, as palpated's, so that all triangles point outwards.
    edges = xyz[tetrahedra[:, 1:]] - xyz[tetrahedra[:, :1]]
    mirrored = np.linalg.det(edges) < 0
    tetrahedra[mirrored, 2:] = tetrahedra[mirrored, :1:-1]
    faces = tetrahedra[:, [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]]].reshape(-1, 3)
    _, first, times = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    return xyz, tetrahedra, faces[first[times == 1]]


class Publisher:
    def __init__(self, cell, nodes, channel="SHAPE", mesh_channel="SHAPE_MESH"):
        self.address = (cell.group, cell.ports[1])
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
        self.rest, self.tetrahedra, self.triangles = bar(nodes)
        self.channel, self.mesh_channel = channel, mesh_channel
        self.sent, self.stopped = 0, False
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def send(self, channel, payload):
        self.sent += 1
        self.socket.sendto(b"LC02" + struct.pack(">I", self.sent) + channel.encode() + b"\0" + payload,
                           self.address)

    def head(self, kind, utime=None):
        utime = int(time.time() * 1e6) if utime is None else utime
        return struct.pack(">QqiqQ", FINGERPRINTS[kind], utime, self.sent, 1, 4711)

    def send_mesh(self):
        chunks = math.ceil(max(len(self.rest), len(self.tetrahedra), len(self.triangles)) / 1000)
        for chunk in range(chunks):
            part = slice(1000 * chunk, 1000 * (chunk + 1))
            lists = [self.rest[part].astype(">f4"), self.tetrahedra[part].astype(">i4"),
                     self.triangles[part].astype(">i4")]
            first = min(1000 * chunk, len(self.rest))
            payload = self.head("shape_mesh_t") + struct.pack(">ihhii", 0, chunk, chunks, len(self.rest), first)
            payload += struct.pack(">i", lists[0].size) + lists[0].tobytes()
            payload += struct.pack(">ii", 4, lists[1].size) + lists[1].tobytes()
            payload += struct.pack(">i", lists[2].size) + lists[2].tobytes() + struct.pack(">i", 0)
            self.send(self.mesh_channel, payload)

    def send_estimate(self):
        """E and nu, without which no stress is reported."""
        numbers = [0.0] * 74 + [math.log(30e3), -1, 0.3, -1, -1] + [0.0] * 6 + [-1]
        self.send("ESTIMATE", self.head("estimate_t")[:-8] + struct.pack(">ii86d", 0, 0, *numbers))

    def run(self):
        due, cycle = time.monotonic(), 0
        while not self.stopped:
            if cycle % 100 == 0:
                self.send_mesh()
                self.send_estimate()
            moved = self.rest.copy()
            moved[:, 2] += 0.2 * math.sin(0.03 * cycle) * self.rest[:, 0] ** 2 / 0.5
            utime, chunks = int(time.time() * 1e6), math.ceil(len(moved) / 4000)
            for chunk in range(chunks):
                part = moved[4000 * chunk : 4000 * (chunk + 1)]
                payload = self.head("shape_t", utime) + struct.pack(
                    ">iihhiii", 0, 0, chunk, chunks, len(moved), 4000 * chunk, part.size)
                self.send(self.channel, payload + part.astype(">f4").tobytes() + struct.pack(">i", 0))
            cycle += 1
            due = max(due + 0.01, time.monotonic() - 0.05)
            time.sleep(max(0.0, due - time.monotonic()))

    def stop(self):
        self.stopped = True
        self.thread.join()


READER = """
const done = arguments[arguments.length - 1], seconds = arguments[0], field = arguments[1];
const socket = new WebSocket(`ws://${location.host}/live`);
socket.binaryType = 'arraybuffer';
let frames = 0, bytes = 0, begin = 0;
socket.onopen = () => socket.send(JSON.stringify({type: 'colour', field}));
socket.onmessage = ({data}) => {
  if (typeof data === 'string') return;
  const length = new DataView(data).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, length)));
  if (head.type !== 'frame') return;
  socket.send(JSON.stringify({type: 'ack', frame: head.frame}));
  const now = performance.now();
  if (!begin) begin = now;
  ++frames;
  bytes += data.byteLength;
  if (now - begin > 1000 * seconds) {
    socket.onmessage = null;
    socket.close();
    done({fps: 1000 * (frames - 1) / (now - begin), bytes: bytes / frames});
  }
};
"""


def processor_time(process):
    with open(f"/proc/{process.pid}/stat") as file:
        fields = file.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / 100  # s


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("binaries")
    parser.add_argument("source")
    parser.add_argument("--nodes", type=int, default=5000)
    parser.add_argument("--seconds", type=float, default=8)
    parser.add_argument("--picture")
    options = parser.parse_args()
    fingerprints(f"{options.binaries}/../lcmtypes/include/palpate")
    cell = Cell(options.binaries, options.source)
    publisher = Publisher(cell, options.nodes)
    print(f"{len(publisher.rest)} nodes, {len(publisher.tetrahedra)} elements, "
          f"{len(publisher.triangles)} triangles, published at 100 Hz")
    try:
        cell.start_view()
        cell.open_browser(1280, 800)
        wait_for(lambda: cell.js("!!window.palpate && palpate.estimate.mesh !== null"), "the mesh")
        process = cell.processes["palpate-view"]
        # The page is suspended meanwhile: the measurement covers the server, the socket and the
        # decoding.
        for field in ("displacement", "strain", "stress"):
            cell.browser.execute_script("palpate.link.socket.onclose = null; palpate.link.socket.close()")
            before = processor_time(process)
            read = cell.browser.execute_async_script(READER, options.seconds, field)
            used = processor_time(process) - before
            frames = read["fps"] * options.seconds
            print(f"server, coloured by {field}: {read['fps']:.1f} frames/s to a reader that does not draw, "
                  f"{read['bytes'] / 1e3:.0f} kB each, {1e3 * used / frames:.2f} ms of processor a frame")
        for width, height, smooth in ((1280, 800, True), (1280, 800, False), (640, 400, False)):
            cell.resize(width, height)
            cell.browser.get(f"http://127.0.0.1:{cell.port}/{'?smooth' if smooth else ''}")
            wait_for(lambda: cell.js("!!window.palpate && palpate.frames > 5"), "frames")
            cell.next_frames(5)
            before, begin = cell.frames(), time.monotonic()
            time.sleep(options.seconds)
            fps = (cell.frames() - before) / (time.monotonic() - begin)
            timing = cell.js("palpate.timing")
            # Commands to a software renderer are only queued: read a pixel back to wait for them.
            drawn = cell.browser.execute_script(
                "const s = palpate.stage, gl = s.renderer.getContext(), p = new Uint8Array(4);"
                "s.render(); gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, p);"
                "const t = performance.now(); for (let i = 0; i < 10; ++i) { s.render();"
                "gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, p); } return (performance.now() - t) / 10;")
            print(f"page of {width} x {height}{', smooth edges' if smooth else ''}: {fps:.1f} frames/s; a frame: {timing['show']:.1f} ms of script, "
                  f"{timing['render']:.1f} ms to give orders, {drawn:.1f} ms until drawn in software")
        if options.picture:
            cell.resize(1280, 800)
            cell.next_frames()
            cell.picture(options.picture)
    finally:
        publisher.stop()
        print(cell.js("palpate.stage.renderer.getContext().getParameter(0x1F01)") if cell.browser else "")
        cell.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
