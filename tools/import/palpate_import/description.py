"""What a description in YAML says about recordings; a preset is a description that comes with the program."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Optional

from palpate_common.input_error import WRONG_CONFIGURATION, InputError
from palpate_common.section import Section, merged, read_section
from palpate_import.csv_head import DELIMITERS
from palpate_import.csv_table import CsvOptions
from palpate_import.fields import FINGERTIPS, FORMATS
from palpate_import.input_values import expanded
from palpate_import.pose_forms import PoseForm, read_form
from palpate_import.streams import StreamDescription
from palpate_import.units import TIMES

PRESETS = Path(__file__).resolve().parents[1] / "presets"
LONGEST_OFFSET, LARGEST_DEVIATION = 3600.0, 10.0  # s
HIGHEST_RATE = 1e6  # Hz
KEYS = ("file", "preset", "delimiter", "comment", "header", "time_column", "time_unit", "rate", "start", "where", "optional", "clock",
        "streams")  # fmt: skip


@dataclass(frozen=True)
class ClockFit:
    """The offset of a file's clock is fitted so that `quantity` of one of its channels moves with `follows` of another file's.
    within: s, largest offset that is sought. deviation: s, largest standard deviation that is accepted."""

    quantity: str
    follows: str
    within: float = 2.0
    deviation: float = 0.01


@dataclass
class FileDescription:
    """file: None: a recording of the command line. time_column: "" : of topics, the times in the file. time_unit: None: that
    which the head states, or s. rate: Hz, above 0: rows without times. start: s, added to every time."""

    file: Optional[Path] = None
    csv: CsvOptions = field(default_factory=CsvOptions)
    time_column: Optional[str] = None
    time_unit: Optional[str] = None
    rate: float = 0.0
    start: float = 0.0
    where: dict[str, str] = field(default_factory=dict)
    streams: list[StreamDescription] = field(default_factory=list)
    clock: Optional[ClockFit] = None
    optional: bool = False


@dataclass(frozen=True)
class Defaults:
    """Of the command line, where a description states nothing. folder: of the files that a description names."""

    folder: Path
    urdf: Optional[Path] = None
    flange: str = ""
    file: FileDescription = field(default_factory=FileDescription)


def preset_names() -> list[str]:
    return sorted(path.stem for path in PRESETS.glob("*.yaml"))


def preset_file(name: str) -> Path:
    """Raises InputError listing the presets."""
    if name not in preset_names():
        raise InputError(f"unknown preset '{name}'; allowed: {', '.join(preset_names())}", WRONG_CONFIGURATION)
    return PRESETS / f"{name}.yaml"


def read_description(root: Section, defaults: Defaults) -> list[FileDescription]:
    """The files of a description. Raises InputError."""
    if not root.has("files"):
        files = [_file(root, defaults)]
    else:
        files = [_file(section, defaults) for section in root.sections("files")]
        if not files:
            root.fail("files", "[]; allowed: one file or more")
    root.check_unused()
    return files


def _with_preset(section: Section) -> Section:
    """With the keys of its preset where it has none of its own."""
    if not section.has("preset"):
        return section
    name = section.choice("preset", preset_names())
    below = read_section(preset_file(name))
    if below.has("files"):
        section.fail("preset", f"{name} is of several files; allowed: those of one file")
    values = merged(below.values, section.values)
    values.pop("preset")
    return Section(values, section.file, section.path)


def _file(section: Section, defaults: Defaults) -> FileDescription:
    own, of = _with_preset(section), defaults.file
    for key in KEYS:
        own.raw(key, None)  # an unknown key is compared with all of them
    header = own.raw("header", None)
    if header is not None and (not isinstance(header, list) or not header):
        own.fail("header", f"{header!r}; allowed: a list of names")
    delimiter = own.choice("delimiter", ["auto", *DELIMITERS], "auto")
    made = FileDescription(
        file=defaults.folder / own.text("file") if own.has("file") else None,
        csv=CsvOptions(of.csv.delimiter if of.csv.delimiter != "auto" else delimiter,
                       own.text("comment") if own.has("comment") else None,
                       None if header is None else [str(name) for name in header]),
        time_column=own.text("time_column") if own.has("time_column") else of.time_column,
        time_unit=own.choice("time_unit", list(TIMES)) if own.has("time_unit") else of.time_unit,
        rate=own.number("rate", 0, HIGHEST_RATE, of.rate),
        start=own.number("start", -1e12, 1e12, of.start),
        where={**of.where, **_texts(own, "where")},
        optional=own.flag("optional", False),
    )  # fmt: skip
    if own.has("clock"):
        made.clock = _clock(own.section("clock"))
    made.streams = [_stream(one, defaults) for one in own.sections("streams")]
    if not made.streams:
        own.fail("streams", "[]; allowed: one stream or more")
    own.check_unused()
    for key in section.values:
        section.raw(key)  # has been checked through `own`
    return made


def _texts(section: Section, key: str) -> dict[str, str]:
    below = section.optional(key)
    return {name: below.text(name) for name in below.values}


def _columns(section: Section, key: str) -> dict[str, str]:
    """Fields and columns; "q{1..6}": "actual_q_{0..5}" stands for six of them."""
    made: dict[str, str] = {}
    for name, text in _texts(section, key).items():
        names, texts = expanded(name), expanded(text)
        if len(texts) == 1:
            texts = texts * len(names) if text.startswith("=") else texts
        if len(names) != len(texts):
            section.optional(key).fail(name, f"{text}: {len(texts)} columns for {len(names)} fields; allowed: as many")
        made.update(zip(names, texts))
    return made


def _forms(section: Section, key: str, defaults: Defaults, folder: Path) -> list[PoseForm]:
    raw = section.raw(key, None)
    if raw is None:
        return []
    sections = section.sections(key) if isinstance(raw, list) else [section.section(key)]
    return [read_form(one, folder, defaults.urdf, defaults.flange) for one in sections]


def _stream(section: Section, defaults: Defaults) -> StreamDescription:
    kind = section.choice("format", list(FORMATS))
    folder = section.file.parent
    made = StreamDescription(section.text("channel"), kind, _columns(section, "columns"), _columns(section, "optional_columns"),
                             optional=section.flag("optional", False), topic=section.text("topic", ""),
                             time_column=section.text("time_column") if section.has("time_column") else None)  # fmt: skip
    if kind in ("robot_state", "force_torque"):
        made.poses = _forms(section, "pose", defaults, folder)
        for form in made.poses:
            if kind == "robot_state" and form.kind not in ("matrix", "joints") and not form.section.has("position"):
                form.section.fail("position", "is absent; required")
    if kind == "hand_state":
        made.fingertips = _forms(section, "fingertips", defaults, folder)
        if len(made.fingertips) > FINGERTIPS:
            section.fail("fingertips", f"{len(made.fingertips)} poses; allowed: at most {FINGERTIPS}")
    section.check_unused()
    return made


def _clock(section: Section) -> ClockFit:
    made = ClockFit(section.text("quantity"), section.text("follows"),
                    section.number("within", 1e-3, LONGEST_OFFSET, ClockFit.within),
                    section.number("deviation", 1e-6, LARGEST_DEVIATION, ClockFit.deviation))  # fmt: skip
    section.check_unused()
    return made
