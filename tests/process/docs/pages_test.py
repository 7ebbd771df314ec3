#!/usr/bin/env python3
"""Every shell line shown on a page of the documentation works as described.

usage: pages_test.py ROOT BIN

The tutorial, the guide to a user's own robot and README.md are run as a whole by docs_test.py. Lines of
other pages are run here, each block with a separate simulator and daemon; a program that keeps running
must report that it is ready, and is available to the next line.
"""
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from docs_test import private_urls
from names import blocks

ROOT, BIN = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
PATIENCE = 300  # s, sufficient for a very busy machine
SCENE, CONFIGURATION = "sim/scenes/bar_long_soft_control.yaml", "rt/config/examples/bar_long_soft.yaml"
WHOLE = {"README.md", "docs/tutorial.md", "docs/own_robot.md"}  # docs_test.py
# Lines that are not run, by their beginning, and why.
NOT_RUN = {
    "tools/lab/report/report_baselines": "takes hours; process.published.studies runs it on a small plan",
    "tools/lab/report/tune_baselines": "takes hours; process.published.tuning runs it on a small plan",
    "tools/lab/report/run_shards": "takes hours; process.published.studies runs it on a small plan",
    "tools/packaging/install-worlds": "downloads packages; install-dependencies has run it",
    "build/worlds/bin/python tools/lab/worlds/": "takes minutes; process.worlds runs the programs for seconds",
    "sbatch": "needs a cluster; process.published.clusters runs its script on one",
    "palpate-evaluate control": "takes hours; process.published.studies runs it on a small plan",
    "palpate-evaluate published-sensing": "takes hours; process.published.studies runs it on a small plan",
    "palpate-evaluate discrepancies --worlds 200": "takes an hour; the line before it is run",
    "palpate-evaluate discrepancies --kind none": "takes hours; see above",
    "palpate-evaluate shapes": "exits with 1, as two of its goals are missed; unit.tools_lab_shapes runs it",
    "palpate-record --seconds 100 run": "needs an arm that moves; process.calibrate.program records one",
    "palpate-calibrate wrist run.": "needs that recording; process.calibrate.program has one",
    "palpated --config wrist.yaml": "needs its result; process.calibrate.program runs it",
    "palpate-record --seconds 90 run": "needs an arm that moves; unit.tools_calibrate.friction has its recording",
    "palpate-calibrate friction run.": "needs that recording; process.calibrate.program runs it on one",
    "palpated --config friction.yaml": "needs its result",
    "PYTHONPATH=build/release/python python3": "is a dialogue; tests of palpate's package use that folder",
}
# Programs that keep running, and their output when ready.
READY = {"palpated": "inactive", "palpate-sim": "nodes", "palpate-view": "http://", "palpate-drake": "waits for",
         "palpate-ur": "waits for", "palpate-franka": "waits for", "palpate-ros2": "waits for", "tools/lab/worlds/ur_arm": "ready", "palpate-see": "clouds"}


class Workspace:
    """Folder, LCM URLs and programs of a single block."""

    def __init__(self):
        self.urls = private_urls()
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="palpate_pages_"))
        for name in ("rt", "sim", "tools", "build"):
            (self.folder / name).symlink_to(ROOT / name)
        for name, base in (("your", CONFIGURATION), ("my", CONFIGURATION), ("scene", SCENE)):
            (self.folder / f"{name}.yaml").write_text(f"base: {base}\n")
        shutil.copy(ROOT / "sim/robot/lwr_hand.urdf", self.folder / "my.urdf")
        self.staying = []

    def close(self):
        for process, _ in self.staying:
            process.send_signal(signal.SIGTERM)
        for process, _ in self.staying:
            try:
                process.wait(PATIENCE)
            except subprocess.TimeoutExpired:
                process.kill()
        shutil.rmtree(self.folder, ignore_errors=True)

    def words_more(self, program, line):
        """Settings that separate the program of this block, and make it tolerant of a busy
        machine.
        """
        control, housekeeping = self.urls
        if program in ("palpated", "palpate-sim", "palpate-drake", "palpate-ros2"):
            more = f" --set bus.control={control} --set bus.housekeeping={housekeeping}"
            if program == "palpated":
                more += " --set loop.degraded_after_ms=9000 --set loop.overrun_window_ms=10000"
                more += " --set loop.safe_stop_after_ms=10000"
            return more
        if program in ("palpate-ur", "palpate-franka"):
            return f" --set bus.control={control}"
        if program == "palpate-command" and "--make-key" not in line:
            return f" --url {control} --url housekeeping={housekeeping} --timeout 60"
        if program == "palpate-view":
            return f" --url {control} --url housekeeping={housekeeping} --port 0"
        if program in ("palpate-top", "palpate-record"):
            more = f" --url control={control} --url housekeeping={housekeeping}"
            return more + (" --plain --once --seconds 2" if program == "palpate-top" else "")
        return " --no-live" if program == "palpate-doctor" else ""

    def run(self, line):
        """Raises on failure; a program that keeps running is left running."""
        if "\n" not in line:
            line = line.split(" #")[0].rstrip().rstrip("&").rstrip()
        program = line.split()[0]
        shell = line.replace("/tmp/plugin", str(self.folder / "plugin")) + self.words_more(program, line)
        if program in READY and "--check" not in line and "--seconds" not in line:
            log = self.folder / f"said_{len(self.staying)}"
            with log.open("w") as file:
                process = subprocess.Popen(["setpriv", "--pdeathsig", "KILL", "bash", "-c", "exec " + shell], cwd=self.folder, stdout=file,
                                           stderr=subprocess.STDOUT, env=self.environment())
            self.staying.append((process, log))
            end = time.monotonic() + PATIENCE
            while READY[program] not in log.read_text():
                if process.poll() is not None or time.monotonic() > end:
                    raise RuntimeError(f"not ready:\n{log.read_text()}")
                time.sleep(0.05)
            return
        said = subprocess.run(["bash", "-c", shell], cwd=self.folder, text=True, timeout=PATIENCE, check=False,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=self.environment())
        # Deficiencies of this machine are not the page's fault.
        if said.returncode not in ((0, 1) if program == "palpate-doctor" else (0,)):
            raise RuntimeError(f"exit code {said.returncode}:\n{said.stdout}")
        for process, log in self.staying:
            if process.poll() is not None:
                raise RuntimeError(f"{process.args[-1]} has ended:\n{log.read_text()}")

    def environment(self):
        return {**os.environ, "PATH": f"{BIN}:{os.environ['PATH']}", "PWD": str(self.folder)}


def commands(start, lines):
    """(number of its line, command): a here-document belongs to the command that reads it."""
    found, end = [], None
    for number, line in enumerate(lines, start):
        if end is not None:
            found[-1] = (found[-1][0], found[-1][1] + "\n" + line)
            end = None if line == end else end
        elif line.strip():
            found.append((number, line))
            end = line.rsplit("<<", 1)[1].strip() if "<<" in line else None
    return found


def prepare(workspace, text):
    """Preconditions of the block."""
    if "palpate-sim " not in text:
        workspace.run(f"palpate-sim {SCENE}")
    if "palpated " not in text:
        workspace.run(f"palpated {CONFIGURATION}")
    if "control.log" in text:
        workspace.run("palpate-record --quiet --seconds 2 run.log")
        for url in ("control", "housekeeping"):
            (workspace.folder / f"run.{url}.log").rename(workspace.folder / f"{url}.log")


def wrong_lines(page):
    """Runs a page's blocks; returns the numbers of failed and of successful lines."""
    wrong, right = 0, 0
    for language, start, lines in blocks((ROOT / page).read_text()):
        numbered = commands(start, lines)
        not_run = [(n, line) for n, line in numbered if any(line.startswith(begin) for begin in NOT_RUN)]
        for number, line in not_run:
            print(f"{page}:{number}: not run: it {next(why for b, why in NOT_RUN.items() if line.startswith(b))}")
        if language != "sh" or len(not_run) == len(numbered):
            continue
        workspace = Workspace()
        try:
            prepare(workspace, "\n".join(lines))
            for number, line in numbered:
                if (number, line) in not_run:
                    continue
                print(f"{page}:{number}: {line}", flush=True)
                try:
                    workspace.run(line)
                    right += 1
                except (RuntimeError, subprocess.TimeoutExpired) as error:
                    wrong += 1
                    print(f"error: {error}")
        finally:
            workspace.close()
    return wrong, right


def main():
    pages = [p for p in ROOT.glob("**/*.md") if not {"build", "out", ".git"} & set(p.relative_to(ROOT).parts)]
    wrong = right = 0
    for page in sorted(str(p.relative_to(ROOT)) for p in pages):
        if page not in WHOLE:
            more_wrong, more_right = wrong_lines(page)
            wrong, right = wrong + more_wrong, right + more_right
    print(f"{right} lines of pages did what they say, {wrong} did not")
    return 1 if wrong or right < 10 else 0


if __name__ == "__main__":
    sys.exit(main())
