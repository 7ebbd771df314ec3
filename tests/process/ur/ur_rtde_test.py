"""The simulated controller of tools/lab/worlds, which palpate-ur is tested with, against the independent
clients of the ur_rtde package.
"""

from __future__ import annotations

import subprocess
import sys
import unittest

from simulated_ur import SimulatedUr  # first: finds the next

# isort: split
import numpy as np
from ur_controller import flange_pose

try:
    import rtde_receive  # noqa: F401
except ImportError:
    print("skipped: no ur_rtde; tools/packaging/install-worlds installs it")
    sys.exit(77)

# In a process of their own: their constructors keep Python's lock.
RECEIVE = """
import sys, time
from rtde_receive import RTDEReceiveInterface
for frequency in (500.0, 125.0):
    client = RTDEReceiveInterface(sys.argv[1], frequency, [], False, True)
    first, begin = client.getTimestamp(), time.monotonic()
    seen = set()
    while time.monotonic() < begin + 0.5:
        seen.add(client.getTimestamp())
        time.sleep(0.0005)
    steps = sorted(b - a for a, b in zip(sorted(seen), sorted(seen)[1:]))
    print(steps[len(steps) // 2], *client.getActualQ(), *client.getActualQd(), *client.getActualTCPPose(),
          *client.getActualTCPForce(), client.getPayload(), client.getRobotMode(),
          client.getSafetyStatusBits(), client.getRuntimeState(), client.getOutputIntRegister(42))
    client.disconnect()
"""
SEND = """
import sys, time
from rtde_io import RTDEIOInterface
from script_client import ScriptClient
client = RTDEIOInterface(sys.argv[1], False, True)
print(client.setInputIntRegister(42, -5), client.setInputDoubleRegister(43, 0.25))
time.sleep(0.1)
client.disconnect()
client = ScriptClient(sys.argv[1], 5, 12)
client.connect()
print(client.isConnected())
client.sendScriptCommand("def f():\\n  write_output_integer_register(42, read_input_integer_register(42) - 4)\\nend\\n")
time.sleep(0.3)
"""


class Clients(unittest.TestCase):
    def setUp(self) -> None:
        self.ur = SimulatedUr()
        self.addCleanup(self.ur.close)

    def run_client(self, script: str) -> "list[str]":
        done = subprocess.run(
            [sys.executable, "-B", "-c", script, self.ur.address], capture_output=True, text=True, timeout=60
        )
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(self.ur.servers.violations, [])
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout.splitlines()

    def test_receive_states(self) -> None:
        controller = self.ur.controller
        controller.tcp_force, controller.payload = (1, 2, 3, 4, 5, 6), 0.75
        controller.registers["output_int_register_42"] = -12345
        controller.is_emergency_stopped = True
        lines = self.run_client(RECEIVE)
        for line, period in zip(lines, (0.002, 0.008)):
            step, *numbers = map(float, line.split())
            self.assertAlmostEqual(step, period)
            np.testing.assert_allclose(numbers[:6], controller.q)
            np.testing.assert_allclose(numbers[6:12], 0)
            np.testing.assert_allclose(numbers[12:15], flange_pose(controller.q)[:3, 3])
            self.assertEqual(numbers[18:25], [1, 2, 3, 4, 5, 6, 0.75])
            self.assertEqual(numbers[25:], [3, 1 << 6 | 1 << 7, 1, -12345])
        self.assertEqual(len(lines), 2)

    def test_send_registers_and_programs(self) -> None:
        self.assertEqual(self.run_client(SEND), ["True True", "True"])
        registers = self.ur.controller.registers
        self.assertEqual(registers["input_int_register_42"], -5)
        self.assertEqual(registers["input_double_register_43"], 0.25)
        self.assertEqual(registers["output_int_register_42"], -9)
        self.assertEqual(self.ur.controller.errors, [])


if __name__ == "__main__":
    unittest.main(verbosity=2)
