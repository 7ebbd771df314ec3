"""franka-sim's server with its MuJoCo simulation of an FR3, enforcing what the arm enforces.

usage: serve_franka_sim.py PORT FOLDER

The arm's inertias and joints are those of the URDF in the package; MuJoCo's own model of the arm would
be downloaded.
"""

from __future__ import annotations

import logging
import os
import sys
import xml.etree.ElementTree as xml
from pathlib import Path

import franka_sim

ROTOR = 0.6  # kg m^2, of each joint, about that of the real ones; with less its velocity servo oscillates


def write_model(path: Path) -> None:
    """Without meshes; MJCF, as a URDF has no inertia of rotors, without which the joints oscillate."""
    import mujoco

    tree = xml.parse(Path(franka_sim.__file__).parent / "models/fr3.urdf")
    for link in tree.getroot().iter("link"):
        for part in [*link.findall("visual"), *link.findall("collision")]:
            link.remove(part)
    spec = mujoco.MjSpec.from_string(xml.tostring(tree.getroot(), encoding="unicode"))
    for joint in spec.joints:
        joint.armature = ROTOR
    spec.compile()
    path.write_text(spec.to_xml())


def main() -> None:
    port, model = int(sys.argv[1]), Path(sys.argv[2]) / "fr3.xml"
    logging.basicConfig(level=logging.INFO)
    write_model(model)
    os.environ["FR3_MJCF"] = str(model)
    from franka_sim.franka_sim_server import FrankaSimServer

    FrankaSimServer(
        "127.0.0.1", port, enable_gripper=False, enforce_comm_constraints=True, enforce_motion_limits=True
    ).start()


if __name__ == "__main__":
    main()
