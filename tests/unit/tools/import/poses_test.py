"""Poses as recordings write them: rotation vectors, quaternions in either order, matrices, joint angles; presets with such poses."""

import sys
import unittest

from support import SOURCE, URDF, ImportTest

import numpy as np
import yaml

from palpate_common.joint_tree import read_joint_tree
from palpate_common.rotations import exp_rotation, exp_rotations, from_wxyz, to_wxyz
from palpate_import.chain import chain_motion

sys.path.append(str(SOURCE / "tools/see"))
from palpate_see.kinematics import link_poses  # noqa: E402

COUNT = 5


def drawn(seed=1):
    """Positions (n, 3), m, and rotations (n, 3, 3), some of them near none and near half a turn."""
    random = np.random.default_rng(seed)
    vectors = random.normal(size=(COUNT, 3))
    vectors[0] *= 1e-9
    vectors[1] *= (np.pi - 1e-7) / np.linalg.norm(vectors[1])
    return random.normal(size=(COUNT, 3)), np.array([exp_rotation(v) for v in vectors]), vectors


def flange():
    """The last link before the hand."""
    tree = read_joint_tree(URDF)
    return next(joint.child for joint in tree.joints if len(tree.arm_joints(joint.child)) == 7)


class Poses(ImportTest):
    def write_columns(self, columns):
        table = np.column_stack([np.arange(COUNT) * 0.01, *columns.values()])
        self.write(",".join(["t", *columns]) + "\n" + "\n".join(",".join(repr(float(v)) for v in row) for row in table) + "\n")

    def described(self, **stream):
        self.write(yaml.safe_dump({"streams": [{"channel": "CHANNEL", "format": "robot_state", **stream}]}), "map.yaml")
        return [self.csv, "--map", self.folder / "map.yaml"]

    def check(self, messages, position, rotation):
        np.testing.assert_allclose([m.position for m in messages], position, atol=1e-13)
        np.testing.assert_allclose(from_wxyz([m.quaternion for m in messages]), rotation, atol=1e-13)

    def test_all_forms_agree(self):
        position, rotation, vectors = drawn()
        columns = {f"p{i}": position[:, i] for i in range(3)} | {f"r{i}": np.degrees(vectors[:, i]) for i in range(3)}
        columns |= {f"q{i}": to_wxyz(rotation)[:, i] for i in range(4)}
        matrices = np.zeros((COUNT, 4, 4))
        matrices[:, :3, :3], matrices[:, :3, 3], matrices[:, 3, 3] = rotation, position, 1
        columns |= {f"m{i}": np.swapaxes(matrices, 1, 2).reshape(-1, 16)[:, i] for i in range(16)}
        self.write_columns(columns)
        p = ["p0", "p1", "p2"]
        for form in ({"rotation_vector": ["r0:deg", "r1:deg", "r2:deg"], "position": p}, {"quaternion": "q{0..3}", "position": "p{0..2}"},
                     {"quaternion": ["q1", "q2", "q3", "q0"], "order": "xyzw", "position": p}, {"matrix": "m{0..15}"},
                     {"matrix": [f"m{4 * (i % 4) + i // 4}" for i in range(16)], "order": "row_major"}):  # fmt: skip
            self.check(self.messages(*self.described(pose=form)), position, rotation)
        self.log.unlink()
        self.assertIn("in.csv:2: the matrix", self.refused(*self.described(pose={"matrix": "m{0..15}", "order": "row_major"})))
        for form, expected in [({"matrix": "m{0..11}"}, "pose.matrix: 12 entries; allowed: 16"), ({"position": p}, "allowed: one of quaternion"),
                               ({"quaternion": "q{0..3}"}, "pose.position: is absent"),
                               ({"quaternion": "q{0..3}", "position": p, "order": "zyxw"}, "pose.order: zyxw; allowed: wxyz, xyzw")]:  # fmt: skip
            self.assertIn(expected, self.refused(*self.described(pose=form), code=78))
        self.assertIn("no column 'q4'", self.refused(*self.described(pose={"quaternion": "q{1..4}", "position": p})))
        both = self.described(pose={"matrix": "m{0..15}"}, columns={"px": "p0"})
        self.assertIn("field px is given in addition to the key pose", self.refused(*both, code=78))

    def test_what_is_recorded_need_not_be_the_flange(self):
        position, rotation, vectors = drawn()
        inner_R, inner_p = exp_rotation(np.array([0.3, -0.2, 0.9])), np.array([0.01, -0.02, 0.2])
        recorded_p, recorded_R = position + rotation @ inner_p, rotation @ inner_R
        twist = np.random.default_rng(2).normal(size=(COUNT, 6))  # of the flange
        at_point = twist[:, :3] + np.cross(twist[:, 3:], rotation @ inner_p)
        columns = {f"p{i}": recorded_p[:, i] for i in range(3)} | {f"q{i}": to_wxyz(recorded_R)[:, i] for i in range(4)}
        columns |= {f"v{axis}": at_point[:, i] for i, axis in enumerate("xyz")} | {
            f"w{axis}": twist[:, 3 + i] for i, axis in enumerate("xyz")
        }
        self.write_columns(columns)
        form = {"quaternion": "q{0..3}", "position": "p{0..2}",
                "in_flange": {"position": inner_p.tolist(), "quaternion": to_wxyz(inner_R).tolist()}}  # fmt: skip
        made = self.messages(*self.described(pose=form))
        self.check(made, position, rotation)
        np.testing.assert_allclose([m.twist for m in made], twist, atol=1e-13)

    def test_joint_angles_and_speeds(self):
        tree, link = read_joint_tree(URDF), flange()
        random = np.random.default_rng(3)
        q, dq = random.uniform(-2, 2, (COUNT, 7)), random.normal(size=(COUNT, 7))
        self.write_columns({f"j{i}": np.degrees(q[:, i]) for i in range(7)} | {f"s{i}": dq[:, i] for i in range(7)})
        form = {"joints": [f"j{i}:deg" for i in range(7)], "speeds": "s{0..6}"}
        words = self.described(pose=form, columns={"q{1..7}": "j{0..6}:deg", "dq{1..7}": "s{0..6}"})
        self.assertIn("pose.joints: needs a URDF file", self.refused(*words, code=78))
        self.assertIn("allowed: ", self.refused(*words, "--urdf", URDF, "--flange", "no_link"))
        made = self.messages(*words, "--urdf", URDF, "--flange", link)
        poses = [link_poses(tree, dict(zip(tree.arm_joints(link), row)))[link] for row in q]
        self.check(made, [pose.p for pose in poses], [pose.R for pose in poses])
        step = 1e-6
        for row, rate, message in zip(q, dq, made):
            p, R, _ = chain_motion(tree, link, np.array([row - step * rate, row + step * rate]), None)
            turned = R[1] @ R[0].T
            angular = np.array([turned[2, 1] - turned[1, 2], turned[0, 2] - turned[2, 0], turned[1, 0] - turned[0, 1]]) / (
                4 * step
            )
            np.testing.assert_allclose(message.twist, [*((p[1] - p[0]) / (2 * step)), *angular], atol=1e-8)
            np.testing.assert_allclose(message.q[:7], row, atol=1e-13)

    def test_wrenches_in_the_axes_of_the_base(self):
        _, rotation, vectors = drawn()
        wrench = np.random.default_rng(4).normal(size=(COUNT, 6))
        base = np.einsum("nij,nkj->nki", rotation, wrench.reshape(-1, 2, 3)).reshape(-1, 6)
        self.write_columns({name: base[:, i] for i, name in enumerate(["fx", "fy", "fz", "tx", "ty", "tz"])}
                           | {f"r{i}": vectors[:, i] for i in range(3)})  # fmt: skip
        made = self.messages(*self.described(format="force_torque", pose={"rotation_vector": "r{0..2}"}))
        np.testing.assert_allclose([m.wrench for m in made], wrench, atol=1e-13)

    def test_fingertips(self):
        position, rotation, _ = drawn()
        self.write_columns({f"p{i}": position[:, i] for i in range(3)} | {f"q{i}": to_wxyz(rotation)[:, i] for i in range(4)})
        tip = {"quaternion": "q{0..3}", "position": "p{0..2}"}
        made = self.messages(
            *self.described(format="hand_state", fingertips=[tip, {"quaternion": [1, 0, 0, 0], "position": [0, 0, 0.1]}])
        )
        self.assertEqual({m.fingertip_count for m in made}, {2})
        np.testing.assert_allclose([m.fingertip_position[0] for m in made], position, atol=1e-15)
        self.assertEqual((made[0].fingertip_position[1], made[0].fingertip_quaternion[1]), ((0, 0, 0.1), (1, 0, 0, 0)))

    def test_many_rotations_at_once(self):
        vectors = np.random.default_rng(5).normal(size=(50, 3)) * np.logspace(-12, 0.5, 50)[:, None]
        np.testing.assert_allclose(exp_rotations(vectors), [exp_rotation(v) for v in vectors], atol=2e-15)


class Presets(ImportTest):
    def table(self, names, values, delimiter=","):
        self.write(
            delimiter.join(names) + "\n" + "\n".join(delimiter.join(repr(float(v)) for v in row) for row in values) + "\n"
        )

    def test_ur_rtde(self):
        position, rotation, vectors = drawn()
        random = np.random.default_rng(6)
        values = {"timestamp": 100 + np.arange(COUNT) * 0.002}
        for name, numbers in (("actual_q", random.normal(size=(COUNT, 6))), ("actual_qd", random.normal(size=(COUNT, 6))),
                              ("actual_TCP_pose", np.hstack([position, vectors])), ("actual_TCP_speed", random.normal(size=(COUNT, 6))),
                              ("ft_raw_wrench", random.normal(size=(COUNT, 6)))):  # fmt: skip
            values |= {f"{name}_{i}": numbers[:, i] for i in range(6)}
        for delimiter in ", ":  # of ur_rtde, and of the maker's record.py
            self.table(list(values), np.column_stack(list(values.values())), delimiter)
            made = self.imported(self.csv, "--preset", "ur_rtde")
            utime, state = made["ROBOT_STATE"][1]
            self.assertEqual((utime, state.joint_count), (100002000, 6))
            np.testing.assert_allclose(from_wxyz(state.quaternion), rotation[1], atol=1e-13)
            self.assertEqual(state.twist[5], values["actual_TCP_speed_5"][1])
            self.assertEqual(made["FT_WRENCH"][1][1].wrench[2], -values["ft_raw_wrench_2"][1])
        few = [name for name in values if not name.startswith(("ft_raw", "actual_qd"))]
        self.table(few, np.column_stack([values[name] for name in few]))
        self.assertEqual(list(self.imported(self.csv, "--preset", "ur_rtde")), ["ROBOT_STATE"])
        self.assertIn("without FT_WRENCH: no ft_raw_wrench_0", self.said)

    def test_libfranka(self):
        q = np.random.default_rng(7).normal(size=(COUNT, 7))
        names = [
            "time",
            " success_rate",
            *(f" state.{name}[{i}]" for name in ("q", "q_d", "dq", "dq_d", "tau_J") for i in range(7)),
        ]
        self.table(names, np.column_stack([np.arange(COUNT), np.ones(COUNT), q, q, 0 * q, 0 * q, 10 * q]))
        made = self.imported(self.csv, "--preset", "libfranka", "--urdf", URDF, "--flange", flange())["ROBOT_STATE"]
        self.assertEqual((made[2][0], made[2][1].joint_count, made[2][1].tau[6]), (2000, 7, 10 * q[2, 6]))
        np.testing.assert_allclose(
            made[2][1].position, chain_motion(read_joint_tree(URDF), flange(), q, None)[0][2], atol=1e-13
        )

    def test_drake_iiwa(self):
        q = np.random.default_rng(8).normal(size=(COUNT, 7))
        names = ["received_utime", *(f"{name}[{i}]" for name in ("joint_position_measured", "joint_velocity_estimated", "joint_torque_measured")
                            for i in range(7))]  # fmt: skip
        self.table(names, np.column_stack([5e6 + 5000 * np.arange(COUNT), q, 0 * q, 2 * q]))
        self.csv.rename(self.folder / "IIWA_STATUS.csv")
        made = self.imported(self.folder, "--preset", "drake_iiwa", "--urdf", URDF, "--flange", flange())["ROBOT_STATE"]
        self.assertEqual((made[1][0], made[1][1].q[6], made[1][1].tau[0]), (5005000, q[1, 6], 2 * q[1, 0]))

    def test_can_be_printed(self):
        self.assertEqual(self.run_program("--show-preset", "ur_rtde"), 0)
        self.assertIn("actual_TCP_pose", self.said)


if __name__ == "__main__":
    unittest.main(verbosity=2)
