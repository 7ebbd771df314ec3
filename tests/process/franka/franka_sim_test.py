"""palpate-franka with franka-sim, an independent server of the FCI, and the mock of the other tests with
pylibfranka, the maker's own client.
"""

from __future__ import annotations

import os
import random
import re
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

from mock_arm import BIN, IDLE, SOURCE, URDF, MockArm, wait_for

sys.path.insert(0, str(SOURCE / "tools/lab/worlds"))

import numpy as np  # noqa: E402
import palpate  # noqa: E402
from live_run import Program, private_urls  # noqa: E402
from palpate.messages import joint_velocity_command_t, robot_state_t  # noqa: E402

PYTHON = Path(os.environ.get("PALPATE_FRANKA_PYTHON", SOURCE / "build/worlds_franka/bin/python"))
BENT = (0, -0.4, 0, -2.2, 0, 1.9, 0.7)  # rad
CLIENT = """
import sys
import pylibfranka as franka
robot = franka.Robot(sys.argv[1], franka.RealtimeConfig.kIgnore)
state = robot.read_once()
print(*state.q, *state.O_F_ext_hat_K, flush=True)
names = [name for name in dir(franka.Errors) if not name.startswith("_")]
for line in sys.stdin:
    if line.strip() == "move":
        break
    for _ in range(20):
        state = robot.read_once()
    print(*[name for name in names if getattr(state.current_errors, name)], flush=True)
control = robot.start_joint_velocity_control(franka.ControllerMode.JointImpedance)
for cycle in range(1, 601):
    state, _ = control.readOnce()
    share = min(1, cycle / 100, max(0, (500 - cycle) / 100))
    command = franka.JointVelocities([0.1 * share] * 7)
    command.motion_finished = cycle == 600
    control.writeOnce(command)
print(*state.q, flush=True)
"""


def is_there(package: str) -> bool:
    return subprocess.run([PYTHON, "-c", f"import {package}"], capture_output=True, check=False).returncode == 0


class Commander:
    """In palpated's place: joint velocities every 5 ms."""

    def __init__(self, url: str) -> None:
        self.bus = palpate.Bus(url)
        self.states: "list[robot_state_t]" = []
        self.bus.subscribe("ROBOT_STATE", self.states.append)
        self._command = joint_velocity_command_t()
        self._command.joint_count, self._command.authentication = 7, bytes(32)
        self._is_ended = False
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def close(self) -> None:
        self._is_ended = True
        self._thread.join()
        self.bus.close()

    def move(self, speed: float) -> None:
        self._command.dq = [speed] * 7 + [0.0] * 9
        self._command.valid = 1

    def rest(self) -> None:
        self._command.valid = 0

    def _run(self) -> None:
        publisher = palpate.Bus(self.bus.url)
        while not self._is_ended:
            self._command.utime = 0  # now
            publisher.publish("JOINT_VELOCITY_COMMAND", self._command)
            time.sleep(0.005)
        publisher.close()

    def latest(self) -> robot_state_t:
        self.bus.drain()
        return self.states[-1]

    def q(self) -> np.ndarray:
        return np.array(self.latest().q[:7])

    def speed(self) -> float:
        return float(np.abs(self.latest().dq[:7]).max())


class WithFrankaSim(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        with socket.create_server(("127.0.0.1", 0)) as free:
            port = free.getsockname()[1]
        script = Path(__file__).with_name("serve_franka_sim.py")
        self.server = Program("franka_sim", [PYTHON, "-B", script, port, self.folder], self.folder)
        self.addCleanup(self.server.end)
        self.server.wait_for("Server ready")
        (url,) = private_urls(1)
        (self.folder / "franka.yaml").write_text(
            f"robot: {{host: 127.0.0.1, port: {port}, urdf: {URDF}, recover: true}}\nbus: {{control: '{url}'}}\n"
        )
        self.bridge = Program("palpate-franka", [BIN / "palpate-franka", "--config", self.folder / "franka.yaml"], self.folder)
        self.addCleanup(self.bridge.end)
        self.bridge.wait_for("connected")
        self.palpated = Commander(url)
        self.addCleanup(self.palpated.close)

    def move(self, speed: float) -> None:
        """Until the arm moves, also where a loaded machine has stopped it meanwhile."""

        def moves() -> bool:
            self.palpated.rest()
            time.sleep(0.1)
            self.palpated.move(speed)
            end = time.monotonic() + 2
            while self.palpated.speed() < 0.9 * abs(speed) and time.monotonic() < end:
                time.sleep(0.001)
            return self.palpated.speed() >= 0.9 * abs(speed)

        wait_for(moves, f"the arm moves; {self.bridge.output()}")

    def test_moves_and_recovers(self) -> None:
        self.palpated.rest()
        time.sleep(1)
        self.assertNotIn("Received Move command", self.server.output())
        before = self.palpated.q()
        self.move(0.1)
        wait_for(lambda: bool((self.palpated.q() - before).min() > 0.05), "the way")
        way = self.palpated.q() - before
        self.assertLess(way.max() - way.min(), 0.03, "all joints move alike")

        with self.subTest("ends at rest"):
            self.palpated.rest()
            wait_for(lambda: "Sent Move success response" in self.server.output(), "the motion ends")

        with self.subTest("reflex"):
            self.move(-0.1)
            self.bridge.process.send_signal(signal.SIGSTOP)  # no answers
            time.sleep(0.2)
            self.bridge.process.send_signal(signal.SIGCONT)
            self.bridge.wait_for("reflex of the arm: communication_constraints_violation")
            wait_for(lambda: self.palpated.speed() < 2e-2, "the arm rests")
            stood = self.palpated.q()
            time.sleep(1.5)  # the reflex is left; palpated commands on
            self.assertLess(np.abs(self.palpated.q() - stood).max(), 0.02, "rests until palpated is stopped")
            self.move(-0.1)

        self.bridge.end()
        for error in ("joint_motion_generator", "wrong size", "Unhandled"):
            self.assertNotIn(error, self.server.output())


class WithPylibfranka(unittest.TestCase):
    def test_the_makers_client_accepts_the_mock(self) -> None:
        address = f"127.{random.randint(1, 250)}.{random.randint(1, 250)}.{random.randint(2, 250)}"
        # Their model of the arm needs what palpate's URDF does not have.
        path = "import franka_sim; print(franka_sim.__path__[0] + '/models/fr3.urdf')"
        urdf = subprocess.run([PYTHON, "-c", path], capture_output=True, text=True, check=True).stdout.strip()
        arm = MockArm(BENT, address, 1337, urdf)
        self.addCleanup(arm.close)
        arm.say("wrench 1 2 3 4 5 6")
        client = subprocess.Popen(
            [str(PYTHON), "-c", CLIENT, address], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1
        )
        self.addCleanup(client.stdout.close)
        self.addCleanup(client.kill)
        numbers = [float(word) for word in client.stdout.readline().split()]
        np.testing.assert_allclose(numbers, [*BENT, 1, 2, 3, 4, 5, 6], atol=1e-6)

        table = (SOURCE / "tools/bridge/franka/messages.cpp").read_text(encoding="utf-8").split("kErrorNames{")[1]
        names = re.findall(r'"([a-z0-9_]+)"', table.split("}")[0])
        self.assertEqual(len(names), 41)
        for error, name in enumerate(names):
            arm.say(f"errors {error}")
            arm.state()  # it is set
            client.stdin.write("errors\n")
            self.assertEqual(client.stdout.readline().strip(), name, error)

        client.stdin.write("move\n")
        q = [float(word) for word in client.stdout.readline().split()]
        self.assertEqual(client.wait(20), 0)
        client.stdin.close()
        np.testing.assert_allclose(np.array(q) - BENT, 0.04, atol=4e-3)
        state = arm.state()
        self.assertEqual((state.mode, state.motions, state.ended, state.reflexes), (IDLE, 1, 1, 0))
        self.assertEqual(state.violation, "")


if __name__ == "__main__":
    if not (is_there("franka_sim") and is_there("pylibfranka")):
        print("skipped: no franka-sim and pylibfranka; tools/packaging/install-worlds installs them")
        sys.exit(77)
    unittest.main(verbosity=2)
