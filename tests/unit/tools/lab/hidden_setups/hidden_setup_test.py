"""Drawn set-ups: the same for a seed, within their limits, over their whole range, and the truth is that of the scene."""

import json
import os
import pathlib
import sys
import tempfile
import unittest

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
SOURCE = pathlib.Path(os.environ["PALPATE_SOURCE_DIR"])
sys.path[:0] = [str(SOURCE / "tools" / folder) for folder in ("lab/hidden_setups", "lab/see", "common")]

import numpy as np  # noqa: E402
from hidden_setup import draw_setup  # noqa: E402
from robot_bodies import Model  # noqa: E402  (kinematics of its own)
from scipy.spatial.transform import Rotation  # noqa: E402
from scipy.stats import kstest  # noqa: E402

from palpate_common.input_error import InputError  # noqa: E402
from palpate_common.section import read_configuration_section  # noqa: E402

SCENE = SOURCE / "sim/scenes/bar_setup.yaml"
URDF = SOURCE / "sim/robot/lwr_hand.urdf"
CENTRE = np.array([0.1, 0.03, 0.03])  # of the object, in O


def rotation(pose):
    w, x, y, z = pose["quaternion"]
    return Rotation.from_quat([x, y, z, w])


def turned(moment):
    xx, xy, xz, yy, yz, zz = moment
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


class Drawn(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.setups = [draw_setup(SCENE, "setup", seed) for seed in range(1000, 1060)]

    def test_a_seed_gives_the_same_files_and_another_seed_others(self):
        texts = []
        for seed in (1000, 1000, 1001):
            with tempfile.TemporaryDirectory() as name:
                draw_setup(SCENE, "setup", seed).write(pathlib.Path(name) / "drawn")
                texts.append([(pathlib.Path(name) / "drawn" / file).read_text() for file in ("scene.yaml", "truth.json")])
        # The folder's name is part of the path to the base.
        self.assertEqual([text.splitlines()[2:] for text in texts[0]], [text.splitlines()[2:] for text in texts[1]])
        self.assertNotEqual(texts[0][1], texts[2][1])

    def test_every_number_is_within_its_limits_and_all_of_them_are_reached(self):
        shares = {}
        for setup in self.setups:
            for row in setup.truth["drawn"]:
                self.assertLessEqual(row["lower"], row["value"], row)
                self.assertLessEqual(row["value"], row["upper"], row)
                ends = [row["lower"], row["value"], row["upper"]]
                low, value, high = np.log(ends) if row["name"] == "modulus factor" else ends
                shares.setdefault(row["name"], []).append((value - low) / (high - low))
        self.assertGreater(len(shares), 25)
        for name, values in shares.items():  # one of some thirty tests fails by chance once in 3e4 sets of seeds
            self.assertGreater(kstest(values, "uniform").pvalue, 1e-6, name)

    def test_pose_modulus_and_camera_keep_what_the_distribution_says(self):
        top = read_configuration_section(SCENE)
        guess = np.array(top.section("object").section("pose").values["position"])
        R_guess = Rotation.from_euler("z", np.pi)
        for setup in self.setups:
            truth = setup.truth
            R, p = rotation(truth["object_in_base"]), np.array(truth["object_in_base"]["position"])
            off = R.apply(CENTRE) + p - (R_guess.apply(CENTRE) + guess)
            self.assertLessEqual(np.abs(off).max(), 0.05)
            self.assertLessEqual((R * R_guess.inv()).magnitude(), np.radians(20) + 1e-9)
            self.assertTrue(30e3 <= truth["young_modulus"] <= 750e3)
            eye = np.array(truth["camera_in_base"]["position"])
            self.assertAlmostEqual(float(np.linalg.norm(eye - [1.0, -0.7, 0.8])), 0.02, places=9)
            straight = rotation(truth["camera_in_base"]).apply([0, 0, 1])
            nominal = np.array([0, 0.7, -0.5]) / np.hypot(0.7, 0.5)
            self.assertLess(np.degrees(np.arccos(straight @ nominal)), 2.001)

    def test_the_scene_states_the_truth(self):
        for setup in self.setups[:5]:
            with tempfile.TemporaryDirectory() as name:
                folder = pathlib.Path(name)
                setup.write(folder)
                scene = read_configuration_section(folder / "scene.yaml")
                truth = json.loads((folder / "truth.json").read_text())
            sensors = scene.section("sensors")
            for sensor in ("force_torque", "imu", "camera"):
                section = sensors.section(sensor)
                late = truth["stamp_delay"][sensor]
                self.assertEqual(section.values["stamp_delay"], late)
                self.assertGreater(section.values["delay"], late)  # no message states a time at which it was not there
            self.assertEqual(sensors.section("force_torque").values["bias"], truth["bias"])
            for key, sensor, straight in (("sensor_in_flange", "force_torque", Rotation.identity()),
                                          ("imu_in_flange", "imu", Rotation.from_euler("z", 90, degrees=True))):
                error = Rotation.from_rotvec(sensors.section(sensor).values["mounting_rotation_deg"], degrees=True)
                self.assertLess((rotation(truth[key]).inv() * straight * error).magnitude(), 1e-9)
                self.assertLessEqual(error.magnitude(), np.radians(3) + 1e-9)
            np.testing.assert_allclose(truth["imu_in_flange"]["position"], [0, 0.055, 0.1], atol=1e-12)
            np.testing.assert_allclose(truth["sensor_in_flange"]["position"], [0, 0, 0.04], atol=1e-12)
            pose = scene.section("object").section("pose").values
            R = Rotation.from_euler("xyz", pose["rpy_deg"], degrees=True)
            self.assertLess((R.inv() * rotation(truth["object_in_base"])).magnitude(), 1e-9)
            camera = scene.section("camera")
            self.assertFalse(camera.has("eye") or camera.has("target"))

    def test_the_payload_is_the_sum_over_points_of_mass(self):
        """Each link as six points of mass with its mass, centre and inertia, placed by another reader of the URDF."""
        model = Model(URDF)
        R_S, p_S = model.pose("sensor", {})
        scene = read_configuration_section(SCENE).section("robot")
        angles = dict(scene.values["initial_hand"])
        masses, places = [], []
        for link in model._root.iter("link"):
            inertial = link.find("inertial")
            if inertial is None or not self._is_beyond_the_sensor(model, link.get("name")):
                continue
            i = {key: float(value) for key, value in inertial.find("inertia").attrib.items()}
            self._add(masses, places, float(inertial.find("mass").get("value")),
                      np.array([float(word) for word in inertial.find("origin").get("xyz").split()]),
                      turned([i[key] for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")]),
                      lambda points: ((points @ (pose := model.pose(link.get("name"), angles))[0].T + pose[1]) - p_S) @ R_S)
        self.assertAlmostEqual(sum(masses), 4.8, places=3)
        for setup in self.setups[:5]:
            robot, truth = setup.changes["robot"], setup.truth
            m, q = [robot["hand_mass_factor"] * mass for mass in masses], list(places)
            load = robot["load"]
            self._add(m, q, load["mass"], np.array(load["center_of_mass"]), turned(load["inertia"]), lambda points: points)
            R_LS = rotation(truth["sensor_in_flange"]).as_matrix()
            m, q = np.array(m), np.array(q) @ R_LS
            payload = truth["payload"]
            self.assertAlmostEqual(payload["mass"], m.sum(), places=9)
            np.testing.assert_allclose(payload["center_of_mass"], m @ q / m.sum(), atol=1e-9)
            squares = (q**2).sum(axis=1)
            inertia = (m * squares).sum() * np.eye(3) - np.einsum("n,ni,nj->ij", m, q, q)
            np.testing.assert_allclose(turned(payload["inertia"]), inertia, atol=1e-9)

    @staticmethod
    def _is_beyond_the_sensor(model, link):
        while link in model._joints and link != "sensor":
            link = model._joints[link].find("parent").get("link")
        return link == "sensor"

    @staticmethod
    def _add(masses, places, mass, centre, moment, placed):
        values, axes = np.linalg.eigh(moment)
        squares = 0.5 * values.sum() - values  # second moments of the mass along the principal axes
        for axis, square in zip(axes.T, squares):
            arm = np.sqrt(max(3 * square / mass, 0))
            for side in (-1, 1):
                masses.append(mass / 6)
                places.append(placed((centre + side * arm * axis)[None])[0])


class Wrong(unittest.TestCase):
    def test_distributions_are_checked(self):
        text = (SOURCE / "tools/lab/hidden_setups/setup.yaml").read_text()
        for before, after, said in (("angle_deg: 20", "angle_deg: 200", "object.angle_deg: 200"),
                                    ("[0.3, 1.2]", "[1.2, 0.3]", "payload.hand_mass_factor"),
                                    ("distance: 0.02", "distanse: 0.02", "camera.distance"),
                                    ("upper: [0.03, 0.03", "upper: [-0.04, 0.03", "payload.center.lower")):
            with tempfile.TemporaryDirectory() as name:
                file = pathlib.Path(name) / "other.yaml"
                file.write_text(text.replace(before, after))
                with self.assertRaises(InputError) as caught:
                    draw_setup(SCENE, str(file), 1000)
                self.assertIn(said, str(caught.exception))
                self.assertIn("other.yaml", str(caught.exception))

    def test_a_scene_without_a_camera_has_none_drawn(self):
        truth = draw_setup(SOURCE / "sim/scenes/bar_long_soft_control.yaml", "setup", 1000).truth
        self.assertNotIn("camera_in_base", truth)
        self.assertNotIn("camera", truth["stamp_delay"])
        with_camera = draw_setup(SCENE, "setup", 1000).truth
        self.assertEqual(truth["bias"], with_camera["bias"])  # what is left out changes nothing else


if __name__ == "__main__":
    unittest.main()
