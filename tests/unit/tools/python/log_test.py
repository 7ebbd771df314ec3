"""Logs: written data are read back, damaged parts are skipped, and arrays equal what was
sent.
"""

import tempfile
import unittest
from pathlib import Path

import numpy as np
import palpate
from palpate import messages
from palpate.channels import field_of


def wrench(utime: int, force: float) -> messages.ft_wrench_t:
    message = messages.ft_wrench_t()
    message.utime, message.wrench = utime, [force, 0, 0, 0, 0, force / 10]
    return message


class Logs(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name) / "a.log"

    def write(self, count: int = 10) -> bytes:
        with palpate.EventLogWriter(self.path) as log:
            for i in range(count):
                data = wrench(5_000_000 + 500 * i, float(i)).encode()
                log.write(1_000_000 + 1000 * i, "FT_WRENCH", data)
        return self.path.read_bytes()

    def test_arrays_have_the_units_and_times_of_the_messages(self) -> None:
        self.write()
        series = palpate.read_log(self.path)["FT_WRENCH"]
        self.assertEqual(len(series), 10)
        np.testing.assert_array_equal(series.wrench[:, 0], np.arange(10))
        np.testing.assert_allclose(series.time, np.arange(10) * 1e-3, atol=1e-12)
        np.testing.assert_array_equal(series.sent_utime, 5_000_000 + 500 * np.arange(10))
        sent = palpate.read_log(self.path, clock="sent")["FT_WRENCH"]
        np.testing.assert_allclose(sent.time, np.arange(10) * 5e-4, atol=1e-12)
        self.assertEqual(len(series.where(series.wrench[:, 0] > 6)), 3)
        with self.assertRaisesRegex(AttributeError, "it has: utime"):
            series.no_such_field

    def test_several_files_are_put_together_by_time(self) -> None:
        self.write()
        other = self.path.with_name("b.log")
        with palpate.EventLogWriter(other) as log:
            log.write(1_000_500, "FT_WRENCH", wrench(1, 99.0).encode())
            log.write(1_000_700, "IMU", messages.imu_t().encode())
        log = palpate.read_log(self.path, other)
        self.assertEqual(log.channels, ["FT_WRENCH", "IMU"])
        self.assertEqual(log["FT_WRENCH"].wrench[1, 0], 99)
        self.assertAlmostEqual(log.duration, 9e-3)
        with self.assertRaisesRegex(KeyError, "it has: FT_WRENCH, IMU"):
            log["SHAPE"]

    def test_texts_and_positions(self) -> None:
        event = messages.component_event_t()
        event.slot, event.instance = field_of("all", 32), field_of("", 32)
        event.component, event.event = field_of("", 32), field_of("start", 32)
        event.reason = field_of("because", 256)
        shape = messages.shape_t()
        shape.chunks = 1
        shape.node_count, shape.xyz_count, shape.xyz = 2, 6, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
        with palpate.EventLogWriter(self.path) as log:
            log.write(1, "COMPONENT_EVENT", event.encode())
            log.write(2, "SHAPE", shape.encode())
            shape.mesh_hash, shape.node_count, shape.xyz_count, shape.xyz = 1, 1, 3, [7, 8, 9]
            log.write(3, "SHAPE", shape.encode())
            log.write(4, "SHAPE", b"nonsense")
            log.write(5, "SOMETHING_ELSE", b"")
        read = palpate.read_log(self.path)
        self.assertEqual(read["COMPONENT_EVENT"].reason.tolist(), ["because"])
        self.assertEqual(read.undecodable, {"SHAPE": 1})
        self.assertEqual(read.unknown, {"SOMETHING_ELSE": 1})
        with self.assertRaisesRegex(ValueError, "the mesh changes"):
            read["SHAPE"].positions
        first = read["SHAPE"].of_mesh(0).positions
        np.testing.assert_array_equal(first, [[[0, 1, 2], [3, 4, 5]]])

    def test_chunks_of_a_shape_are_joined(self) -> None:
        with palpate.EventLogWriter(self.path) as log:
            for number in (1, 0):
                chunk = messages.shape_t()
                chunk.utime, chunk.chunk, chunk.chunks, chunk.node_count = 5, number, 2, 2
                chunk.first_node = number
                chunk.xyz_count, chunk.xyz = 3, [3.0 * number, 3.0 * number + 1, 3.0 * number + 2]
                chunk.deviation_count, chunk.deviation = 1, [0.5 * number]
                log.write(10 + number, "SHAPE", chunk.encode())
        shapes = palpate.read_log(self.path)["SHAPE"]
        np.testing.assert_array_equal(shapes.positions, [[[0, 1, 2], [3, 4, 5]]])
        np.testing.assert_array_equal(shapes.deviation, [[0, 0.5]])

    def test_former_types_are_converted(self) -> None:
        shape, mesh, health = (messages.shape_v1_t(), messages.shape_mesh_v1_t(), messages.health_v1_t())
        shape.mesh_hash, shape.node_count, shape.xyz_count = 7, 4, 12
        shape.xyz = [0.0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1]
        mesh.mesh_hash, mesh.chunks, mesh.corner_count, mesh.element_size = 7, 1, 4, 4
        mesh.element_kind = messages.shape_mesh_t.QUADRATIC_TETRAHEDRA
        mesh.rest_xyz_count, mesh.rest_xyz = 12, shape.xyz
        mesh.element_index_count, mesh.elements = 4, [0, 1, 2, 3]
        health.gate_refused, health.commands_refused, health.cycles = 3, 4, 5
        health.input_name, health.model_name = [bytes(24)] * 16, [bytes(24)] * 12
        health.model_executor, health.reason = [bytes(12)] * 12, bytes(128)
        with palpate.EventLogWriter(self.path) as log:
            log.write(1, "SHAPE_MESH", mesh.encode())
            log.write(2, "SHAPE", shape.encode())
            log.write(3, "HEALTH", health.encode())
        read = palpate.read_log(self.path)
        self.assertEqual(read.undecodable, {})
        np.testing.assert_array_equal(read["SHAPE"].positions[0], read.mesh.nodes)
        self.assertEqual(read["HEALTH"].gate_rejected.tolist(), [3])
        self.assertEqual(read["HEALTH"].commands_rejected.tolist(), [4])
        self.assertEqual(read["HEALTH"].cycles.tolist(), [5])

    def test_damage_is_skipped_and_reported(self) -> None:
        data = self.write()
        size = len(data) // 10
        for damaged, kept, damage in (
            # An event is accepted only if another one, or the end, follows.
            (data[: 5 * size] + b"\0" * 100 + data[5 * size :], 9, (100 + size, 1, False)),
            (data[: 9 * size + 40], 9, (0, 0, True)),
            (data[: 9 * size + 2], 9, (0, 0, True)),
            (data[:30] + data[size:], 9, (30, 1, False)),
            (b"\xed\xa1\xda\x01" + data, 10, (4, 1, False)),
        ):
            self.path.write_bytes(damaged)
            log = palpate.read_log(self.path)
            self.assertEqual(len(log["FT_WRENCH"]), kept)
            self.assertEqual(tuple(log.damages[str(self.path)]), damage)

    def test_any_damage_leaves_it_alive(self) -> None:
        data = self.write(30)
        generator = np.random.default_rng(4)
        for _ in range(300):
            damaged = bytearray(data)
            for _ in range(generator.integers(1, 6)):
                damaged[generator.integers(len(damaged))] = generator.integers(256)
            cut = int(generator.integers(1, len(damaged)))
            self.path.write_bytes(damaged[cut:] if generator.random() < 0.5 else damaged)
            try:
                palpate.read_log(self.path)
            except ValueError as error:
                self.assertIn("no LCM event log", str(error))

    def test_what_is_no_log_is_said_so(self) -> None:
        self.path.write_bytes(b"hello" * 100)
        with self.assertRaisesRegex(ValueError, "a.log: is no LCM event log"):
            palpate.read_log(self.path)
        with self.assertRaises(FileNotFoundError):
            palpate.read_log(self.path.with_name("absent.log"))
        with self.assertRaisesRegex(ValueError, "allowed: received, sent"):
            self.write()
            palpate.read_log(self.path, clock="wall")
        self.path.write_bytes(b"")
        self.assertEqual(palpate.read_log(self.path).channels, [])


if __name__ == "__main__":
    unittest.main()
