"""The robot's geometry: URDF, kinematics compared with another calculation, distances, joint states."""
import pathlib
import tempfile
import unittest

import support

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from palpate_common.input_error import InputError
from palpate_common.pose import Pose
from palpate_common.rotations import exp_rotation
from palpate_common.section import read_section
from palpate_common.surface import box_surface
from palpate_see.joint_track import JointTrack
from palpate_see.kinematics import link_poses
from palpate_see.robot_body import RobotBody, read_robot_options
from palpate_see.shapes import Box, Capsule, Cylinder, HalfSpace, Mesh, PlacedShape, Sphere, within
from palpate_see.urdf import read_robot

RANDOM = np.random.default_rng(5)
POINTS = RANDOM.uniform(-0.5, 0.5, (300, 3))


def exponential_pose(screws, end, angles):
    """Pose of a link by the product of exponentials.

    screws: (axis, point on it) of each joint in W at zero. end: pose at zero.
    """
    X = np.array(end, float)
    for (axis, point), angle in reversed(list(zip(screws, angles))):
        R = Rotation.from_rotvec(angle * np.array(axis, float)).as_matrix()
        point = np.array(point, float)
        X[:3, 3] = R @ (X[:3, 3] - point) + point
        X[:3, :3] = R @ X[:3, :3]
    return X


def matrix(pose):
    """(4, 4)."""
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = pose.R, pose.p
    return X


class Kinematics(unittest.TestCase):
    # Of the arm as its data sheet draws it, straight up: base to shoulder 0.3105 m, then 0.4, 0.39 and 0.078 m.
    HEIGHTS = (0.0, 0.3105, 0.0, 0.7105, 0.0, 1.1005, 0.0)
    AXES = ((0, 0, 1), (0, -1, 0), (0, 0, 1), (0, 1, 0), (0, 0, 1), (0, -1, 0), (0, 0, 1))
    SCREWS = [(axis, (0, 0, height)) for axis, height in zip(AXES, HEIGHTS)]

    def test_the_flange_by_the_product_of_exponentials(self):
        robot = read_robot(support.URDF)
        names = robot.arm_joints("flange")
        self.assertEqual(names, [f"joint_{i}" for i in range(1, 8)])
        end = np.eye(4)
        end[2, 3] = 1.1785
        for q in (np.zeros(7), *RANDOM.uniform(-2, 2, (20, 7))):
            pose = link_poses(robot, dict(zip(names, q)))["flange"]
            np.testing.assert_allclose(matrix(pose), exponential_pose(self.SCREWS, end, q), atol=1e-12)

    def test_a_fingertip_by_the_product_of_exponentials(self):
        robot = read_robot(support.URDF)
        hand = robot.hand_joints("flange")
        self.assertEqual((len(hand), hand[:4]), (20, ["ff_j4", "ff_j3", "ff_j2", "ff_j1"]))
        foot = np.array([0.037, 0.033, 1.1785 + 0.04 + 0.18])  # of the first finger in W, straight
        screws = self.SCREWS + [((1, 0, 0), foot), ((0, -1, 0), foot), ((0, -1, 0), foot + [0, 0, 0.038]),
                                ((0, -1, 0), foot + [0, 0, 0.06])]  # fmt: skip
        end = np.eye(4)
        end[:3, 3] = foot + [0, 0, 0.08]
        end[:3, :3] = Rotation.from_euler("xyz", [0, -np.pi / 2, np.pi]).as_matrix()
        for q in RANDOM.uniform(-1, 1, (10, 11)):
            angles = dict(zip(robot.arm_joints("flange") + hand[:4], q))
            tip = matrix(link_poses(robot, angles)["ff_tip"])
            np.testing.assert_allclose(tip, exponential_pose(screws, end, q), atol=1e-12)

    def test_sliding_and_mimicking_joints(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "gripper.urdf")
            path.write_text("""<robot name="g"><link name="a"/><link name="b"/><link name="c"/>
              <joint name="left" type="prismatic"><parent link="a"/><child link="b"/><axis xyz="0 2 0"/></joint>
              <joint name="right" type="prismatic"><parent link="a"/><child link="c"/><axis xyz="0 1 0"/>
                <mimic joint="left" multiplier="-1" offset="0.01"/></joint></robot>""")
            poses = link_poses(read_robot(path), {"left": 0.03})
        np.testing.assert_allclose(poses["b"].p, [0, 0.03, 0])
        np.testing.assert_allclose(poses["c"].p, [0, -0.02, 0])


class Files(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def refused(self, text, *parts):
        path = self.folder / "r.urdf"
        path.write_text(text)
        with self.assertRaises(InputError) as caught:
            read_robot(path)
        for part in ("r.urdf", *parts):
            self.assertIn(part, str(caught.exception))

    def test_what_is_wrong_is_named(self):
        links = "<link name='a'/><link name='b'/>"
        self.refused("<robot>", "no element found")
        self.refused("<sdf/>", "<sdf>", "<robot>")
        self.refused(f"<robot>{links}</robot>", "no tree")
        joint = f"<robot>{links}<joint name='j' type='fixed'><parent link='a'/><child link='b'/></joint></robot>"
        self.refused(joint.replace("fixed", "ball"), "'ball'", "revolute")
        self.refused(joint.replace("child link='b'", "child link='z'"), "'z' is missing")
        box = "<robot><link name='a'><collision><geometry><box size='1 2'/></geometry></collision></link></robot>"
        self.refused(box, "size='1 2'", "3 numbers")
        self.refused(box.replace("<box size='1 2'/>", "<cone/>"), "'cone'", "capsule")
        self.refused(box.replace("<box size='1 2'/>", "<mesh filename='no.stl'/>"), "no.stl")

    def test_collision_geometry_replaces_the_visual_one_and_meshes_are_scaled(self):
        mesh = self.folder / "meshes" / "cube.obj"
        mesh.parent.mkdir()
        surface = box_surface([1, 1, 1])
        mesh.write_text("".join(f"v {x} {y} {z}\n" for x, y, z in surface.nodes)
                        + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in surface.triangles))  # fmt: skip
        path = self.folder / "r.urdf"
        path.write_text("""<robot name="r"><link name="a">
            <visual><geometry><sphere radius="9"/></geometry></visual>
            <collision><origin xyz="0 0 1"/><geometry>
              <mesh filename="package://meshes/cube.obj" scale="0.1 0.2 0.3"/></geometry></collision></link></robot>""")
        (shape,) = read_robot(path).shapes
        np.testing.assert_allclose(shape.X_LS.p, [0, 0, 1])
        np.testing.assert_allclose(shape.shape.distance(np.array([[0.05, 0.1, 0.4], [0.05, 0.1, 0.15]])), [0.1, -0.05])


class Distances(unittest.TestCase):
    def test_each_shape_against_points_sampled_on_its_surface(self):
        angle, share = RANDOM.uniform(0, 2 * np.pi, 60000), RANDOM.uniform(-1, 1, 60000)
        circle = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(60000)])
        z = np.array([0, 0, 1.0])
        ball = np.sqrt(1 - share**2)[:, None] * circle + share[:, None] * z
        side = 0.2 * circle + 0.3 * share[:, None] * z
        caps = 0.2 * np.sqrt(np.abs(share))[:, None] * circle + 0.3 * np.sign(share)[:, None] * z
        ends = 0.2 * ball + 0.3 * np.sign(ball[:, 2:]) * z
        on_box, _ = box_surface([0.2, 0.4, 0.6]).samples(60000)
        for shape, surface in ((Sphere(0.2), 0.2 * ball), (Cylinder(0.2, 0.6), np.vstack([side, caps])),
                               (Capsule(0.2, 0.6), np.vstack([side, ends])),
                               (Box((0.2, 0.4, 0.6)), on_box - [0.1, 0.2, 0.3])):  # fmt: skip
            away, _ = cKDTree(surface).query(POINTS)
            np.testing.assert_allclose(np.abs(shape.distance(POINTS)), away, atol=6e-3, err_msg=str(shape))
            self.assertLess(shape.distance(np.zeros((1, 3)))[0], 0)
            self.assertLessEqual(np.linalg.norm(surface, axis=1).max(), shape.reach + 1e-9)

    def test_a_mesh_is_the_box_that_it_describes(self):
        mesh = Mesh(box_surface([0.2, 0.4, 0.6]))
        np.testing.assert_allclose(mesh.distance(POINTS), Box((0.2, 0.4, 0.6)).distance(POINTS - [0.1, 0.2, 0.3]), atol=1e-9)

    def test_placed_shapes_with_a_margin(self):
        X = Pose(exp_rotation(np.array([0, 0, np.pi / 2])), np.array([1.0, 0, 0]))
        points = np.array([[1, 0.5, 0], [1, 0.51, 0], [1, 0.52, 0], [1.5, 0, 0]])
        margins = np.array([0.011, 0.011, 0.011, 0.5])
        box = PlacedShape(Box((1, 0.1, 0.1)), X)
        self.assertEqual(within(points, [box], margins).tolist(), [True, True, False, True])
        below = PlacedShape(HalfSpace(), Pose(np.eye(3), np.zeros(3)))
        self.assertEqual(within(points, [below], np.zeros(4)).tolist(), [True] * 4)
        self.assertEqual(within(points, [], margins).tolist(), [False] * 4)


class Joints(unittest.TestCase):
    def test_states_are_interpolated_and_old_ones_not_used(self):
        track = JointTrack(100, None, 50)
        self.assertIsNone(track.at(0))
        track.add(1000, [0, 1])
        track.add(1100, [1, 3])
        track.add(1050, [9, 9])  # late
        np.testing.assert_allclose(track.at(1025), [0.25, 1.5])
        np.testing.assert_allclose(track.at(950), [0, 1])
        np.testing.assert_allclose(track.at(1200), [1, 3])
        self.assertIsNone(track.at(1201))
        self.assertIsNone(track.at(899))
        np.testing.assert_allclose(JointTrack(100, [5], 50).at(123456), [5])

    def test_only_the_latest_are_kept(self):
        track = JointTrack(10, None, 50)
        for i in range(1000):
            track.add(10 * i, [i])
        self.assertIsNone(track.at(100))
        np.testing.assert_allclose(track.at(9985), [998.5])

    def options(self, text):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "a.yaml")
            path.write_text(f"robot:\n  urdf: {support.URDF}\n{text}of_palpated: {{flange: sensor}}\n")
            top = read_section(path)
            return read_robot_options(top.section("robot"), top.section("of_palpated"))

    def test_names_angles_and_what_is_wrong_with_them(self):
        options = self.options("")
        self.assertEqual((len(options.arm_joints), len(options.hand_joints), options.arm_at_rest), (7, 20, None))
        self.assertEqual(self.options("  hand_joints: [ff_j4]\n  hand_at_rest: [0.1]\n").hand_at_rest, [0.1])
        for text, words in (("  arm_at_rest: [0, 1]\n", "a.yaml:3: robot.arm_at_rest: .*7 numbers"),
                            ("  margn: 1\n", "margn: is unknown"), ("  deviation: 2\n", "0 to 0.1"),
                            ("  arm_joints: [elbow]\n", "arm_joints: elbow; allowed: joint_1")):  # fmt: skip
            with self.assertRaisesRegex(InputError, words):
                self.options(text)

    def test_a_state_of_another_arm_is_an_error(self):
        body = RobotBody(self.options("  hand_joints: []\n"))
        with self.assertRaisesRegex(InputError, "ROBOT_STATE: 6 joints; .*lwr_hand.urdf has 7: joint_1"):
            body.add_arm(1, [0] * 6)
        self.assertIsNone(body.link_poses(1))
        self.assertTrue(body.add_arm(1, [0] * 7))
        np.testing.assert_allclose(body.link_poses(1)["flange"].p, [0, 0, 1.1785])

    def test_later_states_that_cannot_be_used_are_refused(self):
        body = RobotBody(self.options("  hand_joints: []\n"))
        for q in ([np.nan] * 7, [0] * 6 + [np.inf], [0] * 6 + [1001.0]):
            self.assertFalse(body.add_arm(1, q))
        self.assertIsNone(body.link_poses(1))
        self.assertTrue(body.add_arm(1, [0] * 7))
        self.assertFalse(body.add_arm(2, [0] * 6))
        np.testing.assert_allclose(body.link_poses(2)["flange"].p, [0, 0, 1.1785])


if __name__ == "__main__":
    unittest.main(verbosity=2)
