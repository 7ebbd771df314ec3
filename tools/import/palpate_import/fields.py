"""What can be imported: the fields of each format, and the page about them."""

from __future__ import annotations

from dataclasses import dataclass

from palpate_common.input_error import WRONG_CONFIGURATION, InputError
from palpate_import.units import Dimension

MOST_POINTS = 256
FINGERTIPS = 5


@dataclass(frozen=True)
class Field:
    """One number of a message. effect: what it sets; alike for fields that belong together."""

    name: str
    dimension: Dimension
    required: bool
    effect: str


@dataclass(frozen=True)
class Format:
    """messages: their type, in words. pose: what a key `pose` or `fingertips` sets instead of columns; "" if it has none."""

    messages: str
    fields: tuple[Field, ...]
    pose: str = ""

    @property
    def names(self) -> list[str]:
        return [field.name for field in self.fields]

    def field(self, name: str) -> Field:
        return next(field for field in self.fields if field.name == name)


def _vector(prefix: str, dimension: Dimension, required: bool, effect: str) -> list[Field]:
    return [Field(prefix + axis, dimension, required, effect) for axis in "xyz"]


def _quaternion(prefix: str, required: bool, effect: str) -> list[Field]:
    return [Field(f"{prefix}q{axis}", Dimension.NONE, required, effect) for axis in "wxyz"]


def _numbered(prefix: str, first: int, count: int, dimension: Dimension, effect: str) -> list[Field]:
    return [Field(f"{prefix}{i}", dimension, False, effect) for i in range(first, first + count)]


def _fingertips() -> list[Field]:
    fields = []
    for i in range(FINGERTIPS):
        fields += _vector(f"f{i}p", Dimension.LENGTH, False, f"position of fingertip {i} in the flange's frame")
        fields += _quaternion(f"f{i}", False, f"orientation of fingertip {i} in the flange's frame, unit quaternion")
    return fields


def _markers() -> list[Field]:
    effect = "points of one row, in the robot's base; an empty cell or nan is a point that was not seen"
    return [Field(f"{axis}{i}", Dimension.LENGTH, False, effect) for axis in "xyz" for i in range(1, MOST_POINTS + 1)]


FORMATS = {
    "biotac": Format("`biotac_t`, for example on `BIOTAC_0`", (
        *_numbered("e", 1, 19, Dimension.NONE, "electrodes, counts; all of them or none"),
        *_numbered("pac", 0, 22, Dimension.NONE, "dynamic pressure, counts, oldest first; without gaps from `pac0` on"),
        Field("pdc", Dimension.NONE, False, "static pressure, counts"),
        Field("tac", Dimension.NONE, False, "thermal flux, counts; valid with `tdc` only"),
        Field("tdc", Dimension.NONE, False, "temperature, counts; valid with `tac` only"))),
    "force_torque": Format("`ft_wrench_t`, for example on `FT_WRENCH`", (
        *_vector("f", Dimension.FORCE, True, "force of the sensor on its load, in the sensor's frame"),
        *_vector("t", Dimension.TORQUE, True, "torque of the sensor on its load, about the sensor's origin")),
        "pose of the sensor in the robot's base, whose axes the columns are in"),
    "hand_state": Format("`hand_state_t`, for example on `HAND_STATE`", (
        Field("grasp", Dimension.NONE, False, "0: none, 1: holding, 2: slipping"),
        *_numbered("q", 1, 32, Dimension.ANGLE, "joint positions; the last one that has a column sets the joint count"),
        *_fingertips()),
        "poses of fingertips in the flange's frame, in turn"),
    "imu": Format("`imu_t`, for example on `IMU`", (
        *_vector("a", Dimension.ACCELERATION, True, "specific force in the unit's frame: at rest minus gravity"),
        *_vector("w", Dimension.ANGULAR_SPEED, False, "angular velocity in the unit's frame"))),
    "robot_state": Format("`robot_state_t`, for example on `ROBOT_STATE`", (
        *_vector("p", Dimension.LENGTH, True, "position of the flange in the robot's base"),
        *_quaternion("", True, "orientation of the flange in the base, unit quaternion"),
        *_vector("v", Dimension.SPEED, False, "linear velocity of the flange's origin, in the base's axes"),
        *_vector("w", Dimension.ANGULAR_SPEED, False, "angular velocity of the flange, in the base's axes"),
        *_numbered("q", 1, 16, Dimension.ANGLE, "joint positions; the last one that has a column sets the joint count"),
        *_numbered("dq", 1, 16, Dimension.ANGULAR_SPEED, "joint velocities"),
        *_numbered("tau", 1, 16, Dimension.TORQUE, "joint torques")),
        "pose of the flange in the robot's base"),
    "shape_observation": Format("`shape_observation_t`, for example on `SHAPE_OBSERVATION`", (
        *_vector("", Dimension.LENGTH, False, "a point of the surface, in the robot's base; rows of one time are one message"),
        Field("deviation", Dimension.LENGTH, True, "standard deviation of each coordinate"),
        *_markers())),
}  # fmt: skip


def format_of(name: str) -> Format:
    """Raises InputError listing the formats."""
    if name not in FORMATS:
        raise InputError(f"unknown format '{name}'; allowed: {', '.join(FORMATS)}", WRONG_CONFIGURATION)
    return FORMATS[name]


def _names_of(fields: tuple[Field, ...]) -> str:
    """ "`fx`, `fy`, `fz`", or, of more than four, "`q1` to `q16`"."""
    if len(fields) <= 4:
        return ", ".join(f"`{field.name}`" for field in fields)
    starts = [i for i, field in enumerate(fields) if i == 0 or field.name[0] != fields[i - 1].name[0]]
    parts = [fields[a:b] for a, b in zip(starts, [*starts[1:], len(fields)])]
    return ", ".join(f"`{part[0].name}` to `{part[-1].name}`" for part in parts)


def _table(name: str) -> str:
    fields = FORMATS[name].fields
    lines = [f"## {name}", "", f"Messages of type {FORMATS[name].messages}.", "", "| field | unit (others) | required | effect |",
             "| --- | --- | --- | --- |"]  # fmt: skip
    begin = 0
    while begin < len(fields):
        first, end = fields[begin], begin
        while end < len(fields) and fields[end].effect == first.effect:
            end += 1
        cells = [_names_of(fields[begin:end]), first.dimension.text, "yes" if first.required else "no", first.effect]
        lines.append(f"| {' | '.join(cells)} |")
        begin = end
    if FORMATS[name].pose:
        key = "fingertips" if name == "hand_state" else "pose"
        lines.append(
            f"| key `{key}` of a description | | no | {FORMATS[name].pose}: [a form](../tools/import/README.md#poses) |"
        )
    return "\n".join(lines) + "\n"


def formats_page() -> str:
    """docs/import.md."""
    head = """# Formats of palpate-import

Made by `palpate-import --formats`; do not edit. Descriptions of several files, poses, clocks, MCAP and ROS 2 bags:
[tools/import](../tools/import/README.md).

A recording is a file of delimited values (comma, semicolon, tab or blanks; quotes as in RFC 4180), plain or compressed by gzip, with a line of
names; or topics of an MCAP file or a ROS 2 bag. Comments begin with `#`, `%` or `//`. Names may have units, `fx [mN]`, or a line of units below.
A field takes the column of its own name, in the unit that the file states, else in the first one of its row.
`--column FIELD=[-]COLUMN[:UNIT]` takes another column, with the opposite sign, or in one of the other units; `--column FIELD==CONSTANT` sets a
constant in the first unit. A field that is not required and has no column is zero.
The column `t` holds the time in seconds; `--time-column` and `--time-unit` name another column and unit, and `--rate` replaces it. A topic
without a time column has the times of its messages in the file.
"""
    return head + "".join("\n" + _table(name) for name in FORMATS)
