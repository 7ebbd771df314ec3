"""The robot's own geometry in W at the moment of an exposure."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Mapping, Optional, Sequence

from palpate_common.input_error import InputError
from palpate_common.pose import Pose
from palpate_common.section import Section
from palpate_see.joint_track import JointTrack
from palpate_see.kinematics import link_poses
from palpate_see.shapes import PlacedShape
from palpate_see.urdf import Robot, read_robot

LARGEST_ANGLE = 1000.0  # rad
LATEST, ALL = 20_000, 1 << 60  # states that are kept: 40 s at 500 Hz, and of a recording
Poses = Mapping[str, Pose]


@dataclass(frozen=True, eq=False)
class RobotOptions:
    """arm_joints, hand_joints: names in the order of ROBOT_STATE and HAND_STATE. arm_at_rest, hand_at_rest: rad, without
    messages. deviation: of a place on the robot's surface, m, by errors of its angles and geometry. most_gap_us: between an
    exposure and the nearest state."""

    robot: Robot
    arm_joints: list[str]
    hand_joints: list[str]
    arm_at_rest: Optional[list[float]]
    hand_at_rest: Optional[list[float]]
    deviation: float
    most_gap_us: int


class RobotBody:
    """Follows the states of arm and hand. keeps_all: of a recording, not only the latest."""

    def __init__(self, options: RobotOptions, keeps_all: bool = False) -> None:
        self.options = options
        most = ALL if keeps_all else LATEST
        self._arm = JointTrack(options.most_gap_us, options.arm_at_rest, most)
        self._hand = JointTrack(options.most_gap_us, options.hand_at_rest if options.hand_joints else [], most)

    def add_arm(self, utime: int, q: Sequence[float]) -> bool:
        """Angles of ROBOT_STATE, rad, at utime, us. False if they are not finite or beyond LARGEST_ANGLE, or if their number
        is not that of the arm's joints; raises InputError for such a number before the first state that fits."""
        return self._add(self._arm, "ROBOT_STATE", self.options.arm_joints, utime, q)

    def add_hand(self, utime: int, q: Sequence[float]) -> bool:
        """The same of HAND_STATE. One without angles is ignored."""
        if self.options.hand_joints and len(q):
            return self._add(self._hand, "HAND_STATE", self.options.hand_joints, utime, q)
        return True

    def _add(self, track: JointTrack, channel: str, names: list[str], utime: int, q: Sequence[float]) -> bool:
        if len(q) != len(names) and not track.has_states:
            raise InputError(f"{channel}: {len(q)} joints; {self.options.robot.path} has {len(names)}: {', '.join(names)}")
        if len(q) != len(names) or not all(abs(angle) <= LARGEST_ANGLE for angle in q):
            return False
        track.add(utime, q)
        return True

    def link_poses(self, utime: int) -> Optional[Poses]:
        """X_WL by link at utime, us; None while the angles then are not known."""
        arm, hand = self._arm.at(utime), self._hand.at(utime)
        if arm is None or hand is None:
            return None
        angles = dict(zip(self.options.arm_joints, arm.tolist())) | dict(zip(self.options.hand_joints, hand.tolist()))
        return link_poses(self.options.robot, angles)

    def placed(self, poses: Poses) -> list[PlacedShape]:
        """The shapes of all links at those poses."""
        return [PlacedShape(item.shape, poses[item.link].times(item.X_LS)) for item in self.options.robot.shapes]


def read_robot_options(section: Section, of_palpated: Section) -> RobotOptions:
    """Of section `robot`; urdf and flange are by default those of palpated's section. Raises InputError."""
    source = section if section.has("urdf") else of_palpated
    if not source.has("urdf"):
        section.fail("urdf", "is absent here and in palpated's configuration; required")
    robot = read_robot(Path(source.file_of("urdf").parent, source.text("urdf")))
    flange = section.text("flange", of_palpated.text("flange", "flange"))
    section.text("urdf", "")  # is a known key
    arm = _names(section, "arm_joints", robot, robot.arm_joints(flange))
    hand = _names(section, "hand_joints", robot, robot.hand_joints(flange))
    made = RobotOptions(
        robot,
        arm,
        hand,
        _angles(section, "arm_at_rest", len(arm)),
        _angles(section, "hand_at_rest", len(hand)),
        section.number("deviation", 0, 0.1, 0.002),
        round(1000 * section.number("most_gap_ms", 0.1, 10000, 50)),
    )
    section.check_unused()
    return made


def _names(section: Section, key: str, robot: Robot, usual: list[str]) -> list[str]:
    if not section.has(key):
        section.text(key, "")  # is a known key
        return usual
    values = section.values[key]
    names = section.names(key, len(values) if isinstance(values, list) else 0)
    free = [joint.name for joint in robot.joints if joint.is_free]
    for name in names:
        if name not in free:
            section.fail(key, f"{name}; allowed: {', '.join(free)}")
    return names


def _angles(section: Section, key: str, count: int) -> Optional[list[float]]:
    if section.has(key):
        return section.numbers(key, count, -LARGEST_ANGLE, LARGEST_ANGLE)
    section.text(key, "")  # is a known key
    return None
