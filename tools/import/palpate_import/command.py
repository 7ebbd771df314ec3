"""Command line of palpate-import. Imports nothing slow, so that --help comes at once."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any, Optional, Sequence

from palpate_common.command_line import Number, Parser, exit_code_of
from palpate_import.csv_head import DELIMITERS
from palpate_import.description import HIGHEST_RATE, PRESETS, preset_names
from palpate_import.fields import FORMATS, formats_page
from palpate_import.units import TIMES

DESCRIPTION = """Turns recordings into one LCM log: CSV files, plain or .gz, MCAP files (JSON, ROS 2 CDR) and ROS 2 bags. States
what it understood, channel by channel, and with --preview draws it."""

EPILOGUE = """One of --preset, --map and --format says what the columns are. A description (--map, tools/import/README.md) may name
several files, each with a clock of its own, poses in other forms, and offsets of clocks that are fitted to the data. MCAP
files and ROS 2 bags need the Python packages mcap and rosbags; an error says how to install them.

Examples:
  palpate-import wrist.csv --format force_torque --channel FT_WRENCH -o wrist.log
  palpate-import run.csv --preset ur_rtde --preview run.png
  palpate-import run.csv --preset libfranka --urdf fr3.urdf --flange fr3_link8 -o run.log
  palpate-import bag --topic /wrench --format force_torque --channel FT_WRENCH --column fx=wrench.force.x ... -o wrist.log
  palpate-import --map run.yaml -o run.log --preview run.png
Exit codes: 0   done
            1   an error of a recording; the message names file, line or message, and column
            64  wrong command line
            78  wrong description; the message names file, line, key, value and allowed values"""


class _Print(argparse.Action):
    """Prints a text and ends."""

    def __init__(self, option_strings: Sequence[str], dest: str, nargs: Any = 0, **kwargs: Any) -> None:
        super().__init__(option_strings, dest, nargs=nargs, **kwargs)

    def __call__(
        self, parser: argparse.ArgumentParser, namespace: argparse.Namespace, values: Any, option_string: Optional[str] = None
    ) -> None:
        text = formats_page() if option_string == "--formats" else (PRESETS / f"{values}.yaml").read_text(encoding="utf-8")
        print(text, end="")
        parser.exit(0)


def parser() -> Parser:
    """Of the command line."""
    made = Parser("palpate-import", DESCRIPTION, "[OPTIONS] [recording...]", EPILOGUE)
    add = made.add_argument
    add(
        "recording",
        nargs="*",
        help="CSV or MCAP file, ROS 2 bag; of a description those files that it does not name, in turn, or their folder",
    )
    add("-o", "--output", type=Path, help="LCM log to write; required but with --preview")
    add("--preset", choices=preset_names(), help="Recording whose columns are known")
    add(
        "--show-preset",
        action=_Print,
        nargs=None,
        choices=preset_names(),
        help="Print a preset, as a start of an own description",
    )
    add("--map", type=Path, help="YAML: files and streams of {channel, format, columns, ...}")
    add("--format", choices=list(FORMATS), help="Message type; --formats lists their fields")
    add("--channel", help="LCM channel of --format")
    add("--topic", help="Topic of --format, of an MCAP file or a bag")
    add(
        "--column",
        action="append",
        default=[],
        help="FIELD=[-]COLUMN[:UNIT] or FIELD==CONSTANT; fields without one take the column of their name, in SI",
    )
    add("--urdf", type=Path, help="Robot of poses from joint angles, where the description names none")
    add("--flange", help="Its link that is the flange")
    add("--delimiter", choices=["auto", *DELIMITERS], default="auto", help="Between cells; auto: found from the header line")
    add("--time-column", help="Column of the time; absent: t, and of topics the times in the file")
    add("--time-unit", choices=list(TIMES), help="Its unit; absent: that in the head of the file, or s")
    add("--rate", type=Number(1e-6, HIGHEST_RATE), help="Rows per second, for a file without times")
    add("--start", type=float, default=0.0, help="Seconds added to every time")
    add("--where", action="append", default=[], help="COLUMN=TEXT: only rows that read so")
    add("--preview", type=Path, help="Picture of what was understood (.png, .svg, .pdf), before anything is written")
    add("--session", type=int, help="Session of the messages; absent: random")
    add("--json", help="Write a summary; - for the standard output")
    add("--formats", action=_Print, help="Print the fields of each --format with unit and effect, and whether it is required")
    return made


def parse(words: list[str], version: str) -> argparse.Namespace:
    """Options that agree with each other; ends with 64 otherwise."""
    made = parser()
    made.add_argument("--version", action="version", version=version, help="Display program version information and exit")
    options = made.parse_args(words)
    kinds = [f"--{name}" for name in ("preset", "map", "format") if getattr(options, name)]
    if len(kinds) != 1:
        made.error(f"{' and '.join(kinds)} exclude each other" if kinds else "one of --preset, --map, --format is needed")
    if bool(options.format) != bool(options.channel):
        made.error(f"{'--format' if options.format else '--channel'} requires {'--channel' if options.format else '--format'}")
    for name in ("column", "topic"):
        if getattr(options, name) and not options.format:
            made.error(f"--{name} requires --format")
    if not options.output and not options.preview:
        made.error("--output is required, or --preview")
    if options.preview and options.preview.suffix.lower() not in (".png", ".svg", ".pdf"):
        made.error(f"--preview {options.preview}; allowed: a name that ends in .png, .svg or .pdf")
    for option in ("column", "where"):
        for text in getattr(options, option):
            if text.find("=") < 1:
                made.error(f"--{option} '{text}' must read NAME=VALUE")
    if not options.recording and not options.map:
        made.error("recording is required")
    return options


def main(words: list[str], version: str) -> int:
    """Returns the exit code."""
    options = parse(words, version)
    from palpate_import.program import run

    return exit_code_of("palpate-import", lambda: run(options))
