"""Scores compared with cases whose results are known, and points within meshes."""

import math
import tempfile
import unittest
from pathlib import Path
from typing import Any

import numpy as np
import palpate
from palpate import evaluate, messages
from palpate.channels import field_of
from palpate.mesh import Mesh, MeshBuilder, PointsInMesh

from support import tetrahedra


def hexahedron() -> Mesh:
    """One box of 27 nodes in a shuffled order."""
    grid = [[x, y, z] for x in (0, 0.5, 1) for y in (0, 0.5, 1) for z in (0, 0.5, 1)]
    nodes = np.array(grid)[np.random.default_rng(2).permutation(27)] * [0.4, 0.1, 0.2]
    empty = np.zeros(0, int)
    return Mesh(9, 2, nodes, np.arange(27)[None], np.zeros((0, 3), int), empty)


def chunk_of(mesh: Mesh) -> messages.shape_mesh_t:
    message = messages.shape_mesh_t()
    message.mesh_hash, message.element_kind, message.chunks = mesh.hash, mesh.element_kind, 1
    message.node_count, message.element_size = len(mesh.nodes), mesh.elements.shape[1]
    message.rest_xyz = mesh.nodes.ravel().tolist()
    message.rest_xyz_count = len(message.rest_xyz)
    message.elements = mesh.elements.ravel().tolist()
    message.element_index_count = len(message.elements)
    return message


def shape_of(mesh: Mesh, positions: Any, utime: int, deviation: Any = ()) -> messages.shape_t:
    message = messages.shape_t()
    message.utime, message.mesh_hash, message.node_count = utime, mesh.hash, len(mesh.nodes)
    message.chunks = 1
    message.xyz = np.asarray(positions).ravel().tolist()
    message.xyz_count = len(message.xyz)
    message.deviation = list(deviation)
    message.deviation_count = len(message.deviation)
    return message


class Points(unittest.TestCase):
    def test_linear_tetrahedra_give_linear_maps_back(self) -> None:
        mesh = tetrahedra()
        points = np.random.default_rng(1).random((200, 3))
        map_ = np.array([[1, 0.2, 0], [0.1, 1.3, 0], [0, 0.4, 0.7]])
        moved = PointsInMesh(mesh, points).at(mesh.nodes @ map_ + 3)
        np.testing.assert_allclose(moved, points @ map_ + 3, atol=1e-12)

    def test_quadratic_boxes_give_quadratic_maps_back(self) -> None:
        mesh = hexahedron()
        points = np.random.default_rng(1).random((100, 3)) * [0.4, 0.1, 0.2]

        def bend(x: Any) -> Any:
            return x + np.stack([x[:, 1] * x[:, 2], x[:, 0] ** 2, x[:, 0] * x[:, 1]], axis=1)

        moved = PointsInMesh(mesh, points).at(np.stack([bend(mesh.nodes), mesh.nodes]))
        np.testing.assert_allclose(moved[0], bend(points), atol=1e-12)
        np.testing.assert_allclose(moved[1], points, atol=1e-12)

    def test_quadratic_tetrahedra_give_quadratic_maps_back(self) -> None:
        linear = tetrahedra()
        ends = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]
        nodes, elements, middles = list(linear.nodes), [], {}
        for element in linear.elements:
            row = list(element)
            for a, b in ends:
                key = tuple(sorted((element[a], element[b])))
                if key not in middles:
                    middles[key] = len(nodes)
                    nodes.append((linear.nodes[key[0]] + linear.nodes[key[1]]) / 2)
                row.append(middles[key])
            elements.append(row)
        mesh = Mesh(7, 1, np.array(nodes), np.array(elements), linear.triangles, linear.constrained)
        np.testing.assert_array_equal(mesh.corners, np.arange(8))
        points = np.random.default_rng(1).random((100, 3))

        def bend(x: Any) -> Any:
            return x + np.stack([x[:, 1] * x[:, 2], x[:, 0] ** 2, x[:, 0] * x[:, 1]], axis=1)

        moved = PointsInMesh(mesh, points).at(bend(mesh.nodes))
        np.testing.assert_allclose(moved, bend(points), atol=1e-12)

    def test_points_outside_take_the_nearest_element(self) -> None:
        mesh = tetrahedra()
        moved = PointsInMesh(mesh, [[1 + 1e-7, 0.5, 0.5]]).at(mesh.nodes + [0, 0, 1])
        np.testing.assert_allclose(moved, [[1, 0.5, 1.5]], atol=1e-6)

    def test_other_elements_are_refused(self) -> None:
        mesh = tetrahedra()
        other = Mesh(1, 1, mesh.nodes, np.zeros((1, 8), int), mesh.triangles, mesh.constrained)
        with self.assertRaisesRegex(ValueError, "neither"):
            PointsInMesh(other, [[0, 0, 0]])


class Chunks(unittest.TestCase):
    def test_a_mesh_is_whole_once_all_its_chunks_have_come(self) -> None:
        whole, builder = chunk_of(tetrahedra()), MeshBuilder()
        first, second = chunk_of(tetrahedra()), chunk_of(tetrahedra())
        first.chunks = second.chunks = 2
        first.rest_xyz, first.rest_xyz_count = whole.rest_xyz[:12], 12
        second.chunk, second.first_node = 1, 4
        second.rest_xyz, second.rest_xyz_count = whole.rest_xyz[12:], 12
        second.elements = []
        self.assertIsNone(builder.add(second))
        mesh = builder.add(first)
        assert mesh is not None
        np.testing.assert_array_equal(mesh.nodes, tetrahedra().nodes)
        np.testing.assert_array_equal(mesh.elements, tetrahedra().elements)

    def test_chunks_that_cannot_be_are_refused(self) -> None:
        for field, value in (
            ("elements", [0, 1, 2, 8]),
            ("elements", [0, 1, 2]),
            ("first_node", 1),
            ("first_node", -1),
            ("node_count", 9),
            ("node_count", -9),
            ("element_size", 0),
        ):
            chunk = chunk_of(tetrahedra())
            setattr(chunk, field, value)
            with self.assertRaises(ValueError, msg=field):
                palpate.assemble([chunk])


class Scores(unittest.TestCase):
    """A cube that moves along x, and an estimate with a known error."""

    def write(self, offset: float, deviation: float = 0.0) -> palpate.Log:
        mesh = tetrahedra()
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        path = Path(folder.name) / "run.log"
        with palpate.EventLogWriter(path) as log:
            log.write(0, "SHAPE_MESH", chunk_of(mesh).encode())
            log.write(0, "TRUTH_MESH", chunk_of(mesh).encode())
            target = messages.shape_target_t()
            target.revision, target.chunks, target.point_count, target.value_count = 3, 1, 1, 3
            target.kind = field_of("point", 32)
            target.authentication = bytes(32)
            target.rest_points[0] = [1.0, 1.0, 1.0]
            target.values[:3] = [1.1, 1.0, 1.0]
            log.write(100, "SHAPE_TARGET", target.encode())
            for i in range(101):
                way = 0.1 * (1 - math.exp(-i / 10))
                truth = shape_of(mesh, mesh.nodes + [way, 0, 0], 10_000 * i)
                log.write(truth.utime, "TRUTH_SHAPE", truth.encode())
                # Between two truths, so that they are interpolated.
                middle = 0.05 * (2 - math.exp(-i / 10) - math.exp(-(i + 1) / 10))
                estimate = shape_of(
                    mesh,
                    mesh.nodes + [middle, offset, 0],
                    10_000 * i + 5000,
                    [deviation] * 8 if deviation else (),
                )
                log.write(estimate.utime, "SHAPE", estimate.encode())
        return palpate.read_log(path)

    def test_the_shape_error_is_that_of_the_nodes(self) -> None:
        error = palpate.shape_error(self.write(0.002))
        self.assertEqual(len(error.time), 100)  # the last one lies after the truth
        for number in error.whole:
            self.assertAlmostEqual(number, 0.002, places=6)
        self.assertAlmostEqual(error.displacement[-1], 0.1, places=4)
        self.assertAlmostEqual(error.at_end.maximum, 0.002, places=6)
        self.assertEqual(error.length, 1)

    def test_the_feature_error_is_that_of_the_plant(self) -> None:
        error = palpate.feature_error(self.write(0.5))
        self.assertEqual(error.kind, "point")
        # 0.1 exp(-t / 0.1 s) is below 5 mm from 0.2996 s on.
        self.assertAlmostEqual(error.settle_time(5e-3) or 0, 0.3 - 1e-4, places=3)
        self.assertIsNone(error.settle_time(1e-9))
        self.assertEqual(error.overshoot, 0)
        self.assertLess(error.at_rest, 1e-3)

    def test_coverage_counts_the_truths_within_the_ball(self) -> None:
        # 2 mm off: within 95 % if the standard deviation is above 2 mm / 2.7955.
        self.assertEqual(palpate.shape_coverage(self.write(0.002, 0.002 / 2.78)), 1)
        self.assertEqual(palpate.shape_coverage(self.write(0.002, 0.002 / 2.81)), 0)
        with self.assertRaisesRegex(ValueError, "deviation"):
            palpate.shape_coverage(self.write(0.002))

    def test_what_lacks_is_named(self) -> None:
        log = self.write(0.0)
        for channel, error in (
            ("SHAPE", KeyError),
            ("TRUTH_SHAPE", KeyError),
            ("TRUTH_MESH", ValueError),
            ("SHAPE_MESH", ValueError),
        ):
            kept = log._series.pop(channel)
            log._made.clear()
            with self.assertRaisesRegex(error, channel):
                palpate.shape_error(log)
            log._series[channel] = kept


class Numbers(unittest.TestCase):
    def test_settle_time_wants_it_to_stay(self) -> None:
        time = [0, 1, 2, 3]
        self.assertEqual(palpate.settle_time(time, [False, True, False, True]), 3)
        self.assertEqual(palpate.settle_time(time, [True] * 4), 0)
        self.assertIsNone(palpate.settle_time(time, [True, True, True, False]))

    def test_coverage_of_normal_errors_is_the_level(self) -> None:
        generator = np.random.default_rng(5)
        for level in (0.5, 0.95):
            one = palpate.coverage(generator.normal(0, 3, 100_000), 3.0, 1, level)
            self.assertAlmostEqual(one, level, delta=0.01)
            length = np.linalg.norm(generator.normal(0, 3, (100_000, 3)), axis=1)
            self.assertAlmostEqual(palpate.coverage(length, 3.0, 3, level), level, delta=0.01)

    def test_poses_are_those_of_three_points(self) -> None:
        points = np.array([[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0.0]])
        angle = 0.3
        turn = np.array(
            [[math.cos(angle), -math.sin(angle), 0], [math.sin(angle), math.cos(angle), 0], [0, 0, 1]]
        )  # fmt: skip
        values = evaluate.feature_values("pose", np.stack([points, points @ turn.T]))
        np.testing.assert_allclose(values[0], [0.1 / 3, 0.1 / 3, 0, 1, 0, 0, 0], atol=1e-12)
        half = angle / 2
        np.testing.assert_allclose(
            values[1][3:], [math.cos(half), 0, 0, math.sin(half)], atol=1e-12
        )
        distance, turned = evaluate._errors("pose", values, values[0])
        np.testing.assert_allclose(turned, [0, angle], atol=1e-7)
        self.assertAlmostEqual(distance[0], 0)


if __name__ == "__main__":
    unittest.main()
