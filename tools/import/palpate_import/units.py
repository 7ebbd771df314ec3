"""Dimensions of what a message holds, and the units that a column may have."""

from __future__ import annotations

import math
import re
from enum import Enum
from typing import Optional


class Dimension(Enum):
    """Value: factors to SI by unit."""

    FORCE = {"N": 1.0, "kN": 1e3, "mN": 1e-3}
    TORQUE = {"Nm": 1.0, "Nmm": 1e-3, "mNm": 1e-3}
    LENGTH = {"m": 1.0, "cm": 1e-2, "mm": 1e-3}
    ANGLE = {"rad": 1.0, "deg": math.pi / 180}
    SPEED = {"m/s": 1.0, "mm/s": 1e-3}
    ANGULAR_SPEED = {"rad/s": 1.0, "deg/s": math.pi / 180}
    ACCELERATION = {"m/s2": 1.0, "g": 9.80665, "mg": 9.80665e-3}
    AREA = {"m2": 1.0, "cm2": 1e-4, "mm2": 1e-6}
    NONE = {"1": 1.0}

    @property
    def text(self) -> str:
        """The units, SI first: "N (kN, mN)"; "-" where there is none."""
        if self is Dimension.NONE:
            return "-"
        si, *others = self.value
        return f"{si} ({', '.join(others)})"

    def factor(self, unit: str) -> Optional[float]:
        """To SI; None for a unit of something else."""
        factors: dict[str, float] = self.value
        return factors.get(unit)

    @property
    def listed(self) -> str:
        return ", ".join(sorted(self.value))


TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}

# As files write them.
_SPELLINGS = {
    "N·m": "Nm", "N*m": "Nm", "N.m": "Nm", "N m": "Nm", "N-m": "Nm", "N·mm": "Nmm", "N mm": "Nmm", "mN·m": "mNm", "mN m": "mNm",
    "m/s^2": "m/s2", "m/s²": "m/s2", "m/s/s": "m/s2", "m^2": "m2", "m²": "m2", "mm^2": "mm2", "mm²": "mm2", "cm²": "cm2", "cm^2": "cm2",
    "°": "deg", "degree": "deg", "degrees": "deg", "°/s": "deg/s", "dps": "deg/s", "radian": "rad", "radians": "rad",
    "sec": "s", "seconds": "s", "µs": "us", "μs": "us", "msec": "ms", "usec": "us", "nsec": "ns", "-": "1",
}  # fmt: skip
_KNOWN = {unit for dimension in Dimension for unit in dimension.value} | set(TIMES)
_IN_BRACKETS = re.compile(r"^(?P<name>.*\S)\s*(?:\[(?P<square>[^][]*)\]|\((?P<round>[^()]*)\))$")


def unit_of(text: str) -> Optional[str]:
    """The unit that a text names, with or without brackets; None if it names none."""
    word = text.strip()
    if len(word) > 1 and (word[0], word[-1]) in (("[", "]"), ("(", ")")):
        word = word[1:-1].strip()
    word = _SPELLINGS.get(word, word)
    return word if word in _KNOWN else None


def name_and_unit(cell: str) -> tuple[str, Optional[str]]:
    """ "fx [N]", "fx (N)": a name and its unit. In what is no unit, such as q[0], the brackets belong to the name."""
    found = _IN_BRACKETS.match(cell)
    if found is None:
        return cell, None
    inside = found["square"] if found["square"] is not None else found["round"]
    # "q[1]" names an element: of the units only the one of numbers without a dimension reads so.
    unit = unit_of(inside)
    if unit is None or inside.strip() == "1":
        return cell, None
    return found["name"], unit
