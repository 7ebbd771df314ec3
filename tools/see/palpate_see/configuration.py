"""The configuration of palpate-see, and what it takes from palpated's."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Optional

from palpate_common.frames import rotation_and_position
from palpate_common.pose import Pose
from palpate_common.section import Mapping, Section, read_configuration_section
from palpate_see.camera_error import read_camera_error
from palpate_see.colour import ColourRange, read_colour
from palpate_see.crop import Crop, read_crop
from palpate_see.depth_images import Intrinsics, read_intrinsics
from palpate_see.edges import EdgeFilter, read_edges
from palpate_see.noise import read_noise
from palpate_see.obstacles import Obstacle, read_obstacles
from palpate_see.outliers import OutlierFilter, read_outliers
from palpate_see.point_error import PointError
from palpate_see.robot_body import RobotOptions, read_robot_options
from palpate_see.thinning import MOST, Thinning, read_thinning
from palpate_see.timing import Timing, read_timing

CONTROL_URL = "udpm://239.255.76.67:7667?ttl=0"  # palpate.CONTROL_URL, without the package
NEAREST, FARTHEST = 0.001, 100.0  # m


@dataclass(frozen=True, eq=False)
class Settings:
    """Of all steps; one that is None is left out.

    X_WC: pose of the camera. nearest, farthest: depth, m. least_points: of which an observation consists.
    control_url: of joint states and observations; clouds_url: of clouds, on `channel`. own_names: palpate's names of
    channels that have another one on the control URL, by that one.
    """

    X_WC: Pose
    nearest: float
    farthest: float
    least_points: int
    control_url: str
    clouds_url: str
    channel: str
    own_names: dict[str, str]
    intrinsics: Optional[Intrinsics]
    edges: EdgeFilter
    crop: Optional[Crop]
    colour: Optional[ColourRange]
    obstacles: list[Obstacle]
    robot: Optional[RobotOptions]
    outliers: Optional[OutlierFilter]
    thinning: Thinning
    timing: Timing
    error: PointError


def read_settings(path: Path) -> Settings:
    """Raises InputError."""
    top = read_configuration_section(path)
    palpated = Section(Mapping(), path)
    if top.has("configuration"):
        palpated = read_configuration_section(Path(top.file_of("configuration").parent, top.text("configuration")))
    depth, bus = top.optional("range"), top.optional("bus")
    control = bus.text("control", palpated.optional("bus").text("control", CONTROL_URL))
    of_obstacles = top.optional("obstacles")
    deviation = of_obstacles.number("deviation", 0, 0.1, 0.001)
    obstacles = read_obstacles(palpated, deviation) if of_obstacles.flag("remove", True) else []
    robot = read_robot_options(top.section("robot"), palpated.optional("robot")) if top.has("robot") else None
    _check_links(top, obstacles, robot)
    made = Settings(
        Pose(*rotation_and_position(top.section("camera_in_base"))),
        depth.number("nearest", NEAREST, FARTHEST, 0.3),
        depth.number("farthest", NEAREST, FARTHEST, 5.0),
        top.whole("least_points", 1, MOST, 20),
        control,
        bus.text("clouds", control),
        top.text("channel", "POINT_CLOUD"),
        {str(name): str(own) for own, name in palpated.optional("bus").optional("channels").values.items()},
        read_intrinsics(top.section("intrinsics")) if top.has("intrinsics") else None,
        read_edges(top.optional("edges")),
        read_crop(top.section("crop")) if top.has("crop") else None,
        read_colour(top.section("colour")) if top.has("colour") else None,
        obstacles,
        robot,
        read_outliers(top.optional("outliers")) if top.values.get("outliers") is not False else None,
        read_thinning(top.optional("thinning")),
        read_timing(top.optional("timing")),
        PointError(read_noise(top.optional("noise")), read_camera_error(top.optional("camera_error"))),
    )
    if made.nearest >= made.farthest:
        depth.fail("nearest", f"{made.nearest:g}; allowed: below farthest, {made.farthest:g}")
    for key in ("configuration", "robot", "intrinsics", "crop", "colour", "outliers"):
        top.text(key, "")  # is a known key, also where it is absent
    for section in (top, depth, bus, of_obstacles):
        section.check_unused()
    return made


def _check_links(top: Section, obstacles: list[Obstacle], robot: Optional[RobotOptions]) -> None:
    links = [] if robot is None else [robot.robot.root, *(joint.child for joint in robot.robot.joints)]
    for obstacle in obstacles:
        if obstacle.link is not None and obstacle.link not in links:
            top.fail("robot", f"has no link {obstacle.link}, which carries the obstacle {obstacle.name}; allowed: "
                              f"{', '.join(links) or 'a section robot'}")  # fmt: skip
