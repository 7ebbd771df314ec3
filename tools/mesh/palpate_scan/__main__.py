"""Started by palpate-mesh scan: `surface` makes a closed surface of a cloud, `deviation` compares a surface with a cloud.

  python3 tools/mesh/palpate_scan surface cloud.ply surface.obj --json facts.json
  python3 tools/mesh/palpate_scan deviation cloud.ply boundary.obj --json deviation.json --picture deviation.png
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

tools = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(tools / "mesh"), str(tools / "common")]

from palpate_common.command_line import exit_code_of  # noqa: E402


def parsed(words: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    for name in ("surface", "deviation"):
        command = commands.add_parser(name)
        command.add_argument("cloud", type=Path)
        command.add_argument("surface", type=Path)
        command.add_argument("--scale", type=float, default=1.0)
        command.add_argument("--json", required=True)
        if name == "surface":
            command.add_argument("--most-unseen", type=float, default=0.3)
        else:
            command.add_argument("--picture", type=Path)
    return parser.parse_args(words)


def main(words: list[str]) -> int:
    options = parsed(words)
    from palpate_scan.program import compare, make

    return exit_code_of("palpate-mesh", lambda: make(options) if options.command == "surface" else compare(options))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
