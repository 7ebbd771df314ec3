"""Makes the package palpate.messages from lcmtypes/*.lcm: lcm-gen's Python with type hints.

usage: generate_messages.py --types FOLDER --output FOLDER [--lcm-gen PROGRAM]
e.g.   generate_messages.py --types ../../lcmtypes --output palpate/messages
"""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

PYTHON_TYPES = {
    "int8_t": "int", "int16_t": "int", "int32_t": "int", "int64_t": "int",
    "float": "float", "double": "float", "boolean": "bool", "string": "str",
}  # fmt: skip
CONSTANT = re.compile(r"const\s+\w+\s+(.*)", re.DOTALL)
FIELD = re.compile(r"(\w+)\s+(\w+)\s*((?:\[\s*\w+\s*\])*)$")


def hint_of(kind: str, dimensions: int) -> str:
    """The type hint of a field as represented by lcm-gen's Python: bytes are one string."""
    if kind == "byte":
        kind, dimensions = "bytes", dimensions - 1
    hint = PYTHON_TYPES.get(kind, kind)
    for _ in range(dimensions):
        hint = f"Sequence[{hint}]"
    return hint


def stub_of(text: str, name: str) -> str:
    """The class of one .lcm file as a stub."""
    code = re.sub(r"/\*.*?\*/", "", re.sub(r"//[^\n]*", "", text), flags=re.DOTALL)
    body = re.search(r"struct\s+(\w+)\s*\{(.*)\}", code, re.DOTALL)
    if body is None or body.group(1) != name:
        raise ValueError(f"{name}.lcm: holds no struct {name}")
    lines = [f"class {name}:"]
    for statement in (part.strip() for part in body.group(2).split(";")):
        if not statement:
            continue
        constants = CONSTANT.match(statement)
        if constants:
            lines += [f"    {item.split('=')[0].strip()}: int" for item in constants[1].split(",")]
            continue
        field = FIELD.match(statement)
        if field is None:
            raise ValueError(f"{name}.lcm: {statement!r} is not understood")
        lines.append(f"    {field[2]}: {hint_of(field[1], field[3].count('['))}")
    lines += [
        "    def __init__(self) -> None: ...",
        "    def encode(self) -> bytes: ...",
        "    @staticmethod",
        f"    def decode(data: bytes) -> {name}: ...",
        "    @staticmethod",
        "    def _get_packed_fingerprint() -> bytes: ...",
    ]
    return "\n".join(lines)


def generate(types: Path, output: Path, lcm_gen: str = "lcm-gen") -> None:
    """Writes the package `output`, replacing it. Raises OSError or ValueError with the
    reason.
    """
    files = sorted(types.glob("*.lcm"))
    if not files:
        raise ValueError(f"{types}: holds no .lcm files")
    program = shutil.which(lcm_gen)
    if program is None:
        raise ValueError(f"{lcm_gen}: not found; install the package liblcm-bin")
    with tempfile.TemporaryDirectory() as scratch:
        command = [program, "--python", "--ppath", scratch, *map(str, files)]
        made = subprocess.run(command, capture_output=True, text=True, check=False)
        if made.returncode != 0:
            raise ValueError(f"{' '.join(command)}: {made.stderr.strip() or made.stdout.strip()}")
        if output.exists():
            shutil.rmtree(output)
        # All types are in the package palpate, and none refers to another: they can be moved.
        shutil.copytree(Path(scratch) / "palpate", output)
    for file in files:
        stub = "from typing import Sequence\n\n" + stub_of(file.read_text(), file.stem)
        (output / f"{file.stem}.pyi").write_text(stub + "\n")
    imports = [f"from .{file.stem} import {file.stem} as {file.stem}" for file in files]
    (output / "__init__.pyi").write_text("\n".join(imports) + "\n")


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--types", type=Path, required=True, help="folder of the .lcm files")
    parser.add_argument("--output", type=Path, required=True, help="folder of the package to write")
    parser.add_argument("--lcm-gen", default="lcm-gen", help="the program (default: %(default)s)")
    options = parser.parse_args()
    try:
        generate(options.types, options.output, options.lcm_gen)
    except (OSError, ValueError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
