"""One drawn set-up: where the object is, what the arm and the camera get wrong, and the run."""

from __future__ import annotations

from typing import Any, Callable

import numpy as np
from numpy.typing import NDArray

from palpate_common.pose import Pose, difference
from palpate_common.rotations import exp_rotation
from palpate_common.surface import box_surface
from palpate_register.information import cramer_rao
from palpate_register.next_touch import Reach
from palpate_register.observations import Cloud, Guess, Observations, Touches
from palpate_register.register import Registration, register
from palpate_register.session import Session
from palpate_register.symmetry import Symmetries
from simulated_box import Box

Floats = NDArray[np.float64]
GUESS_CENTER = np.array([0.6, 0.0, 0.3])  # m, in W
POSITION_RANGE, ANGLE_RANGE = 0.05, np.radians(20)  # m, each axis; rad: of the object about the guess
TOUCH, NORMAL = 3e-4, np.radians(10)  # m, each axis; rad: errors of a touch, independent
HAND, HAND_ANGLE, TOOL = 5e-4, np.radians(0.2), 0.15  # m, rad, m: constant error of the flange's pose
CAMERA, CAMERA_ANGLE = 0.02, np.radians(1)  # m, in a random direction; rad, each axis
TABLE = 0.1  # m, in W
BEFORE, BEYOND = 0.15, 0.15  # m, of a guarded motion about the expected place
SPACING = 0.03  # m, between guarded motions that search
OBJECTS = {"bar": np.array([0.5, 0.06, 0.06]), "cube": np.array([0.06, 0.06, 0.06])}  # m
# The bar's end at x = 0 is clamped, as in rt/config/examples/bar_long_soft.yaml.
HIDDEN = {"bar": [(np.zeros(3), np.array([0.03, 0.06, 0.06]))], "cube": []}


class SetUp:
    """Draws of one seed; all methods use its generator in order."""

    def __init__(self, name: str, seed: int) -> None:
        self.random = np.random.default_rng([seed, *name.encode()])
        self.surface = box_surface(OBJECTS[name])
        self.reach = Reach(TABLE, hidden=HIDDEN[name])
        pose = Pose(np.eye(3), GUESS_CENTER - self.surface.center)
        self.guess = Guess(pose, POSITION_RANGE, ANGLE_RANGE)
        axis = self.random.normal(size=3)
        R = exp_rotation(self.random.uniform(0, ANGLE_RANGE) * axis / np.linalg.norm(axis))
        center = GUESS_CENTER + self.random.uniform(-POSITION_RANGE, POSITION_RANGE, 3)
        self.truth = Pose(R, center - R @ self.surface.center)
        self.box = Box(OBJECTS[name], R, self.truth.p)
        # With the hand's orientation kept, a constant error of the flange's pose shifts all touches.
        turn = HAND_ANGLE * self.random.normal(size=3)
        self.shift = HAND * self.random.normal(size=3) + np.cross(turn, [0, 0, -TOOL])
        self.feet: list[Floats] = []
        self.normals: list[Floats] = []
        self.misses = 0

    def touch(self, session: Session, of_position: bool) -> None:
        """One more touch: proposed, searched for around the place where it meets nothing."""
        for proposal in session.propose(of_position, count=3):
            for motion in [proposal, *proposal.shifted(SPACING)]:
                met = self.box.touched(motion.point - BEFORE * motion.approach, motion.approach, BEFORE + BEYOND)
                if met is None:
                    self.misses += 1
                    continue
                foot, normal = met
                self.feet.append(foot)
                self.normals.append(normal)
                error = exp_rotation(np.cross(normal, NORMAL * self.random.normal(size=3)))
                session.add(foot + self.shift + TOUCH * self.random.normal(size=3), error @ normal)
                return
        raise RuntimeError("no guarded motion met the object")

    def cloud(self) -> Cloud:
        """Seen by a camera in front and above, whose pose is wrong by a rigid motion."""
        direction = np.array([-0.6, -0.5, 0.6]) + self.random.uniform(-0.2, 0.2, 3)
        camera = GUESS_CENTER + 0.8 * direction / np.linalg.norm(direction)
        points = self.box.seen(camera, GUESS_CENTER, self.random)
        axis = self.random.normal(size=3)
        shift = CAMERA * axis / np.linalg.norm(axis)
        turn = exp_rotation(CAMERA_ANGLE * self.random.normal(size=3))
        middle = points.mean(axis=0)
        return Cloud(middle + shift + (points - middle) @ turn.T)

    def score(self, result: Registration, touches: Touches, symmetries: Symmetries) -> dict[str, Any]:
        """Errors of the centre, m, and angle, rad, among the poses that the symmetry makes alike."""
        arm = Pose(self.truth.R, self.truth.p + self.shift)  # where the arm, as it reports, would meet it
        pose = symmetries.nearest(result.pose, arm)
        error = difference(pose, arm, self.surface.center)
        absolute = difference(pose, self.truth, self.surface.center)
        bound = cramer_rao(self.surface, self.truth, touches, np.array(self.feet), np.array(self.normals))
        return {
            "error": error.tolist(),
            "deviation": result.deviations.tolist(),
            "absolute": absolute.tolist(),
            "bound": np.diag(bound).tolist(),
            "misses": self.misses,
            "fits": result.verdict.fits,
        }


def touched(name: str, seed: int, symmetries: Symmetries, touches: int = 12) -> dict[str, Any]:
    """A set-up registered by touches alone."""
    set_up = SetUp(name, seed)
    session = Session(set_up.surface, set_up.guess, set_up.reach, TOUCH, NORMAL)
    for _ in range(touches):
        set_up.touch(session, of_position=False)
    observed = Observations(session.touches, None, set_up.guess)
    scored = set_up.score(register(set_up.surface, observed, 60, 8, seed, symmetries), session.touches, symmetries)
    scored["touches"] = [session.touches.points.tolist(), session.touches.normals.tolist()]
    return scored


def everywhere(name: str, seed: int, symmetries: Symmetries, of_touched: dict[str, Any]) -> dict[str, Any]:
    """The touches of `touched` registered once more, by a search over all poses."""
    points, normals = (np.array(values) for values in of_touched["touches"])
    touches = Touches(points, normals, np.full(len(points), TOUCH), NORMAL)
    set_up = SetUp(name, seed)
    found = register(set_up.surface, Observations(touches), 200, 12, seed, symmetries)
    arm = Pose(set_up.truth.R, set_up.truth.p + set_up.shift)
    return {"error": difference(symmetries.nearest(found.pose, arm), arm, set_up.surface.center).tolist()}


def seen(name: str, seed: int, symmetries: Symmetries, touches: int = 4) -> dict[str, Any]:
    """A set-up registered by a cloud and touches that are chosen for the position."""
    set_up = SetUp(name, seed)
    cloud = set_up.cloud()
    by_cloud = register(set_up.surface, Observations(cloud=cloud, guess=set_up.guess), 60, 8, seed, symmetries)
    session = Session(set_up.surface, set_up.guess, set_up.reach, TOUCH, NORMAL, cloud, by_cloud.refined.state)
    for _ in range(touches):
        set_up.touch(session, of_position=True)
    observed = Observations(session.touches, cloud, set_up.guess)
    scored = set_up.score(register(set_up.surface, observed, 60, 8, seed, symmetries), session.touches, symmetries)
    before = difference(symmetries.nearest(by_cloud.pose, set_up.truth), set_up.truth, set_up.surface.center)
    scored["by_cloud_alone"] = before.tolist()
    return scored


RUNS: dict[str, Callable[..., dict[str, Any]]] = {"touched": touched, "seen": seen, "everywhere": everywhere}
