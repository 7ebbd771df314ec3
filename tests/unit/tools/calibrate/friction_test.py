"""Dynamics from a URDF are those of textbooks; friction is found within its intervals, whatever the offsets of the torques."""

import tempfile
import unittest
from pathlib import Path

import support
import numpy as np

from palpate_calibrate.friction.arm_dynamics import Body, read_arm
from palpate_calibrate.friction.friction_fit import COULOMB, OFFSET, VISCOUS, Torques, coulomb_shares, fit_friction
from palpate_calibrate.friction.output import section, table
from palpate_common.input_error import InputError

GRAVITY = np.array([0, -9.81, 0])
TWO_LINKS = """<robot name="two"><link name="base"/>
<joint name="a" type="revolute"><parent link="base"/><child link="one"/><axis xyz="0 0 1"/></joint>
<link name="one"><inertial><origin xyz="0.2 0 0"/><mass value="3"/>
<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0.05"/></inertial></link>
<joint name="b" type="revolute"><origin xyz="0.4 0 0"/><parent link="one"/><child link="flange"/><axis xyz="0 0 1"/></joint>
<link name="flange"/>
<joint name="c" type="fixed"><origin xyz="0.1 0 0" rpy="0 0 1"/><parent link="flange"/><child link="hand"/></joint>
<link name="hand"><inertial><origin rpy="0.3 0.2 0.1" xyz="0.05 0 0"/><mass value="2"/>
<inertia ixx="0.03" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.03"/></inertial></link></robot>"""


def two_links(load=None):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "two.urdf"
        path.write_text(TWO_LINKS)
        return read_arm(path, "flange", GRAVITY, load)


def reported(seconds=24, coulomb=(1.2, 0.6), viscous=(0.8, 0.3), offset=(0.5, -0.2), moves=(True, True), seed=1):
    """Torques of a motion to and fro, with friction after Dahl (1968) and the noise of a good arm."""
    arm, random = two_links(), np.random.default_rng(seed)
    time = np.arange(0, seconds, 2e-3)
    q, dq = np.empty((len(time), 2)), np.empty((len(time), 2))
    for i in range(2):
        slow, fast = (0.5 + 0.13 * i, 2.1 - 0.3 * i)
        q[:, i] = moves[i] * (0.6 * np.sin(slow * time + i) + 0.15 * np.sin(fast * time))
        dq[:, i] = moves[i] * (0.6 * slow * np.cos(slow * time + i) + 0.15 * fast * np.cos(fast * time))
    momentum, coriolis, gravity = arm.evaluate(q, dq)
    share, shares = np.zeros(2), []
    for step in np.diff(q, axis=0, prepend=q[:1]):
        end = np.sign(step)
        share = end + (share - end) * np.exp(-np.abs(step) / 4e-4)
        shares.append(share)
    tau = np.gradient(momentum, time, axis=0) - coriolis + gravity + coulomb * np.array(shares) + viscous * dq + offset
    return Torques("motion", time, q + random.normal(0, 5e-6, q.shape), dq + random.normal(0, 5e-4, q.shape),
                   tau + random.normal(0, 0.05, q.shape)), arm  # fmt: skip


class Dynamics(unittest.TestCase):
    def test_of_two_links_are_those_of_textbooks(self):
        a, b, da, db = 0.6, -1.1, 0.9, -1.7
        momentum, coriolis, gravity = two_links().evaluate(np.array([[a, b]]), np.array([[da, db]]))
        # centre of the hand in the second link: 0.1 m, and 0.05 m turned by 1 rad
        x, y = 0.1 + 0.05 * np.cos(1), 0.05 * np.sin(1)
        reach, turn = np.hypot(x, y), b + np.arctan2(y, x)
        m22, coupled = 0.03 + 2 * reach**2, 2 * 0.4 * reach
        m12 = m22 + coupled * np.cos(turn)
        m11 = 0.05 + 3 * 0.2**2 + 2 * 0.4**2 + m22 + 2 * coupled * np.cos(turn)
        np.testing.assert_allclose(momentum[0], [m11 * da + m12 * db, m12 * da + m22 * db], atol=1e-12)
        h = -coupled * np.sin(turn)
        np.testing.assert_allclose(coriolis[0], [0, h * (da + db) * da], atol=1e-12)
        lower = 2 * reach * 9.81 * np.cos(a + turn)
        np.testing.assert_allclose(gravity[0], [(3 * 0.2 + 2 * 0.4) * 9.81 * np.cos(a) + lower, lower], atol=1e-12)

    def test_a_stated_load_replaces_that_of_the_file(self):
        q, none = np.array([[0.0, 0.0]]), np.zeros((1, 2))
        gravity = two_links(Body(1.0, np.array([0.3, 0, 0]), np.zeros((3, 3)))).evaluate(q, none)[2]
        np.testing.assert_allclose(gravity[0], [(3 * 0.2 + 0.4 + 0.3) * 9.81, 0.3 * 9.81])


class Friction(unittest.TestCase):
    def test_is_found_within_its_intervals_with_offsets_of_the_torques(self):
        fit = fit_friction(*reported())
        self.assertTrue(fit.is_determined().all())
        for column, truth, widest in ((COULOMB, (1.2, 0.6), 0.05), (VISCOUS, (0.8, 0.3), 0.1), (OFFSET, (0.5, -0.2), 0.5)):
            errors = np.abs(fit.values[:, column] - truth)
            self.assertTrue((errors < 1.5 * fit.half_width[:, column]).all(), (column, errors, fit.half_width[:, column]))
            self.assertTrue((errors < widest).all(), (column, errors))
        self.assertLess(abs(np.log(fit.presliding / 4e-4)), np.log(1.6))
        self.assertTrue(((0.005 < fit.noise) & (fit.noise < 0.1)).all(), fit.noise)
        written = section(fit)
        self.assertEqual(len(written["friction"]["coulomb"]), 2)
        self.assertLess(written["friction"]["error"], 0.05)
        self.assertIn("presliding 0.0", table(fit))

    def test_an_arm_without_friction_has_none(self):
        fit = fit_friction(*reported(coulomb=(0, 0), viscous=(0, 0)))
        self.assertLess(fit.values[:, COULOMB].max(), 0.03)
        self.assertLess(fit.values[:, VISCOUS].max(), 0.06)

    def test_a_joint_that_does_not_move_is_named(self):
        with self.assertRaisesRegex(InputError, "joint 2 .* to and fro"):
            fit_friction(*reported(moves=(True, False)))

    def test_a_short_recording_is_refused(self):
        with self.assertRaisesRegex(InputError, "5.0 s; allowed: 17 s"):
            fit_friction(*reported(seconds=5))

    def test_a_share_is_unknown_until_the_joint_has_moved_and_stays_at_rest(self):
        q = np.concatenate([np.zeros(5), np.linspace(0, 2e-3, 20), np.full(5, 2e-3)])[:, None]
        shares = coulomb_shares(q, np.array([3e-4]))[0]
        self.assertTrue(np.isnan(shares[:6]).all())
        np.testing.assert_allclose(shares[-6:], 1)


if __name__ == "__main__":
    unittest.main()
