"""Simulator, daemon, palpate-view and a browser, each in a separate process."""
import os
import random
import re
import subprocess
import tempfile

from browser import Browser, wait_for

SENSING = ("sensing=[{name: wrist, component: ft_newton_euler, payload: {mass: 4.8, "
           "center_of_mass: [0.0015, -0.00065, 0.1137]}}, {name: user, component: manual}]")
CONTACT = ("contact=[{name: grasp, component: wrench_patch, sources: wrist, on_grasp: true}, "
           "{name: push, component: area_coordinates, sources: manual}]")


def read(path):
    with open(path) as file:
        return file.read()


class Cell(Browser):
    """Of one example of the daemon, with overrides, and the robot that the page draws."""

    def __init__(self, binaries, source, example="bar_long_soft.yaml", sets=(SENSING, CONTACT),
                 robot="sim/robot/lwr_hand.urdf"):
        self.binaries, self.source = binaries, source
        self.configuration = f"{source}/rt/config/examples/{example}"
        self.sets = [word for text in sets for word in ("--set", text)]
        self.robot = ["--robot", f"{source}/{robot}"] if robot else []
        self.folder = tempfile.TemporaryDirectory(prefix="palpate_view_")
        number = os.getpid() % 20000
        self.group = f"239.255.{90 + number // 250}.{1 + number % 250}"
        self.ports = [10000 + 2 * number % 22000 + i for i in (0, 1)]
        self.processes, self.logs = {}, {}
        self.token_file = os.path.join(self.folder.name, "token")
        subprocess.run([f"{binaries}/palpate-command", "--make-key", self.token_file], check=True,
                       stdout=subprocess.DEVNULL)
        self.token = read(self.token_file).strip()
        self.port = random.randint(10000, 32000)

    def url(self, which):
        return f"udpm://{self.group}:{self.ports[which]}?ttl=0"

    def start(self, name, *words):
        self.logs[name] = os.path.join(self.folder.name, f"{name}.txt")
        with open(self.logs[name], "a") as log:
            # If a test is killed, the processes it has started end with it.
            self.processes[name] = subprocess.Popen(
                ["setpriv", "--pdeathsig", "KILL", f"{self.binaries}/{name}", *words],
                stdout=log, stderr=subprocess.STDOUT)

    def buses(self):
        return ["--set", f"bus.control={self.url(0)}", "--set", f"bus.housekeeping={self.url(1)}"]

    def start_simulator(self):
        self.start("palpate-sim", f"{self.source}/sim/scenes/bar_long_soft_control.yaml",
                   *self.buses())

    def start_daemon(self, priority=0):
        """`priority`: of SCHED_FIFO; 0: as any other program."""
        # A machine busy with other tests is late without a fault.
        self.start("palpated", "--config", self.configuration, *self.buses(), *self.sets, "--set",
                   "loop.degraded_after_ms=9000", "--set", "loop.overrun_window_ms=10000",
                   "--set", "loop.safe_stop_after_ms=10000", "--set", f"loop.fifo_priority={priority}")

    def start_view(self, *source):
        """Live, so that the page with the token may command; or as `source` specifies."""
        live = ["--control", "--token-file", self.token_file]
        printed = len(read(self.logs["palpate-view"])) if "palpate-view" in self.logs else 0
        self.start("palpate-view", "--url", self.url(0), "--url", "housekeeping=" + self.url(1),
                   "--config", self.configuration, *self.sets, *self.robot, "--port", str(self.port),
                   *(source or live))
        wait_for(lambda: "http://" in read(self.logs["palpate-view"])[printed:],
                 "palpate-view prints its address")

    def stop(self, name):
        process = self.processes.pop(name)
        process.terminate()
        try:
            process.wait(20)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        return process.returncode

    def open_browser(self, width, height):
        self.open(f"http://127.0.0.1:{self.port}/#token={self.token}", self.folder.name, width, height)

    def close(self):
        self.quit()
        for name in list(self.processes):
            self.stop(name)
        self.folder.cleanup()

    def tail(self):
        return "\n".join(f"--- {name}\n" + re.sub(r"token=\w+", "token=...", read(path))[-1500:]
                         for name, path in self.logs.items())
