"""The runs of the golden set, and where their files may lie."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

# Where the files of a case lie below the root.
SCENES = ("sim/scenes",)
CONFIGURATIONS = ("rt/config/examples",)
OTHERS = ("sim/robot", "tools/lab/studies/published_sensing_models")


def find(root: Path, name: str, folders: tuple[str, ...]) -> str:
    for folder in folders:
        if (root / folder / name).is_file():
            return str(root / folder / name)
    raise FileNotFoundError(f"{name} is in none of these folders of {root}: {', '.join(folders)}")


def with_files(setting: str, root: Path) -> str:
    """{NAME.EXTENSION} becomes the path of that file of OTHERS."""
    return re.sub(r"\{(\w+\.\w+)\}", lambda match: find(root, match[1], OTHERS), setting)


@dataclass(frozen=True)
class Case:
    """A run; its settings may name a file as {NAME.EXTENSION}."""

    scene: str
    configuration: str
    duration: float  # s, simulated
    about: str
    simulator: tuple[str, ...] = ()
    daemon: tuple[str, ...] = ()
    target: tuple[float, ...] = ()  # target of point (m, in O)
    point: tuple[float, ...] = (0.25, 0.03, 0.06)  # of the rest shape


FILTER = "estimation.component=pose_wrench_filter"
STEER = ("control.linear_speed=0.08", "control.dead_band_mm=0.1", "control.dead_band_deg=0.1")
PROGRAM = (*STEER, "control.gain=3", "control.law=quadratic_program", FILTER)
EYE = "camera={truth_segmentation: true, eye: [1.1, -0.7, 0.8], occlusions: [{at: 2.5, duration: 0.7}]}"
KINECT = "sensors.camera={rate: 30, depth: {noise: 1, disparity_step: 0.125, edge_loss: 0.5}}"
CAMERA = "sensors.camera={rate: 30, depth: {noise: 0.15, disparity_step: 0.02}}"
MARKERS = ("markers.noise=0.001", "markers.delay=0.06", "markers.drop_out=0.1")
RIGID = "deformation={component: as_rigid_as_possible}"
BASELINES = "plugins=[{library: palpate-baselines.so}]"
LIFTED, PULLED = (0.25, 0.03, 0.10), (0.265, 0.03, 0.06)

CASES = {
    "bar_poses": Case("bar_long_soft_six_poses", "bar_long_soft", 9,
        "six poses, the first two: soft bar, the default filter", daemon=(FILTER,)),
    "block_poses": Case("block_soft_six_poses", "block_soft", 5,
        "six poses, the first: soft block, the default filter", daemon=(FILTER,)),
    "bar_hard_dynamic": Case("bar_long_hard_six_poses", "bar_long_hard", 3,
        "on the way to the first pose: hard bar, by the pose alone, dynamic model",
        daemon=("deformation={component: corotational_dynamic}",)),
    "control_z": Case("bar_long_soft_control", "bar_long_soft", 4,
        "quadratic program along Z, blind, filter", daemon=PROGRAM, target=LIFTED),
    "control_x_joints": Case("bar_long_soft_control", "bar_long_soft_limits", 3,
        "quadratic program along X with all limits, commanding joints", target=PULLED,
        daemon=(FILTER, "control.command=joint_velocity", "robot={urdf: {lwr_hand.urdf}, flange: flange}")),
    "poke": Case("bar_long_soft_poke", "bar_long_soft", 9.5,
        "a push that nothing measures, and after it", daemon=(FILTER,)),
    "camera": Case("bar_long_soft_control_camera", "bar_long_soft", 4,
        "quadratic program before a camera that is covered for a while", target=LIFTED,
        daemon=PROGRAM, simulator=(EYE, CAMERA)),
    "tactile": Case("cube_hard_tactile", "cube_hard_tactile", 7,
        "fingertips on a cube, closed and squeezed"),
    "two_arms": Case("bar_two_hands_control", "bar_two_hands", 3,
        "a bar between two arms, both steered, filter", daemon=(FILTER,), target=LIFTED),
    "control_broyden": Case("bar_long_soft_control_markers", "bar_long_soft", 5,
        "published controller [44], probes and markers", target=LIFTED, simulator=MARKERS,
        daemon=(*STEER, BASELINES, "control.gain=3.2", "control.provider=broyden", "control.vision=markers")),
    "control_diminishing": Case("bar_long_soft_control_markers", "bar_long_soft", 4,
        "published controller [43], markers", target=LIFTED, simulator=MARKERS,
        daemon=(*STEER, BASELINES, "control.gain=3.5", "control.provider=diminishing_rigidity",
                "control.vision=markers")),
    "sensing_cloud": Case("bar_long_soft_six_poses", "bar_long_soft", 4,
        "published sensing [33], finite elements drawn to a noisy cloud", simulator=(EYE, KINECT),
        daemon=("estimation={component: cloud_driven_fem, hand: true, spring_stiffness: 790.5, "
                "spring_damping: 12.3, observation_reach: 0.0168}", "deformation={component: corotational_dynamic}", BASELINES)),
    "sensing_matching": Case("bar_long_soft_six_poses", "bar_long_soft", 4,
        "published sensing [34], shape matching", simulator=(EYE, KINECT),
        daemon=("estimation={component: shape_matching_fit, regions: 5, iterations: 2, rigidity: 0.127}", RIGID, BASELINES)),
    "sensing_learned": Case("block_soft_six_poses", "block_soft", 4,
        "published sensing [28], a network read from a file", simulator=(EYE, KINECT),
        daemon=("estimation={component: learned_shape, model: {block_soft_position.yaml}}", RIGID, BASELINES)),
}  # fmt: skip
