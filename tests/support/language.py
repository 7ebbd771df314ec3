#!/usr/bin/env python3
"""Counts words of a private dialect over the tree; fails where a folder has more of them than it is allowed.

usage: language.py ROOT [--list FOLDER] | language.py --self-test

Plain professional English says "reports", not "tells"; "compared with", not "beside"; "vision", not "sight";
"again", not "anew". ALLOWED holds what is left, by folder: it may fall, not rise.
"""
import collections
import pathlib
import re
import subprocess
import sys

WORDS = re.compile(
    r"\b(tells?|told|anew|nobody|whoever|shall|got over|rivals?|sights?|sighted|beside)\b", re.IGNORECASE)
SUFFIXES = {".cpp", ".hpp", ".py", ".md", ".yaml", ".lcm", ".cmake", ".txt", ".js", ".html", ".java", ".css", ".in",
            ".service", ".sh", ""}
LEFT_OUT = ("tests/support/language.py", "docs/glossary.md", "docs/data/", "tests/fuzz/corpus/", "tests/golden/data/",
            "LICENSE")
ALLOWED = {
    "core/estimation": 9, "core/mesh": 1, "core/sensing": 1, "core/shape": 1, "docs":
    66, "rt/config": 2, "rt/daemon": 16, "rt/inference": 4, "rt/pipeline": 22, "rt/plugin": 1, "rt/registry": 39,
    "sim/camera": 2, "sim/robot": 3, "sim/scenes": 8, "sim/sensors": 2, "tests/bench": 16, "tests/fault": 13,
    "tests/fuzz": 2, "tests/golden": 9, "tests/integration": 7, "tests/process": 66, "tests/support": 3,
    "tests/unit": 189, "tools/collect": 3, "tools/command": 2, "tools/doctor": 14, "tools/examples": 3,
    "tools/export": 8, "tools/fit": 38, "tools/lab": 124, "tools/log": 1, "tools/mesh": 7, "tools/packaging": 6,
    "tools/python": 2, "tools/recordings": 2, "tools/reference": 43, "tools/spy": 1, "tools/top":
    1, "tools/train": 4, "tools/view": 18,
}


def folder_of(path):
    parts = path.split("/")
    return "/".join(parts[:2]) if len(parts) > 2 else parts[0] if len(parts) == 2 else "."


def places(root):
    """(folder, "file:line: word") of every such word in the files that git tracks."""
    listed = subprocess.run(["git", "-C", root, "ls-files"], capture_output=True, text=True, check=True).stdout
    for name in listed.splitlines():
        path = root / name
        if path.suffix not in SUFFIXES or name.startswith(LEFT_OUT) or not path.is_file():
            continue
        try:
            text = path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue
        for number, line in enumerate(text.splitlines(), 1):
            for match in WORDS.finditer(line):
                yield folder_of(name), f"{name}:{number}: {match.group(0)}"


def main():
    if sys.argv[1:] == ["--self-test"]:
        found = [m.group(0) for m in WORDS.finditer("It tells nobody; a sighted rival shall start anew. Foretold besides.")]
        return 0 if found == ["tells", "nobody", "sighted", "rival", "shall", "anew"] else 1
    if len(sys.argv) not in (2, 4):
        print(__doc__)
        return 64
    root = pathlib.Path(sys.argv[1]).resolve()
    if not (root / ".git").exists():
        print("skipped: not a git checkout")
        return 77
    found = collections.defaultdict(list)
    for folder, place in places(root):
        found[folder].append(place)
    if len(sys.argv) == 4:
        print(*found[sys.argv[3]], sep="\n")
        return 0
    code = 0
    for folder in sorted({*found, *ALLOWED}):
        count, allowed = len(found[folder]), ALLOWED.get(folder, 0)
        if count > allowed:
            code = 1
            print(f"{folder}: {count} words of the private dialect, {allowed} allowed; language.py ROOT --list {folder}")
        elif count < allowed:
            print(f"{folder}: {count} words left, {allowed} allowed; lower the entry of ALLOWED")
    print(f"{sum(map(len, found.values()))} words in all")
    return code


if __name__ == "__main__":
    sys.exit(main())
