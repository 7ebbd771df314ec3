"""Scenes, arm, sensors and plants of palpate-world, without processes."""

from __future__ import annotations

import os
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
import yaml

SOURCE = Path(os.environ["PALPATE_SOURCE_DIR"])
sys.path.insert(0, str(SOURCE / "tools/lab/worlds"))

from arm import Arm, motion_at  # noqa: E402
from object_mesh import box_of_tetrahedra, graded_borders, hexahedra, volumes  # noqa: E402
from obstacles import (  # noqa: E402
    Capsule,
    Cuboid,
    Cylinder,
    HalfSpace,
    Obstacle,
    Sphere,
    penetrations,
)
from rigid import Pose, exp_rotation  # noqa: E402
from scene import Scene, read_scene  # noqa: E402
from scene_reader import SceneError  # noqa: E402
from sensors import SensorSuite, Signal  # noqa: E402
from worlds import make_plant  # noqa: E402

POSES = SOURCE / "sim/scenes/bar_long_soft_six_poses.yaml"
CONTROL = SOURCE / "sim/scenes/bar_long_soft_control.yaml"
BLOCK = SOURCE / "sim/scenes/block_hard_control.yaml"


class Scenes(unittest.TestCase):
    def test_a_scene_overrides_its_base(self) -> None:
        scene = read_scene(SOURCE / "sim/scenes/block_soft_six_poses.yaml", ["seed=7"])
        self.assertEqual(scene.body.young_modulus, 30e3)  # of the file
        self.assertEqual(scene.body.poisson_ratio, 0.3)  # of the last base
        np.testing.assert_array_equal(scene.body.size, [0.4, 0.06, 0.4])
        self.assertEqual(scene.seed, 7)
        self.assertEqual(scene.sensors["force_torque"]["force"]["noise"], 0.025)
        self.assertTrue(scene.urdf.is_file())

    def test_an_unknown_key_is_rejected(self) -> None:
        with self.assertRaisesRegex(SceneError, "object.stiffness_field"):
            read_scene(CONTROL, ["object.stiffness_field={deviation: 0.2}"])

    def test_every_scene_is_read_or_rejected_by_key(self) -> None:
        read = 0
        for file in sorted((SOURCE / "sim/scenes").glob("*.yaml")):
            try:
                read_scene(file, [])
                read += 1
            except SceneError as error:
                self.assertIn(str(file), str(error))
        self.assertGreaterEqual(read, 10)


class Obstacles(unittest.TestCase):
    def test_distances_are_signed(self) -> None:
        cases = (
            (HalfSpace(), [3, 4, -0.2], -0.2),
            (Sphere(0.5), [0, 0.3, 0.4], 0.0),
            (Sphere(0.5), [0, 0, 0.1], -0.4),
            (Cuboid(np.array([2.0, 4, 6])), [4, 6, 0], 5.0),  # beyond an edge: 3, 4
            (Cuboid(np.array([2.0, 4, 6])), [0.9, 0, 0], -0.1),
            (Cylinder(1.0, 2.0), [0, 4, 5], 5.0),  # beyond the rim: 3, 4
            (Cylinder(1.0, 2.0), [0, 0.5, 0.9], -0.1),
            (Cylinder(1.0, None), [0, 4, 5], 3.0),
            (Capsule(1.0, 2.0), [3, 0, 5], 4.0),  # from the end's centre: 3, 4
            (Capsule(1.0, 2.0), [0.2, 0, 0.5], -0.8),
        )
        for shape, point, expected in cases:
            distance = shape.distance(np.array([point], float))
            np.testing.assert_allclose(distance, [expected], atol=1e-12, err_msg=str(shape))

    def test_distances_have_gradients_of_unit_length(self) -> None:
        points = np.random.default_rng(1).uniform(-2, 2, (200, 3))
        shapes = (Cuboid(np.ones(3)), Sphere(0.7), Cylinder(0.6, 1.0), Capsule(0.5, 1.0))
        for shape in shapes:
            steps = [1e-6 * axis for axis in np.eye(3)]
            slopes = [(shape.distance(points + d) - shape.distance(points - d)) for d in steps]
            np.testing.assert_allclose(np.linalg.norm(slopes, axis=0) / 2e-6, 1, atol=1e-6)

    def test_penetration_is_that_of_the_deepest_point(self) -> None:
        table = Obstacle("table", HalfSpace(), Pose(position=np.array([0, 0, -0.1])), 0.5)
        far = Obstacle("far", Sphere(0.1), Pose(position=np.array([9.0, 0, 0])), 0.5)
        points = np.array([[0, 0, 0.0], [1, 0, -0.12], [0, 1, -0.11]])
        np.testing.assert_allclose(penetrations([table, far], points), [0.02, 0])

    def test_a_scene_and_a_configuration_describe_the_same_obstacles(self) -> None:
        rods = (
            "[{cylinder: {point: [0.24, 0.03, -0.045], axis: [0, 2, 0], radius: 0.03, length: 0.2},"
            " friction: 0.3, stiffness: 1e6}]",
            "[{shape: cylinder, radius: 0.03, length: 0.2, friction: 0.3,"
            " pose: {position: [1.12, 0, 0.235], rpy_deg: [90, 0, 0]}}]",
        )
        points = np.random.default_rng(1).uniform(-0.3, 0.3, (50, 3))
        distances = []
        for text in rods:
            (rod,) = read_scene(CONTROL, [f"obstacles={text}"]).obstacles
            self.assertEqual(rod.friction, 0.3)
            distances.append(rod.distance(points))
        np.testing.assert_allclose(distances[0], distances[1], atol=1e-12)

    def test_palpated_is_given_the_obstacles_of_the_scene(self) -> None:
        from touch import obstacles_of_configuration

        for name in ("table", "cylinder"):
            scene = read_scene(SOURCE / f"sim/scenes/bar_long_soft_{name}.yaml", [])
            entries = yaml.safe_load(obstacles_of_configuration(scene).partition("=")[2])
            for entry in entries:
                self.assertEqual(entry.pop("allowed"), "contact")
            again = read_scene(CONTROL, [f"obstacles={entries}"])
            points = np.random.default_rng(1).uniform(-0.3, 0.3, (50, 3))
            self.assertEqual(again.obstacles[0].friction, scene.obstacles[0].friction)
            ours, theirs = (each.obstacles[0].distance(points) for each in (scene, again))
            np.testing.assert_allclose(ours, theirs, atol=1e-12)

    def test_what_no_world_has_is_rejected_by_name(self) -> None:
        cases = {
            "[{shape: mesh, file: a.stl}]": "obstacles.0.shape: 'mesh'",
            "[{shape: sphere, radius: 0.1, moved: true}]": "obstacles.0.moved",
            "[{shape: sphere, radius: 0.1, link: hand}]": "obstacles.0.link",
            "[{shape: sphere, radius: 0}]": "obstacles.0.radius",
            "[{shape: box, size: [1, 0, 1]}]": "obstacles.0.size",
            "[{friction: 0.5}]": "obstacles.0.shape",
            "[{plane: {point: [0, 0, 0], normal: [0, 0, 0]}}]": "obstacles.0.plane.normal",
            "[{name: a, shape: half_space}, {name: a, shape: half_space}]": "obstacles.1.name",
        }
        for text, expected in cases.items():
            with self.assertRaisesRegex(SceneError, expected):
                read_scene(CONTROL, [f"obstacles={text}"])

    def test_drake_averages_friction_to_that_of_the_obstacle(self) -> None:
        from drake_obstacles import counterpart

        for friction in (0.0, 0.2, 0.5):
            other = counterpart(friction, 0.5)
            self.assertAlmostEqual(2 * other * 0.5 / (other + 0.5), friction)


class Motion(unittest.TestCase):
    def setUp(self) -> None:
        self.scene = read_scene(POSES, [])

    def test_ends_in_the_last_pose(self) -> None:
        translation, rotation, rate = motion_at(self.scene, 100)
        np.testing.assert_allclose(translation, [-0.05, 0.1, 0.1])
        np.testing.assert_allclose(rotation, exp_rotation(np.radians([30, -28.28, 28.28])))
        np.testing.assert_array_equal(rate, np.zeros(6))

    def test_twist_is_the_derivative(self) -> None:
        for time in (1.7, 6.2, 10.1, 24.0):
            before, at, after = (motion_at(self.scene, time + dt) for dt in (-1e-5, 0, 1e-5))
            np.testing.assert_allclose((after[0] - before[0]) / 2e-5, at[2][:3], atol=1e-6)
            spin = (after[1] - before[1]) / 2e-5 @ at[1].T
            np.testing.assert_allclose([spin[2, 1], spin[0, 2], spin[1, 0]], at[2][3:], atol=1e-6)


class Arms(unittest.TestCase):
    def test_grasps_where_the_scenes_say(self) -> None:
        for file, place in ((CONTROL, [0.47, 0.03, 0.03]), (BLOCK, [0.37, 0.03, 0.2])):
            X_OG = Arm(read_scene(file, [])).grasp_in_object()
            np.testing.assert_allclose(X_OG.position, place, atol=1e-6)
            np.testing.assert_allclose(X_OG.rotation, np.eye(3), atol=1e-6)

    def test_carries_the_payload_of_the_configurations(self) -> None:
        payload = Arm(read_scene(CONTROL, [])).model.payload
        self.assertAlmostEqual(payload.mass, 4.8)
        np.testing.assert_allclose(payload.centre, [0.0015, -0.00065, 0.1137], atol=1e-6)

    def test_jacobian_is_the_derivative_of_the_flange(self) -> None:
        arm = Arm(read_scene(CONTROL, []))
        for joint in range(7):
            step = 1e-6 * np.eye(7)[joint]
            before, after = (arm.model.flange(arm.q + sign * step)[0] for sign in (-1, 1))
            linear = (after.position - before.position) / 2e-6
            np.testing.assert_allclose(linear, arm.jacobian[:3, joint], atol=1e-7)

    def test_follows_the_motion_of_the_scene(self) -> None:
        scene = read_scene(POSES, [])
        arm, most = Arm(scene), 0.0
        first = arm.grasp_in_object().position
        for tick in range(5000):
            arm.step(1e-3 * tick, 1e-3)
            wanted = first + motion_at(scene, 1e-3 * (tick + 1))[0]
            most = max(most, float(np.linalg.norm(arm.grasp_in_object().position - wanted)))
        self.assertGreater(np.linalg.norm(arm.grasp_in_object().position - first), 0.07)
        self.assertLess(most, 1e-3)

    def test_stops_without_commands_and_keeps_its_limits(self) -> None:
        arm = Arm(read_scene(CONTROL, []))
        arm.command_twist(np.array([0.1, 0, 0, 0, 0, 0]))
        rates = []
        for tick in range(400):
            before = arm.dq
            arm.step(1e-3 * tick, 1e-3)
            rates.append(np.abs(arm.dq - before).max() / 1e-3)
            if tick == 90:
                np.testing.assert_allclose(arm.V_WE[:3], [0.1, 0, 0], atol=1e-3)
        self.assertLessEqual(max(rates), 15 + 1e-9)
        np.testing.assert_allclose(arm.V_WE, 0, atol=1e-12)


class Sensors(unittest.TestCase):
    def test_a_hand_at_rest_reads_its_weight_and_what_it_carries(self) -> None:
        scene = read_scene(CONTROL, ["sensors.force_torque.force={step: 0, noise: 0, drift: 0}",
                                     "sensors.force_torque.torque={step: 0, noise: 0, drift: 0}",
                                     "sensors.force_torque.delay=0"])  # fmt: skip
        arm = Arm(scene)
        lifted = np.array([0, 0, 2.0, 0, 0, 0])  # of the hand on the object at G, in O
        readings = SensorSuite(scene, arm).sample(0, 0, lifted)
        (message,) = [each.message for each in readings if each.channel == "FT_WRENCH"]
        X_WS = arm.X_WE @ arm.model.X_ES
        force = X_WS.rotation @ message.wrench[:3]
        np.testing.assert_allclose(force, [0, 0, 4.8 * 9.81 + 2.0], atol=1e-6)
        p_WG = arm.X_WE.of(scene.X_EG.position)
        p_WC = X_WS.of(arm.model.payload.centre)
        torque = np.cross(p_WC - X_WS.position, [0, 0, 4.8 * 9.81])
        torque = torque + np.cross(p_WG - X_WS.position, [0, 0, 2.0])
        np.testing.assert_allclose(X_WS.rotation @ message.wrench[3:], torque, atol=1e-6)

    def test_a_signal_has_noise_bias_and_steps(self) -> None:
        errors = {"step": 0.5, "noise": 2.0, "drift": 0.0, "hysteresis": 0.0}
        signal = Signal(errors, 100, [1.0], np.random.default_rng(1))
        samples = np.array([signal.measure(np.zeros(1))[0] for _ in range(4000)])
        self.assertAlmostEqual(samples.mean(), 1, delta=0.15)
        self.assertAlmostEqual(samples.std(), 2, delta=0.1)
        np.testing.assert_array_equal(samples, np.round(2 * samples) / 2)


class Meshes(unittest.TestCase):
    def closed(self, nodes: np.ndarray, triangles: np.ndarray) -> float:
        """Volume within the surface, m^3, by the divergence theorem."""
        a, b, c = (nodes[triangles[:, i]] for i in range(3))
        np.testing.assert_allclose(np.cross(b - a, c - a).sum(axis=0), 0, atol=1e-12)
        return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)

    def test_tetrahedra_fill_a_box(self) -> None:
        borders = [graded_borders(0.5, 7, [0.45]), np.linspace(0, 0.06, 4), np.linspace(0, 0.04, 3)]
        mesh = box_of_tetrahedra(borders)
        self.assertTrue((volumes(mesh.nodes, mesh.elements) > 0).all())
        self.assertAlmostEqual(volumes(mesh.nodes, mesh.elements).sum(), 0.5 * 0.06 * 0.04)
        self.assertAlmostEqual(self.closed(mesh.nodes, mesh.triangles), 0.5 * 0.06 * 0.04)
        self.assertTrue(np.isclose(mesh.nodes[:, 0], 0.45).any())

    def test_hexahedra_fill_the_cells_that_are_marked(self) -> None:
        filled = np.ones((3, 2, 2), bool)
        filled[1:, :, 1] = False
        mesh, used = hexahedra([np.linspace(0, 1, n + 1) for n in filled.shape], filled)
        self.assertAlmostEqual(self.closed(mesh.nodes, mesh.triangles), filled.mean())
        self.assertEqual(len(used), len(mesh.nodes))
        self.assertEqual(len(mesh.elements), filled.sum())


class Plants(unittest.TestCase):
    """A bar without weight and lateral contraction, stretched by 1 %."""

    SETS = ["object.gravity=false", "object.material.poisson_ratio=0"]
    CELLS = {"drake": [10, 2, 2], "mujoco": [10, 1, 1]}

    def scene(self, *more: str) -> Scene:
        return read_scene(CONTROL, [*self.SETS, *more])

    def test_stretched_bar_has_the_force_and_shape_of_its_modulus(self) -> None:
        X_OG = Pose(np.eye(3), np.array([0.47, 0.03, 0.01]))
        for world, cells in self.CELLS.items():
            plant = make_plant(world, self.scene(), X_OG, cells, 0.01, 0.1)
            for step in range(200):
                x = 0.47 + 0.0045 * min(1, step / 50)
                plant.step(Pose(np.eye(3), np.array([x, 0.03, 0.01])))
            force = 30e3 * 0.06**2 * 0.01
            expected = [force, 0, 0, 0, 0.02 * force, 0]  # about G, 20 mm below the middle
            np.testing.assert_allclose(
                plant.hand_wrench, expected, atol=0.01 * force, err_msg=world
            )
            stretched = plant.mesh.nodes[:, 0] + 0.01 * np.minimum(plant.mesh.nodes[:, 0], 0.45)
            np.testing.assert_allclose(plant.positions[:, 0], stretched, atol=2e-5, err_msg=world)

    def test_hand_and_clamp_share_the_weight(self) -> None:
        """A bar that hangs between both by its own weight: half each, by symmetry."""
        sets = ["object.gravity=true", "object.material.young_modulus=3e6",
                "object.clamp_box={lower: [0, 0, 0], upper: [0.05, 0.06, 0.06]}"]  # fmt: skip
        X_OG = Pose(np.eye(3), np.array([0.47, 0.03, 0.03]))
        for world, cells in self.CELLS.items():
            plant = make_plant(world, self.scene(*sets), X_OG, cells, 0.002, 0.01)
            for _ in range(300):
                plant.step(X_OG)
            half = 26 * 0.5 * 0.06**2 * 9.81 / 2
            self.assertAlmostEqual(plant.hand_wrench[2], half, delta=0.01 * half, msg=world)

    def test_every_kind_of_obstacle_holds_a_bar_up(self) -> None:
        """Pressed 5 mm down onto its top, 1 mm below the bar; half spaces: process.worlds."""
        place = "pose: {position: [1.16, 0, %g]}"  # in W; the bar's lower side is at 0.28
        obstacles = (
            "shape: box, size: [0.2, 0.2, 0.02], " + place % 0.269,
            "shape: sphere, radius: 0.1, " + place % 0.179,
            "shape: cylinder, radius: 0.1, length: 0.02, " + place % 0.269,
            "shape: capsule, radius: 0.1, length: 0.1, " + place % 0.129,
        )
        start, end = np.array([0.47, 0.03, 0.03]), np.array([0.47, 0.03, 0.025])
        for text in obstacles:
            scene = self.scene(f"obstacles=[{{{text}}}]")
            for world, cells in self.CELLS.items():
                if world == "drake" and "shape: box" not in text:
                    continue  # takes long; Drake touches each by its triangles
                plant = make_plant(world, scene, Pose(np.eye(3), start), cells, 0.01, 0.1)
                for step in range(60):
                    share = min(1, step / 30)
                    plant.step(Pose(np.eye(3), start + share * (end - start)))
                depth = penetrations(scene.obstacles, plant.positions)[0]
                middle = np.abs(plant.mesh.nodes[:, 0] - 0.2) < 0.026
                raised = plant.positions[middle, 2].min() + 0.001
                self.assertLess(depth, 5e-4, f"{world}, {text}")
                self.assertGreater(raised, -5e-4, f"{world}, {text}")  # without: -1.1e-3
                self.assertLess(plant.hand_wrench[2], 0, f"{world}, {text}")

    def test_a_mesh_file_is_taken(self) -> None:
        import meshio

        box = box_of_tetrahedra(
            [np.linspace(0, side, n + 1) for side, n in ((0.5, 10), (0.06, 2), (0.06, 2))]
        )
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "bar.msh"
            meshio.Mesh(box.nodes, [("tetra", box.elements)]).write(file, file_format="gmsh")
            scene = self.scene(f"object.mesh={file}")
            X_OG = Pose(np.eye(3), np.array([0.47, 0.03, 0.03]))
            for world in self.CELLS:
                plant = make_plant(world, scene, X_OG, [10, 2, 2], 0.01, 0.1)
                lower, upper = plant.mesh.nodes.min(axis=0), plant.mesh.nodes.max(axis=0)
                np.testing.assert_allclose(upper - lower, [0.5, 0.06, 0.06], atol=1e-9)
                plant.step(X_OG)
                self.assertTrue(np.isfinite(plant.positions).all())


if __name__ == "__main__":
    unittest.main()
