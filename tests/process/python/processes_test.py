"""Processes started by the tests here end with them, even if the tests are killed."""

import os
import signal
import subprocess
import sys
import time
import unittest
from pathlib import Path
from typing import Callable

from processes import PATIENCE

STARTS_ONE = """
import time, unittest
from processes import Program
print(Program(unittest.TestCase(), ["sleep", 600]).process.pid, flush=True)
time.sleep(600)
"""


def wait_for(condition: Callable[[], bool]) -> bool:
    end = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.02)
    return True


def runs(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
    except FileNotFoundError:
        return False
    return state != "Z"


class Processes(unittest.TestCase):
    def test_a_killed_test_leaves_nothing_running(self) -> None:
        paths = [str(Path(__file__).parent), os.environ["PYTHONPATH"]]
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(paths)}
        with subprocess.Popen(
            [sys.executable, "-c", STARTS_ONE], stdout=subprocess.PIPE, text=True, env=environment
        ) as test:
            assert test.stdout is not None
            child = int(test.stdout.readline())
            # Started: only from then on does the kernel tie its end to the parent.
            name = Path(f"/proc/{child}/comm")
            self.assertTrue(wait_for(lambda: name.read_text() == "sleep\n"))
            test.send_signal(signal.SIGKILL)
        self.assertTrue(wait_for(lambda: not runs(child)))


if __name__ == "__main__":
    unittest.main()
