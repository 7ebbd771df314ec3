"""Receives what palpate-view sends to a page, as a browser on another machine would, and
draws nothing.
"""
import base64
import json
import os
import socket
import struct
import threading


class PageReader:
    """`bytes` and `pictures` increase while palpate-view sends. Raises ConnectionError if it
    rejects the connection.
    """

    def __init__(self, port):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=20)
        self.stream = self.socket.makefile("rb")
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall((f"GET /live HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n"
                             f"Origin: http://127.0.0.1:{port}\r\nUpgrade: websocket\r\n"
                             "Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                             f"Sec-WebSocket-Key: {key}\r\n\r\n").encode())
        status = self.stream.readline()
        while self.stream.readline() not in (b"\r\n", b""):
            pass
        if b" 101 " not in status:
            raise ConnectionError(status.decode(errors="replace"))
        self.bytes = self.pictures = 0
        self.thread = threading.Thread(target=self._read, daemon=True)
        self.thread.start()

    def _read(self):
        try:
            while True:
                kind, payload = self._message()
                self.bytes += len(payload)
                if kind != 2:
                    continue
                (length,) = struct.unpack_from("<I", payload)
                head = json.loads(payload[4:4 + length])
                if "frame" in head:  # the next image is sent once this one is acknowledged
                    self.pictures += 1
                    self._send({"type": "ack", "frame": head["frame"]})
        except (OSError, ValueError, struct.error):
            pass  # closed

    def _message(self):
        """Opcode and payload of a frame (RFC 6455, 5.2); frames of a server are complete and
        not masked.
        """
        kind, length = self.stream.read(2)
        if length == 126:
            (length,) = struct.unpack(">H", self.stream.read(2))
        elif length == 127:
            (length,) = struct.unpack(">Q", self.stream.read(8))
        return kind & 15, self.stream.read(length)

    def _send(self, message):
        text = json.dumps(message).encode()
        assert len(text) < 126
        mask = os.urandom(4)
        masked = bytes(b ^ mask[i % 4] for i, b in enumerate(text))
        self.socket.sendall(bytes([0x81, 0x80 | len(text)]) + mask + masked)

    def close(self):
        self.socket.shutdown(socket.SHUT_RDWR)
        self.thread.join()
        self.stream.close()
        self.socket.close()
