"""Touches by the robot: guarded motions of palpated, one after the other."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Optional

import numpy as np
from numpy.typing import NDArray

from palpate_common.input_error import InputError
from palpate_setup.cell import configuration_of, daemon
from palpate_setup.step import Setting, Work

if TYPE_CHECKING:
    from palpate.touch import Touch

Floats = NDArray[np.float64]
SPEED, DISTANCE, RETREAT = 0.005, 0.06, 0.01  # m/s, m, m: of the approach, its limit, and back
REST_SPEED = 0.02  # m/s, below which the accelerometer's noise is smoothed
MISSES = 5  # in a row
DOWN = np.array([0.0, 0.0, -1.0])


def settings(work: Work, guess: Setting) -> list[Setting]:
    """What palpated needs to touch with an empty hand: the pose of the object is not used."""
    answers = work.answers
    sensing = [dict(item) for item in next(s.value for s in reversed(work.project.settings()) if s.path == "sensing")]
    sensing[0].update(tare_at_start=True, rest_speed=REST_SPEED)
    control = {"provider": "kinematic", "law": "guarded_motion", "tip_in_grasp": answers["tip_in_grasp"],
               "tip_radius": answers["probe_radius"], "speed": SPEED, "distance": DISTANCE, "retreat": RETREAT,
               "force_play": answers["force_play"]}  # fmt: skip
    removed = ("grasp_box", "grasp_group", "grasp_at_rest", "grasp_stiffness")
    return [guess, Setting("sensing", sensing), Setting("contact", []), Setting("control", control),
            Setting("estimation", None), Setting("estimation.component", "force_driven"), Setting("estimation.variant", "repaired"),
            *(Setting(f"object.{key}", None) for key in removed)]  # fmt: skip


def row_of(touch: Touch, direction: Floats, least: float) -> list[float]:
    """Line of palpate-register's file: the tip's centre, the outward normal, the deviation (m, at least `least`)."""
    deviation = least if touch.point_deviation is None else max(touch.point_deviation, least)
    centre: Any = touch.centre
    return [*map(float, centre), *(-direction / np.linalg.norm(direction)).tolist(), deviation]


def touch_until_known(work: Work, guess: Setting, path: Path, propose: Callable[[], Optional[tuple[Floats, Floats]]]) -> None:
    """Makes the touches that were asked for and writes them to a file after each. The user brings the hand in front of each place;
    the approach itself is the daemon's. propose: from the file, the next place and the unit vector of its approach, in W; None:
    there is none. Raises InputError, also after several motions in a row that meet nothing."""
    rows: list[list[float]] = []
    place, direction, misses = "the object's upper side", DOWN, 0
    with daemon(work, configuration_of(work, "touches.yaml", settings(work, guess))) as (client, _):
        work.person.ready("Nothing may touch the empty hand: the force is tared.")
        client.start()
        while len(rows) < work.answers["count"]:
            work.person.ready(f"Touch {len(rows) + 1}: bring the tip some 20 mm in front of {place}; it will move along "
                              f"{np.round(direction, 2).tolist()} in W.")  # fmt: skip
            touch = client.touch(direction.tolist(), work.answers["touch_force"], progress=lambda _: work.person.check())
            if not touch.touched:
                misses += 1
                work.person.say(f"{touch.state}: {touch.reason}")
                if misses >= MISSES:
                    raise InputError(f"{MISSES} motions in a row have not touched anything; the last one: {touch.reason}")
                continue
            misses = 0
            rows.append(row_of(touch, direction, work.answers["deviation"]))
            work.person.say(f"touched {np.round(touch.point, 4).tolist()} m"
                            + (f", stiffness {touch.stiffness:.0f} N/m" if touch.stiffness else ""))  # fmt: skip
            with path.open("w", newline="") as file:
                csv.writer(file).writerows([["x", "y", "z", "nx", "ny", "nz", "deviation"], *rows])
            proposal = propose() if len(rows) < work.answers["count"] else None
            if proposal is None:
                break
            place, direction = f"{np.round(proposal[0], 3).tolist()} m in W", proposal[1]
