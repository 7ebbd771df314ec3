"""Step motion: the first 5 mm, commanded and measured."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from palpate_common.input_error import InputError
from palpate_setup.cell import configuration_of, daemon
from palpate_setup.project import Project
from palpate_setup.questions import NUMBER, NUMBERS, Question
from palpate_setup.steering import Steering, Track
from palpate_setup.step import Result, Setting, Step, Work

WAY = 0.005  # m, of the controlled point
SPEED = 0.01  # m/s, of the flange at most
LAG = 0.15  # s, by which a measured motion may be behind the commanded one
BEGUN, TURN_BEGUN = 0.002, 0.02  # m and rad, of motion, from which on its direction is compared
TURN = 0.01  # rad, of difference that is allowed
REACHED = 1.5e-3  # m
PATIENCE = 40.0  # s


class Motion(Step):
    name = "motion"
    title = "First motion"
    about = "The controlled point is moved by 5 mm, slowly and within the limits of the arm; what was commanded is compared with what the arm did."
    needs = ("wrist", "object", "registration", "material")

    def questions(self, project: Project) -> list[Question]:
        return [Question("direction", "Direction of the controlled point in O", NUMBERS, "", [0.0, 0.0, 1.0], -1, 1),
                Question("tolerance", "Difference that is allowed between commanded and measured way", NUMBER, "m", 1e-3, 1e-5, 0.1)]  # fmt: skip

    def run(self, work: Work) -> Result:
        direction = np.array(work.answers["direction"])
        if np.linalg.norm(direction) < 1e-6:
            raise InputError("direction: [0, 0, 0]; allowed: a length above 0")
        direction /= np.linalg.norm(direction)
        speed = min(SPEED, work.project.entry("channels")["answers"]["linear_speed"])
        base = configuration_of(work, "motion.yaml", [Setting("gate.linear_speed", speed, "of the first motion")])
        work.person.ready("Keep a hand on the emergency stop: the arm moves by about 5 to 15 mm.")
        with daemon(work, base) as (client, _):
            client.start()
            steering = Steering(client)
            start = steering.wait_for_value()
            work.person.say(f"moves the point by {1e3 * WAY:g} mm along {np.round(direction, 2).tolist()} in O")
            allowed = work.answers["tolerance"]

            def check() -> None:
                work.person.check()
                compare(steering, allowed, speed)

            left = steering.move((start + WAY * direction).tolist(), REACHED, PATIENCE, check)
            steering.rest(1.0, check)
            doubt = _doubt(client)
        commanded, measured = steering.commanded, steering.measured
        way, turn = _differences(steering)
        _plot(steering.track, work.folder / "motion.png")
        lines = [f"commanded motion of the flange: {_shown(commanded)} in W", f"measured motion: {_shown(measured)}",
                 f"difference {1e3 * way:.2f} mm and {np.degrees(turn):.2f} degrees; allowed {1e3 * allowed:g} mm, "
                 f"{np.degrees(TURN):.2g} degrees, and a tenth of the motion",
                 f"the point is {1e3 * left:.2f} mm from its target, as palpated estimates", doubt]  # fmt: skip
        if way > allowed + 0.1 * np.linalg.norm(commanded[:3]) or turn > TURN + 0.1 * np.linalg.norm(commanded[3:]):
            raise InputError(f"the arm did not do what was commanded: {lines[0]}; {lines[1]}")
        return Result(lines, [], [], [work.shown("motion.png")],
                      {"commanded": commanded.tolist(), "measured": measured.tolist(), "left": left})  # fmt: skip

    def skip(self, work: Work) -> Result:
        return Result(["not moved"])


def _differences(steering: Steering) -> tuple[float, float]:
    """Between measured and commanded motion: m and rad."""
    difference = steering.measured - steering.commanded
    return float(np.linalg.norm(difference[:3])), float(np.linalg.norm(difference[3:]))


def compare(steering: Steering, allowed: float, speed: float) -> None:
    """Raises InputError where the arm moves otherwise than commanded. allowed: m; speed: m/s, the largest."""
    commanded, measured = steering.commanded, steering.measured
    way, turn = _differences(steering)
    for part, difference, least, begun in ((slice(0, 3), way, allowed + LAG * speed, BEGUN), (slice(3, 6), turn, 2 * TURN, TURN_BEGUN)):
        size, done = float(np.linalg.norm(commanded[part])), float(np.linalg.norm(measured[part]))
        if max(size, done) < begun or difference <= least + 0.3 * size:
            continue
        hint = "it does not follow" if done < 0.3 * size else "check frame and sign of the driver's twist"
        raise InputError(f"stopped: commanded {_shown(commanded)}, measured {_shown(measured)} in W; {hint}")


def _doubt(client: Any) -> str:
    """What the test of the wrenches' consistency says."""
    subscription = client.control.subscribe("DISCREPANCY", queue=1)
    try:
        message = subscription.get(2.0)
    except TimeoutError:
        return "the wrenches have not been tested against the model"
    finally:
        client.control.unsubscribe(subscription)
    return "the wrenches contradict the model: palpate-top names probable causes" if message.inconsistent else (
        "the wrenches agree with the model")  # fmt: skip


def _shown(motion: Any) -> str:
    way = ", ".join(f"{1e3 * value + 0.0:.2f}" for value in motion[:3])
    turn = ", ".join(f"{value + 0.0:.2f}" for value in np.degrees(motion[3:]))
    return f"({way}) mm, ({turn}) degrees"


def _plot(track: Track, path: Path) -> None:
    os.environ.setdefault("MPLCONFIGDIR", tempfile.gettempdir())
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    time = np.array(track.time) - track.time[0]
    figure, (above, below) = pyplot.subplots(2, 1, figsize=(8, 6), sharex=True, layout="constrained")
    for i, (axis, colour) in enumerate(zip("xyz", ("tab:red", "tab:green", "tab:blue"))):
        above.plot(time, 1e3 * np.array(track.commanded)[:, i], "--", color=colour, label=f"{axis}, commanded")
        above.plot(time, 1e3 * np.array(track.position)[:, i], color=colour, label=f"{axis}, measured")
    above.set_ylabel("way of the flange in W, mm")
    above.legend(fontsize=8, ncols=3)
    below.plot(time, 1e3 * np.array(track.error), color="0.2")
    below.set(xlabel="time, s", ylabel="error of the point, mm")
    figure.savefig(path, dpi=110)
    pyplot.close(figure)
