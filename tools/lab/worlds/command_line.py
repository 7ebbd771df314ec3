"""What the programs of this folder have in common on their command lines."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import NoReturn

SOURCE = Path(__file__).resolve().parents[3]


class Parser(argparse.ArgumentParser):
    """Keeps the description's lines; a wrong command line ends with 64."""

    def __init__(self, prog: str, description: str | None) -> None:
        super().__init__(
            prog, description=description, formatter_class=argparse.RawDescriptionHelpFormatter
        )

    def error(self, message: str) -> NoReturn:
        print(f"{self.prog}: {message}; see --help", file=sys.stderr)
        sys.exit(64)


def positive(text: str) -> float:
    """A number above 0."""
    try:
        value = float(text)
    except ValueError:
        value = 0
    if not value > 0:
        raise argparse.ArgumentTypeError(f"{text} is not a number above 0")
    return value


def plant_period(text: str) -> float:
    """s, a divisor of the 10 ms between two true shapes."""
    value = positive(text)
    if not any(abs(value - allowed) < 1e-9 for allowed in (0.001, 0.002, 0.005, 0.01)):
        raise argparse.ArgumentTypeError(f"{text}; allowed: 0.001, 0.002, 0.005, 0.01 s")
    return value


def add_plant_options(parser: Parser) -> None:
    """--world and what determines its plant."""
    parser.add_argument("--world", required=True, choices=("drake", "mujoco"))
    parser.add_argument(
        "--cells",
        type=int,
        nargs=3,
        metavar=("X", "Y", "Z"),
        help="cells along each side; default: about cubic, 20 (MuJoCo) or 40 (Drake) along the "
        "longest. Drake takes the tetrahedra of object.mesh as they are",
    )
    parser.add_argument(
        "--period",
        type=plant_period,
        metavar="S",
        help="of a step of the plant: 0.001, 0.002, 0.005 or 0.01; default: 0.002 (MuJoCo), "
        "0.01 (Drake)",
    )
    parser.add_argument(
        "--damping",
        type=positive,
        metavar="S",
        help="proportional to stiffness; default: 0.02 (MuJoCo), 0.2 (Drake)",
    )


def find_palpate() -> None:
    """Takes the package from the build tree, unless it is installed or on PYTHONPATH."""
    try:
        import palpate  # noqa: F401
    except ImportError:
        sys.path.append(str(SOURCE / "build/release/python"))
