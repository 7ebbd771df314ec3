#!/usr/bin/env python3
"""Checks sources one at a time, as many at once as there are processors.

usage: check_sources.py tidy BUILD [FILE...]      clang-tidy on FILEs, or on what differs from the branch main
       check_sources.py headers BUILD [FILE...]   compiles each header alone, or every one of the product

BUILD holds compile_commands.json of a build without precompiled headers.
"""
import concurrent.futures
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = ("core", "rt", "sim", "tools", "tests")


def git(*words):
    return subprocess.run(["git", "-C", ROOT, *words], capture_output=True, text=True, check=True).stdout.split()


def changed_sources():
    """Sources that differ from main, or on main from the commit before; with a header, those of its name."""
    branch = git("rev-parse", "--abbrev-ref", "HEAD")[0]
    base = "HEAD~1" if branch in ("main", "HEAD") else "main"
    files = {name for name in git("diff", "--name-only", "--diff-filter=d", base) if name.startswith(FOLDERS)}
    sources = {name for name in files if name.endswith(".cpp")}
    for name in files:
        implementation = re.sub(r"\.hpp$", ".cpp", name)
        if name.endswith(".hpp") and (ROOT / implementation).is_file():
            sources.add(implementation)
    return sorted(sources)


def commands(build):
    """Compiler's words by source, relative to ROOT."""
    found = {}
    for entry in json.loads((build / "compile_commands.json").read_text()):
        path = pathlib.Path(entry["file"])
        if path.is_relative_to(ROOT):
            found[path.relative_to(ROOT).as_posix()] = shlex.split(entry["command"])
    return found


def tidy(build, source, _):
    # The commands are gcc's, some of whose warnings clang does not know.
    words = ["clang-tidy", "--quiet", "--extra-arg=-Wno-unknown-warning-option", "-p", str(build), source]
    run = subprocess.run(words, cwd=ROOT, capture_output=True, text=True)
    return run.returncode == 0, run.stdout


def header_alone(build, header, known):
    """Compiles a source that includes nothing else, with the flags of a source of its folder or of a parent's."""
    folder = pathlib.PurePosixPath(header).parent
    while True:
        of_folder = [words for source, words in known.items() if pathlib.PurePosixPath(source).parent == folder]
        if of_folder or folder == pathlib.PurePosixPath("."):
            break
        folder = folder.parent
    if not of_folder:
        return True, ""
    words = [word for word in of_folder[0] if not word.endswith((".cpp", ".o")) and word not in ("-o", "-c")]
    words = [word for word in words if "ccache" not in word]
    with tempfile.TemporaryDirectory() as folder_name:
        alone = pathlib.Path(folder_name) / "alone.cpp"
        alone.write_text(f'#include "{header}"\n#include "{header}"\n')
        run = subprocess.run([*words, "-fsyntax-only", str(alone)], cwd=build, capture_output=True, text=True)
    return run.returncode == 0, run.stderr


def main():
    if len(sys.argv) < 3 or sys.argv[1] not in ("tidy", "headers"):
        print(__doc__, file=sys.stderr)
        return 64
    what, build, files = sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3:]
    known = commands(build)
    if what == "tidy":
        files = [name for name in files or changed_sources() if name in known]
        check = tidy
    else:
        files = files or [name for name in git("ls-files", "*.hpp") if not name.startswith("tests/")]
        check = header_alone
    failed = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for name, (good, text) in zip(files, pool.map(lambda name: check(build, name, known), files)):
            if not good:
                failed += 1
                print(f"{name}:\n{text}")
    print(f"{what}: {len(files)} files, {failed} with findings")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
