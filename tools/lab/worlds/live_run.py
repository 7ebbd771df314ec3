"""palpated, a recorder and palpate-world as processes on private URLs, in lock-step; and the
existing scorers on what they have recorded.
"""

from __future__ import annotations

import json
import os
import random
import struct
import subprocess
import sys
import threading
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Optional, Sequence

import palpate
from palpate.channel_table import CHANNELS

SOURCE = Path(__file__).resolve().parents[3]
_PATIENCE = 60.0  # s
_LONGEST = 24 * 3600.0  # s, until a world takes its first tick, at most


class RunFailed(RuntimeError):
    """A program ended before its run was complete: its name and last output."""


@dataclass(frozen=True)
class Target:
    """Of a point: where it is at rest and its target, m, in O."""

    rest_point: tuple[float, float, float]
    place: tuple[float, float, float]


@dataclass(frozen=True)
class RunPlan:
    """One run of a world with palpated."""

    world: str  # of palpate-world, or palpate-sim: that program instead
    scene: Path
    configuration: Path
    world_arguments: Sequence[str] = ()
    overrides: Sequence[str] = ()  # of the configuration
    target: Optional[Target] = None
    seconds: Optional[float] = None  # simulated; None: until the motion ends
    bin: Path = SOURCE / "build/release/bin"


@dataclass
class RunFiles:
    """What a run leaves in its folder."""

    folder: Path
    control: Path = field(init=False)  # log of the control URL
    housekeeping: Path = field(init=False)  # log of the housekeeping URL

    def __post_init__(self) -> None:
        self.control = self.folder / "run.control.lcmlog"
        self.housekeeping = self.folder / "run.housekeeping.lcmlog"


class Program:
    """A process with its output in a file; ends with this one."""

    def __init__(self, name: str, words: Sequence[object], folder: Path) -> None:
        self.name, self._log = name, folder / f"{name}.log"
        path = str(Path(palpate.__file__).resolve().parents[1])
        with open(self._log, "wb") as output:
            self.process = subprocess.Popen(
                ["setpriv", "--pdeathsig", "KILL", *(str(word) for word in words)],
                stdout=output,
                stderr=subprocess.STDOUT,
                env={**os.environ, "PYTHONPATH": path},
            )

    def output(self) -> str:
        return self._log.read_text(encoding="utf-8", errors="replace")

    def fail(self, why: str) -> RunFailed:
        return RunFailed(f"{self.name} {why}; {self._log}:\n{self.output()[-2000:]}")

    def wait_for(self, text: str) -> None:
        end = time.monotonic() + _PATIENCE
        while text not in self.output():
            if self.process.poll() is not None:
                raise self.fail(f"ended with code {self.process.returncode}")
            if time.monotonic() > end:
                raise self.fail(f"has not printed {text!r} in {_PATIENCE:g} s")
            time.sleep(0.02)

    def end(self) -> None:
        if self.process.poll() is None:
            self.process.terminate()
            self.process.wait(_PATIENCE)


def private_urls(count: int) -> list[str]:
    """For this machine only."""
    group = f"239.255.{random.randint(160, 250)}.{random.randint(1, 250)}"
    port = random.randint(10000, 32000)
    return [f"udpm://{group}:{port + i}?ttl=0" for i in range(count)]


def run_live(plan: RunPlan, folder: Path) -> RunFiles:
    """Runs the plan; start and target reach the daemon before the world's first tick. Raises
    RunFailed, OSError."""
    folder.mkdir(parents=True, exist_ok=True)
    control, housekeeping = private_urls(2)
    urls = ["--set", f"bus.control={control}", "--set", f"bus.housekeeping={housekeeping}"]
    sets = [word for text in plan.overrides for word in ("--set", text)]
    programs: list[Program] = []

    def start(name: str, *words: object) -> Program:
        programs.append(Program(name, words, folder))
        return programs[-1]

    try:
        recorder = start(
            "palpate-record", plan.bin / "palpate-record", "--force", "--quiet", "--url",
            f"control={control}", "--url", f"housekeeping={housekeeping}", folder / "run.lcmlog",
        )  # fmt: skip
        daemon = start(
            "palpated", plan.bin / "palpated", "--config", plan.configuration, "--stepped", *urls,
            *sets,
        )  # fmt: skip
        daemon.wait_for("waits for start")
        commands = [threading.Thread(target=_start, args=(control, housekeeping), daemon=True)]
        if plan.target is not None:
            arguments = (control, housekeeping, plan.target)
            commands.append(threading.Thread(target=_steer, args=arguments, daemon=True))
        for thread in commands:
            thread.start()
            time.sleep(0.3)
        seconds = [] if plan.seconds is None else ["--duration", plan.seconds]
        program: list[object] = [
            sys.executable, Path(__file__).parent / "palpate-world", plan.scene, "--world",
            plan.world, "--lock-step", "--json", folder / "world.json",
        ]  # fmt: skip
        if plan.world == "palpate-sim":
            program = [plan.bin / "palpate-sim", plan.scene, "--fast"]
        world = start("palpate-world", *program, *urls, *seconds, *plan.world_arguments)
        if world.process.wait() != 0:
            raise world.fail(f"ended with code {world.process.returncode}")
        if daemon.process.poll() is not None:
            raise daemon.fail(f"ended with code {daemon.process.returncode}")
        daemon.end()
        time.sleep(0.2)  # the recorder's last datagrams
        recorder.end()
    finally:
        for program in programs:
            program.end()
    return RunFiles(folder)


def _start(control: str, housekeeping: str) -> None:
    with palpate.Daemon(control, housekeeping, timeout=_LONGEST) as daemon:
        daemon.start()


def _steer(control: str, housekeeping: str, target: Target) -> None:
    """Repeats the target while this process lives, as targets expire without."""
    with palpate.Daemon(control, housekeeping, timeout=_LONGEST) as daemon:
        daemon.target("point", target.place, points=[target.rest_point])


def replayed(plan: RunPlan, run: RunFiles, overrides: Sequence[str], folder: Path) -> RunFiles:
    """Another estimator on the same sensors: what palpated says then, with the recorded truth."""
    folder.mkdir(parents=True, exist_ok=True)
    answer = folder / "replay.lcmlog"
    sets = [word for text in (*plan.overrides, *overrides) for word in ("--set", text)]
    words = [plan.bin / "palpate-replay", run.control, "--config", plan.configuration, "--stepped"]
    _call([*words, *sets, "--output", answer])
    recorded = palpate.EventLog(run.housekeeping)
    truth = [event for event in recorded if event.channel.startswith("TRUTH_")]
    return _in_simulated_time([*truth, *palpate.EventLog(answer)], folder)


def _in_simulated_time(events: Sequence[palpate.Event], folder: Path) -> RunFiles:
    """Logs whose times of reception are those of the senders, without the users' messages, which
    do not run in simulated time: palpate-evaluate score goes by the time of reception."""
    files = RunFiles(folder)
    with palpate.EventLogWriter(files.control) as control:
        with palpate.EventLogWriter(files.housekeeping) as housekeeping:
            for event in sorted(events, key=_sent):
                entry = CHANNELS[_base(event.channel)]
                writer = control if entry.bus == "control" else housekeeping
                if entry.sender != "user":
                    writer.write(_sent(event), event.channel, event.data)
    return files


def _sent(event: palpate.Event) -> int:
    """us by the sender's clock: the first field after the fingerprint."""
    utime: int = struct.unpack_from(">q", event.data, 8)[0]
    return utime


def _base(channel: str) -> str:
    """Without the number of an arm or finger."""
    return channel if channel in CHANNELS else channel.rsplit("_", 1)[0]


def score(plan: RunPlan, files: RunFiles) -> dict[str, Any]:
    """Of the shape by palpate-evaluate score, on the truth."""
    folder = files.folder / "scored"
    folder.mkdir(exist_ok=True)
    events = [*palpate.EventLog(files.control), *palpate.EventLog(files.housekeeping)]
    timed = _in_simulated_time(events, folder)
    result = folder / "score.json"
    words: list[object] = [plan.bin / "palpate-evaluate", "--root", SOURCE, "score", "--control"]
    words += [timed.control, "--housekeeping", timed.housekeeping, "--json", result]
    _call([*words, "--scene", plan.scene])
    scores: dict[str, Any] = json.loads(result.read_text(encoding="utf-8"))
    return scores


def _call(words: Sequence[object]) -> None:
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    if done.returncode != 0:
        raise RunFailed(
            f"{words[0]} ended with code {done.returncode}:\n{done.stdout}{done.stderr}"
        )
