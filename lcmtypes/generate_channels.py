#!/usr/bin/env python3
"""Generates names and properties of the channels, for C++, Python, Java and the documentation, from channels.csv.

usage: generate_channels.py [--cpp FILE] [--python FILE] [--java FILE] [--markdown FILE]

Columns of channels.csv: number is "arm" for a channel that the second arm has as NAME_1, "finger" for NAME_0 to
NAME_4; bus is the URL of three that carries the channel; signed is "yes" for messages that need an authentication
code if a key is configured. The former versions of NAME_t, which logs may contain, are NAME_v1_t, NAME_v2_t, ...
"""

from __future__ import annotations

import argparse
import csv
import re
import sys
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
COLUMNS = ("channel", "number", "type", "bus", "rate", "sender", "receiver", "signed", "content")
BUSES = ("control", "housekeeping", "pictures")
NUMBERS = ("", "arm", "finger")
FIELD = re.compile(r"^\s*(?P<type>\w+)\s+(?P<name>\w+)(?P<dimensions>(\[\w+\])*);\s*(//\s*(?P<comment>.*))?$")


def read_table() -> list[dict[str, str]]:
    """The rows of channels.csv. Raises ValueError naming line and value."""
    with (FOLDER / "channels.csv").open(newline="") as file:
        reader = csv.DictReader(file)
        if tuple(reader.fieldnames or ()) != COLUMNS:
            raise ValueError(f"channels.csv: columns are {reader.fieldnames}; allowed: {', '.join(COLUMNS)}")
        rows = list(reader)
    for line, row in enumerate(rows, 2):
        for column, allowed in (("bus", BUSES), ("number", NUMBERS), ("signed", ("yes", "no"))):
            if row[column] not in allowed:
                raise ValueError(f"channels.csv:{line}: {column}: {row[column]!r}; allowed: {', '.join(allowed)}")
        if not re.fullmatch(r"[A-Z][A-Z0-9_]*", row["channel"]):
            raise ValueError(f"channels.csv:{line}: channel: {row['channel']!r}; allowed: A-Z, 0-9 and _")
        if not (FOLDER / f"{row['type']}.lcm").is_file():
            raise ValueError(f"channels.csv:{line}: type: {row['type']} has no file in lcmtypes")
    return rows


def former_types(kind: str) -> list[str]:
    """Types that a channel of type `kind` had before, oldest first."""
    stem = kind.removesuffix("_t")
    return sorted(path.stem for path in FOLDER.glob(f"{stem}_v*_t.lcm") if re.fullmatch(rf"{stem}_v\d+_t", path.stem))


def constant(name: str) -> str:
    return "k" + "".join(part.capitalize() for part in name.split("_"))


def cpp(rows: list[dict[str, str]]) -> str:
    lines = [
        "// Generated from lcmtypes/channels.csv.", "#pragma once", "", "#include <string>", "#include <string_view>", "",
        "namespace palpate::channel {", "",
        "enum class Bus { kControl, kHousekeeping, kPictures };",
        "/// Suffix of a channel: none; none or _1 by the arm; _0 to _4 by the finger.",
        "enum class Number { kNone, kArm, kFinger };", "",
        "struct Channel {", "  std::string_view name;", "  std::string_view type;",
        "  Bus bus;", "  Number number;", "  std::string_view sender;", "  std::string_view receiver;",
        "  bool is_signed;  // needs an authentication code if a key is configured", "};", "",
    ]  # fmt: skip
    for row in rows:
        lines.append(f"/// {row['content']}.")
        lines.append(f'inline constexpr const char* {constant(row["channel"])} = "{row["channel"]}";')
        for number in {"": (), "arm": (1,), "finger": range(5)}[row["number"]]:
            name = f"{row['channel']}_{number}"
            lines.append(f'inline constexpr const char* {constant(name)} = "{name}";')
    lines += ["", "/// Every channel, without the numbers of arms and fingers.", "inline constexpr Channel kAll[] = {"]
    for row in rows:
        bus = "k" + row["bus"].capitalize()
        number = "k" + (row["number"].capitalize() or "None")
        lines.append(
            f'    {{{constant(row["channel"])}, "{row["type"]}", Bus::{bus}, '
            f'Number::{number}, "{row["sender"]}", "{row["receiver"]}", {"true" if row["signed"] == "yes" else "false"}}},'
        )
    lines += [
        "};", "",
        "/// Name of a channel for arm 0 or arm 1, which ends in _1.",
        "inline std::string of_arm(std::string_view name, int arm) {",
        '  return arm == 0 ? std::string(name) : std::string(name) + "_" + std::to_string(arm);', "}", "",
        "/// Entry of a channel's name, with or without a number; nullptr for a foreign channel.",
        "inline const Channel* find(std::string_view name) {",
        "  std::string_view stem = name;",
        '  while (!stem.empty() && stem.back() >= \'0\' && stem.back() <= \'9\') stem.remove_suffix(1);',
        "  if (stem.size() < name.size() && !stem.empty() && stem.back() == '_') stem.remove_suffix(1);",
        "  for (const Channel& channel : kAll) {",
        "    if (channel.name == name) return &channel;",
        "    if (channel.number != Number::kNone && channel.name == stem) return &channel;", "  }",
        "  return nullptr;", "}", "", "}  // namespace palpate::channel", "",
    ]  # fmt: skip
    return "\n".join(lines)


def python(rows: list[dict[str, str]]) -> str:
    lines = [
        '"""Names of the channels and their properties, generated from lcmtypes/channels.csv."""', "",
        "from __future__ import annotations", "", "from typing import Any, NamedTuple, Type", "",
        "from palpate import messages", "", "",
        "class Channel(NamedTuple):", "    name: str", "    type: Type[Any]",
        '    bus: str  # "control", "housekeeping" or "pictures"',
        '    number: str  # "": none; "arm": NAME_1 of a second arm; "finger": NAME_0 to NAME_4',
        "    sender: str", "    receiver: str", "    is_signed: bool", "    content: str",
        "    former: tuple[Type[Any], ...]  # types that the channel had before, oldest first", "", "",
        *(f'{row["channel"]} = "{row["channel"]}"' for row in rows), "", "CHANNELS: dict[str, Channel] = {",
    ]  # fmt: skip
    for row in rows:
        values = [f"messages.{row['type']}"] + [repr(row[c]) for c in ("bus", "number", "sender", "receiver")]
        former = "".join(f"messages.{kind}, " for kind in former_types(row["type"]))
        values += [str(row["signed"] == "yes"), repr(row["content"]), f"({former.rstrip() if former else ''})"]
        lines.append(f"    {row['channel']}: Channel({row['channel']}, {', '.join(values)}),")
    return "\n".join([*lines, "}", ""])


def java(rows: list[dict[str, str]]) -> str:
    lines = [
        "// Generated from lcmtypes/channels.csv.", "package palpate;", "",
        "/** Names of the channels and their properties. */", "public final class Channels {", "  private Channels() {}", "",
        "  public static final class Channel {", "    public final String name;", "    public final String type;",
        "    /** control, housekeeping or pictures. */", "    public final String bus;",
        "    /** arm: NAME_1 of a second arm; finger: NAME_0 to NAME_4; otherwise empty. */", "    public final String number;",
        "    public final String content;", "",
        "    Channel(String name, String type, String bus, String number, String content) {",
        "      this.name = name;", "      this.type = type;", "      this.bus = bus;", "      this.number = number;",
        "      this.content = content;", "    }", "  }", "",
        *(f'  public static final String {row["channel"]} = "{row["channel"]}";' for row in rows), "",
        "  /** Every channel, without the numbers of arms and fingers. */", "  public static final Channel[] ALL = {",
    ]  # fmt: skip
    for row in rows:
        texts = ", ".join(f'"{row[column]}"' for column in ("type", "bus", "number", "content"))
        lines.append(f"    new Channel({row['channel']}, {texts}),")
    lines += [
        "  };", "", "  /** Entry of a channel's name, with or without a number; null for a foreign channel. */",
        "  public static Channel find(String name) {", '    String stem = name.replaceFirst("_[0-9]+$", "");',
        "    for (Channel channel : ALL) {", "      if (channel.name.equals(name)) return channel;",
        "      if (!channel.number.isEmpty() && channel.name.equals(stem)) return channel;", "    }", "    return null;",
        "  }", "}", "",
    ]  # fmt: skip
    return "\n".join(lines)


def fields(kind: str) -> list[tuple[str, str, str]]:
    """(type, name, description) of the fields of a message after its header, and of its constants."""
    found: list[tuple[str, str, str]] = []
    for line in (FOLDER / f"{kind}.lcm").read_text().splitlines():
        field = FIELD.match(line)
        constants = re.match(r"^\s*const\s+(\w+)\s+(.*);", line)
        if constants:
            found += [("constant", item.strip(), "") for item in constants[2].split(",")]
        elif field and field["type"] != "package" and field["name"] not in ("utime", "seq", "session"):
            found.append((field["type"], field["name"] + field["dimensions"], field["comment"] or ""))
        elif found and (more := re.match(r"^\s*//\s*(.*)$", line)):
            kind_of, name, comment = found[-1]
            found[-1] = (kind_of, name, f"{comment} {more[1]}".strip())
    return found


def about(kind: str) -> str:
    """Comment at the top of a type's file."""
    text = (FOLDER / f"{kind}.lcm").read_text()
    return " ".join(line[2:].strip() for line in text.split("package")[0].splitlines())


def markdown(rows: list[dict[str, str]]) -> str:
    lines = [
        "# Channels and messages", "",
        "Generated by `lcmtypes/generate_channels.py` from `lcmtypes/channels.csv` and the message types.", "",
        "Every message begins with `utime` (us, clock of the sender), `seq` (increments by one per message of the "
        "channel and session) and `session` (random ID, regenerated at each start of the sender). Channels of a second "
        "arm end in `_1`, those of fingertips in `_0` to `_4`. Signed messages need an authentication code if a key is "
        "configured. Each of the three buses is an LCM URL of its own.", "",
        "| channel | type | bus | rate | from | to | signed | content |", "| --- | --- | --- | --- | --- | --- | --- | --- |",
    ]  # fmt: skip
    for row in rows:
        lines.append(
            f"| `{row['channel']}{'_0' if row['number'] == 'finger' else ''}` | [`{row['type']}`](#{row['type']}) | {row['bus']} | {row['rate']} | "
            f"{row['sender']} | {row['receiver']} | {row['signed']} | {row['content']} |"
        )
    for kind in sorted({row["type"] for row in rows}):
        lines += ["", f"## {kind}", "", about(kind), "", "| field | type | meaning |", "| --- | --- | --- |"]
        lines += [f"| `{name}` | {type_of} | {comment} |" for type_of, name, comment in fields(kind)]
    lines += ["", "## Former types", "", "Read from logs only; never published.", "", "| type | content |", "| --- | --- |"]
    for kind in sorted({former for row in rows for former in former_types(row["type"])}):
        lines.append(f"| `{kind}` | {about(kind)} |")
    return "\n".join([*lines, ""])


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    makers = {"cpp": cpp, "python": python, "java": java, "markdown": markdown}
    for name in makers:
        parser.add_argument(f"--{name}", type=Path, metavar="FILE", help=f"write the {name} file")
    options = vars(parser.parse_args())
    try:
        rows = read_table()
        for name, make in makers.items():
            if options[name] is not None:
                options[name].parent.mkdir(parents=True, exist_ok=True)
                options[name].write_text(make(rows))
    except (OSError, ValueError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
