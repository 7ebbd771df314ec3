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

# Single words also count as parts of identifiers: told_s, BeginsAnew.
SINGLE = ("amid", "anew", "anybody", "askew", "astray", "beside", "everybody", "mend", "mended", "mends", "nobody", "rival",
          "rivals", "shall", "sight", "sighted", "sights", "somebody", "speaks", "spoken", "tell", "tells", "told", "untold",
          "whoever")
PHRASES = ("comes to nothing", "does badly", "does well", "for good", "for want of", "gave way", "gives? way", "go on",
           "goes on", "going on", "got over", "is none that", "somebody else", "went on", "whatever else")
WORDS = re.compile(rf"(?<![A-Za-z])(?i:{'|'.join(SINGLE + PHRASES)})(?![a-z])|"
                   rf"(?<=[a-z0-9])(?:{'|'.join(word.capitalize() for word in SINGLE)})(?![a-z])")
SUFFIXES = {".cpp", ".hpp", ".py", ".md", ".yaml", ".lcm", ".cmake", ".txt", ".js", ".html", ".java", ".css", ".in",
            ".service", ".sh", ""}
LEFT_OUT = ("tests/support/language.py", "docs/data/", "tests/fuzz/corpus/", "tests/golden/data/",
            "LICENSE")
ALLOWED = {
    "core/math": 1, "docs": 3, "rt/registry": 3, "tests/process": 2, "tools/lab": 1,
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
        found = WORDS.findall("It tells nobody; a sighted rival shall start anew. told_s kBesideX ItGoesOn goes on."
                              " Foretold besides insight Bartold.")
        return 0 if found == ["tells", "nobody", "sighted", "rival", "shall", "anew", "told", "Beside", "goes on"] else 1
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
