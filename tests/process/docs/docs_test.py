#!/usr/bin/env python3
"""Fails where documentation and programs differ.

usage: docs_test.py configuration ROOT BIN    docs/configuration.md and docs/baselines.md equal the output of palpate-reference
       docs_test.py published ROOT            docs/published_methods.md equals the output of its script
       docs_test.py keys ROOT                 and describes every key that the sources read
       docs_test.py commands ROOT BIN FILE    the commands of a guide work as described, installed
       docs_test.py readme ROOT BIN           those of README.md, in the source and build tree
"""
import difflib
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile

PATIENCE = 800  # s, sufficient for a very busy machine; an unloaded one takes 40
READERS = ("rt/daemon/*.cpp", "rt/registry/*.cpp", "rt/pipeline/*.cpp", "rt/plugin/*.cpp", "rt/config/*.cpp", "sim/scenes/*.cpp", "sim/sensors/*.cpp",
           "tools/recordings/plan.cpp", "tools/fit/**/*.cpp", "tools/lab/studies/study_plan.cpp")
GETTER = re.compile(
    r"(?:(?:\.|->)\s*"
    r"(?:number|integer|flag|text|choice|texts|numbers|vector3|points|pose|path|child|child_or_empty|list)\("
    r"|(?:read_quantity|optional_quantity|read_time|read_selection|read_markers|is_free)\(\s*\w+,)"
    r"\s*\{?\s*\"([A-Za-z0-9_]+)\"")
# Keys of files that programs write for each other, not of configurations.
OF_OTHER_FILES = {"model", "corotational", "strain_range", "position", "quaternion", "rpy_deg", "units", "hidden"}
# Requested manually: they name a library built by the user (tools/examples).
OF_LIBRARIES = {"plugins", "library"}


# Blocks of README.md that are not run here, and why.
NOT_RUN = {"tools/demo": "installs packages and runs for half an hour",
           "tools/test": "installs packages and runs all tests, this one among them"}


def is_printed(page, words, root):
    """Whether a page equals a command's output."""
    printed = subprocess.run(words, capture_output=True, text=True, timeout=300)
    if printed.returncode != 0:
        print(printed.stderr)
        return 1
    text = (root / page).read_text()
    if printed.stdout != text:
        difference = difflib.unified_diff(text.splitlines(), printed.stdout.splitlines(), page, str(words[-1]),
                                          lineterm="")
        print("\n".join(list(difference)[:60]))
        print(f"run: {' '.join(map(str, words))} > {page}")
        return 1
    return 0


def configuration(root, programs):
    studies = is_printed("docs/studies.md", [programs / "palpate-evaluate", "reference"], root)
    baselines = is_printed("docs/baselines.md",
                           [programs / "palpate-reference", "--plugin", "palpate-baselines.so"], root)
    return is_printed("docs/configuration.md", [programs / "palpate-reference"], root) or studies or baselines


def published(root):
    return is_printed("docs/published_methods.md", [sys.executable, root / "tools/reference/published_methods"], root)


def keys(root):
    pages = (root / "docs/configuration.md").read_text() + (root / "docs/studies.md").read_text()
    documented = set(re.findall(r"^\| `([A-Za-z0-9_]+)` \|", pages, re.M))
    missing = []
    asked = 0
    for files in READERS:
        for path in sorted(root.glob(files)):
            for key in GETTER.findall(path.read_text()):
                asked += 1
                if key not in documented | OF_OTHER_FILES | OF_LIBRARIES:
                    missing.append(f"{path.relative_to(root)}: {key}")
    print(f"{asked} declarations, {len(documented)} keys documented")
    if missing:
        print("no reading of tools/reference/explorations.yaml asks for:\n" + "\n".join(missing))
    return 1 if missing or asked < 100 else 0


def blocks(text):
    """Fenced blocks of shell commands, with the line at which each begins."""
    found, lines, start = [], None, 0
    for number, line in enumerate(text.splitlines(), 1):
        if lines is None and re.match(r"```sh\s*$", line):
            lines, start = [], number + 1
        elif lines is not None and line.startswith("```"):
            found.append((start, lines))
            lines = None
        elif lines is not None:
            lines.append(line)
    return found


def private_urls():
    """For control and housekeeping, of this process only."""
    port = 10000 + os.getpid() % 11000 * 2
    group = f"239.255.{90 + os.getpid() % 100}.{1 + os.getpid() // 100 % 250}"
    return f"udpm://{group}:{port}?ttl=0", f"udpm://{group}:{port + 1}?ttl=0"


def say_and_run(body, folder, environment):
    """Output of a shell, and its exit code; nothing that it started outlives it."""
    # If this test is killed, the shell ends and, by its trap, its background processes.
    process = subprocess.Popen(["setpriv", "--pdeathsig", "TERM", "bash", "-c", body], cwd=folder, env=environment,
                               text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True)
    try:
        output = process.communicate(timeout=PATIENCE)[0]
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        output = process.communicate()[0] + f"\nerror: not done after {PATIENCE} s"
    print(output)
    return output, process.returncode


def readme(root, programs):
    """Blocks of README.md, on separate LCM URLs, with tolerance for a busy machine."""
    control, housekeeping = private_urls()
    urls = f"--set 'bus.control={control}' --set 'bus.housekeeping={housekeeping}'"
    script = ["set -euo pipefail", "trap 'kill $(jobs -p) 2>/dev/null || true; wait' EXIT",
              f'palpate-sim() {{ exec "{programs}/palpate-sim" "$@" {urls}; }}',
              f'palpated() {{ exec "{programs}/palpated" "$@" {urls} --set loop.degraded_after_ms=9000 '
              "--set loop.overrun_window_ms=10000 --set loop.safe_stop_after_ms=10000; }",
              f'palpate-command() {{ "{programs}/palpate-command" --url "{control}" --url "housekeeping={housekeeping}" '
              '--timeout 60 "$@"; }']
    left_out, run = set(), 0
    for start, lines in blocks((root / "README.md").read_text()):
        for number, line in enumerate(lines, start):
            words = line.split()
            if words and words[0] in NOT_RUN:
                left_out.add(words[0])
                print(f"README.md:{number}: not run, since it {NOT_RUN[words[0]]}")
            elif words and not line.startswith("export PATH="):
                run += 1
                script += [f"echo 'README.md:{number}: {words[0]}'", line]
    if left_out != set(NOT_RUN) or run < 4:
        print(f"error: README.md has {sorted(left_out)} and {run} other commands: correct NOT_RUN")
        return 1
    return say_and_run("\n".join(script), root, {**os.environ, "PATH": f"{programs}:{os.environ['PATH']}"})[1]


def commands(root, programs, guide):
    """One shell runs all blocks in order, in an empty folder, with palpate installed
    separately and on separate LCM URLs."""
    text = guide.read_text()
    control, housekeeping = private_urls()
    folder = pathlib.Path(tempfile.mkdtemp(prefix="palpate_docs_"))
    prefix = folder / "installed"
    for component in ("daemon", "sim", "dev"):
        subprocess.run(["cmake", "--install", programs.parent, "--component", component, "--prefix", prefix],
                       check=True, stdout=subprocess.DEVNULL)
    script = ["set -euo pipefail", "trap 'kill $(jobs -p) 2>/dev/null || true' EXIT"]
    for start, lines in blocks(text):
        script += [f"echo '== {guide.name}:{start}'"] + lines
    body = "\n".join(script).replace("udpm://239.255.76.67:7667?ttl=0", control)
    body = body.replace("udpm://239.255.76.68:7668?ttl=0", housekeeping)
    environment = {**os.environ, "PATH": f"{prefix}/bin:{programs}:{os.environ['PATH']}",
                   "CMAKE_PREFIX_PATH": str(prefix)}
    environment.pop("PALPATE", None)  # the guide finds what is installed
    work = folder / "work"
    work.mkdir()
    try:
        output, code = say_and_run(body, work, environment)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    for expected in re.findall(r"<!-- says: (.*?) -->", text):
        if not re.search(expected, output):
            print(f"error: nothing says: {expected}")
            return 1
    return code


def main():
    what, root = sys.argv[1], pathlib.Path(sys.argv[2])
    if what in ("keys", "published"):
        return {"keys": keys, "published": published}[what](root)
    programs = pathlib.Path(sys.argv[3]).resolve()
    if what == "readme":
        return readme(root, programs)
    return configuration(root, programs) if what == "configuration" else commands(root, programs, root / sys.argv[4])


if __name__ == "__main__":
    sys.exit(main())
