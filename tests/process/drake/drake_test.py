"""palpate-drake against Drake's own classes: drivers of a simulated iiwa and panda, types of a gripper,
and meldis.
"""

from __future__ import annotations

import json
import os
import socket
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import unittest.mock
from pathlib import Path
from typing import Optional

SOURCE = Path(os.environ["PALPATE_SOURCE_DIR"])
BIN = Path(os.environ["PALPATE_BIN_DIR"])
WORLDS = SOURCE / "tools/lab/worlds"
TYPES = SOURCE / "tools/bridge/drake/lcmtypes"
sys.path.insert(0, str(WORLDS))

import drake  # noqa: E402
import numpy as np  # noqa: E402
import palpate  # noqa: E402
from drake import lcmt_panda_status, lcmt_schunk_wsg_command, lcmt_schunk_wsg_status  # noqa: E402
from live_run import Program, private_urls  # noqa: E402
from palpate.messages import hand_command_t, hand_state_t, robot_state_t  # noqa: E402
from pydrake.lcm import DrakeLcm  # noqa: E402
from pydrake.visualization._meldis import Meldis, _ViewerApplet  # noqa: E402

(DRAKE_URL,) = private_urls(1)
os.environ["LCM_DEFAULT_URL"] = DRAKE_URL  # which meldis listens to
PATIENCE = 30.0  # s


class Types(unittest.TestCase):
    def test_have_the_fingerprints_of_the_drake_package(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            files = sorted(TYPES.glob("*.lcm"))
            subprocess.run(["lcm-gen", "--python", "--ppath", folder, *files], check=True)
            names = [path.stem for path in files if not path.stem.endswith("_v1")]
            script = (
                "import drake, sys\n"
                "for name in sys.argv[1:]:\n"
                "  print(getattr(drake, name)._get_packed_fingerprint().hex())"
            )
            printed = subprocess.run(
                ["/usr/bin/python3", "-B", "-c", script, *names], capture_output=True, text=True, check=True,
                env={**os.environ, "PYTHONPATH": folder},
            ).stdout.split()  # fmt: skip
        self.assertGreater(len(names), 8)
        for name, own in zip(names, printed):
            self.assertEqual(own, getattr(drake, name)._get_packed_fingerprint().hex(), name)


class Steering(unittest.TestCase):
    """palpate-world and palpated by steer_drake_arm, with a coarse bar."""

    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def steers(self, arm: str, meldis: "Optional[Meldis]" = None) -> None:
        words = [
            WORLDS / "steer_drake_arm", "--arm", arm, "--cells", "10", "1", "1", "--seconds", "3",
            "--within", "5", "--bin", BIN, "--output", self.folder, "--drake-url", DRAKE_URL,
        ]  # fmt: skip
        with open(self.folder / "output", "w+", encoding="utf-8") as output:
            process = subprocess.Popen(
                [sys.executable, "-B", *map(str, words)], stdout=output, stderr=output
            )
            self.addCleanup(process.kill)
            while process.poll() is None:
                if meldis is None:
                    time.sleep(0.1)
                else:
                    meldis._lcm.HandleSubscriptions(100)
                    meldis._invoke_subscriptions()
            output.seek(0)
            self.assertEqual(process.returncode, 0, output.read())
        result = json.loads((self.folder / "result.json").read_text())
        self.assertGreater(result["distance_at_first_mm"], 35)
        self.assertGreater(result["flange_way_mm"], 10)
        self.assertLess(result["flange_from_commands_mm"], 2)
        self.assertTrue((self.folder / f"{arm}.png").is_file())

    def test_palpated_moves_an_iiwa_of_drake_and_meldis_shows_the_shape(self) -> None:
        self.drawn = []
        convert = _ViewerApplet._convert_deformable_geom

        def keep(applet, geometry):  # type: ignore
            self.drawn.append(convert(applet, geometry))
            return self.drawn[-1]

        with unittest.mock.patch.object(_ViewerApplet, "_convert_deformable_geom", keep):
            meldis = Meldis()
            self.steers("iiwa", meldis)
        self.assertTrue(meldis.meshcat.HasPath("/DRAKE_VIEWER/0/palpate/shape"))
        # What it has drawn last are the surface's nodes at the end of the run.
        vertices, faces, _, pose = self.drawn[-1]
        self.assertEqual(sorted(set(faces.ravel())), list(range(vertices.shape[1])))
        log = palpate.read_log(self.folder / "run.housekeeping.lcmlog")
        mesh, last = log.mesh, log["SHAPE"].positions[-1]
        surface = last[sorted(set(mesh.triangles.ravel()))]
        self.assertEqual(len(surface), vertices.shape[1])
        np.testing.assert_allclose(vertices.min(axis=1), surface.min(axis=0), atol=1e-3)
        np.testing.assert_allclose(vertices.max(axis=1), surface.max(axis=0), atol=1e-3)
        np.testing.assert_allclose(pose.translation(), [1.36, 0.03, 0.28], atol=1e-6)

    def test_palpated_moves_a_panda_of_drake(self) -> None:
        self.steers("panda")


class Torques(unittest.TestCase):
    """palpated by measure_drake_torques: contacts with the hand, found in joint_torque_external."""

    def test_contacts_are_found_with_their_force(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            words = [WORLDS / "measure_drake_torques", "--contacts", 2, "--weak", 1, "--bin", BIN, "--output", folder]
            done = subprocess.run(
                [sys.executable, "-B", *map(str, words)], capture_output=True, text=True, timeout=4 * PATIENCE
            )  # exit code 1: on a busy machine the force is found too late for the goals, while it rises and falls
            self.assertIn(done.returncode, (0, 1), done.stderr)
            contacts = json.loads((Path(folder) / "result.json").read_text())["contacts"]
        self.assertEqual(len(contacts), 3)
        for contact in contacts:
            self.assertAlmostEqual(contact["found_N"] / contact["force_N"], 1, delta=0.05)


class Fragments(unittest.TestCase):
    """Statuses of a panda, which have variable arrays, in two datagrams each."""

    def states_of(self, largest_message: int, seconds: float) -> "list[robot_state_t]":
        """What palpate-drake publishes within `seconds`, until its first state."""
        control, url = private_urls(2)
        address, port = url.split("//")[1].split("?")[0].split(":")
        sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.addCleanup(sender.close)
        sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            (folder / "bridge.yaml").write_text(
                f"robot: {{arm: panda, urdf: {SOURCE}/sim/robot/lwr_hand.urdf}}\n"
                f"bus: {{control: '{control}', drake: '{url}', largest_message: {largest_message}}}\n"
            )
            bridge = Program(
                "palpate-drake", [BIN / "palpate-drake", "--config", folder / "bridge.yaml"], folder
            )
            self.addCleanup(bridge.end)
            bridge.wait_for("waits for")
            status = lcmt_panda_status()
            status.num_joints = 7
            for array in [
                "joint_position", "joint_position_desired", "joint_velocity", "joint_velocity_desired",
                "joint_acceleration_desired", "joint_torque", "joint_torque_desired", "joint_torque_external",
            ]:  # fmt: skip
                setattr(status, array, [0.1 * joint for joint in range(7)])
            part = len(status.encode()) // 2 + 1
            states: "list[robot_state_t]" = []
            with palpate.Bus(control) as bus:
                bus.subscribe("ROBOT_STATE", states.append)
                end = time.monotonic() + seconds
                sequence = 0
                while not states and time.monotonic() < end:
                    status.utime += 5_000
                    data, sequence = status.encode(), sequence + 1
                    parts = [data[at : at + part] for at in range(0, len(data), part)]
                    for number, piece in enumerate(parts):
                        head = struct.pack(
                            ">4sIIIHH", b"LC03", sequence, len(data), number * part, number, len(parts)
                        )
                        name_of_channel = b"PANDA_STATUS\0" if number == 0 else b""
                        sender.sendto(head + name_of_channel + piece, (address, int(port)))
                    time.sleep(0.005)
                    bus.drain()
        return states

    def test_are_joined(self) -> None:
        states = self.states_of(65000, PATIENCE)
        self.assertTrue(states)
        np.testing.assert_allclose(states[0].q[:7], [0.1 * joint for joint in range(7)])

    def test_beyond_the_bound_are_dropped(self) -> None:
        self.assertEqual(self.states_of(300, 1.0), [])


class Gripper(unittest.TestCase):
    def test_is_commanded_and_reported_by_drakes_types(self) -> None:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            control, housekeeping = private_urls(2)
            (folder / "bridge.yaml").write_text(
                f"robot: {{arm: iiwa, urdf: {SOURCE}/sim/robot/lwr_hand.urdf}}\n"
                f"bus: {{control: '{control}', housekeeping: '{housekeeping}'}}\n"  # one for both
                "gripper: {force: 30}\n"
            )
            bridge = Program(
                "palpate-drake", [BIN / "palpate-drake", "--config", folder / "bridge.yaml"], folder
            )
            self.addCleanup(bridge.end)
            bridge.wait_for("waits for")
            commands: "list[lcmt_schunk_wsg_command]" = []
            lcm = DrakeLcm(control)
            lcm.Subscribe(
                "SCHUNK_WSG_COMMAND", lambda data: commands.append(lcmt_schunk_wsg_command.decode(data))
            )
            states: "list[hand_state_t]" = []
            with palpate.Bus(control) as bus:
                bus.subscribe("HAND_STATE", states.append)
                command, status = hand_command_t(), lcmt_schunk_wsg_status()
                command.action, command.authentication = hand_command_t.CLOSE, bytes(32)
                status.actual_position_mm, status.actual_force = 58.0, -25.0
                end = time.monotonic() + PATIENCE
                while time.monotonic() < end:
                    if not commands:
                        bus.stamp("HAND_COMMAND", command)
                        bus.publish("HAND_COMMAND", command)
                    status.utime += 10_000
                    lcm.Publish("SCHUNK_WSG_STATUS", status.encode())
                    lcm.HandleSubscriptions(10)
                    bus.drain()
                    if commands and states and states[-1].grasp == hand_state_t.GRASP_HOLDING:
                        break
            self.assertTrue(commands, bridge.output())
            self.assertEqual((commands[-1].target_position_mm, commands[-1].force), (0.0, 30.0))
            self.assertEqual(states[-1].grasp, hand_state_t.GRASP_HOLDING)
            self.assertAlmostEqual(states[-1].q[0], 0.058)


if __name__ == "__main__":
    unittest.main(verbosity=2)
