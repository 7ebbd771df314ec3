"""Command line of palpate-setup. Imports nothing slow, so that --help comes at once."""

from __future__ import annotations

import argparse
import signal
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Optional

from palpate_common.command_line import Number, Parser, exit_code_of

if TYPE_CHECKING:
    from palpate_setup.person import Person
    from palpate_setup.project import Project
    from palpate_setup.step import Step

STEPS = ("machine", "channels", "wrist", "object", "registration", "material", "motion")
INTERRUPTED = 130
DESCRIPTION = """palpate-setup guides through the set-up of a robot and an object: machine, channels, wrist, object,
registration, material, and the first 5 mm of motion. It asks only what it cannot measure, and leaves in the folder one
configuration for palpated (palpate.yaml), a report (report.html), and what it measured (steps/)."""
EPILOGUE = """A step that is done is not repeated unless --step names it, or its inputs have changed (outdated). A skipped step asks for
typed values instead. Keys of palpated that no step asks for: put them into own.yaml in the folder.
Answers: YAML with a section for each step; `commands` names a shell command for a step, which runs while the step does, such as
the program that moves the arm. tools/setup/README.md lists all questions.

Examples:
  palpate-setup cell                          asks at the terminal, step by step
  palpate-setup cell --page                   the same in a browser on this machine
  palpate-setup cell --status
  palpate-setup cell --step registration      once more, after the object was moved
  palpate-setup cell --skip machine --answers cell/answers.yaml
  palpated --config cell/palpate.yaml
Exit codes: 0   done
            1   a step stopped; the message and the report say why
            64  wrong command line
            78  wrong answers; the message names file, line, key, value and allowed values
            130 interrupted"""


def parser() -> Parser:
    """Of the command line."""
    made = Parser("palpate-setup", DESCRIPTION, "[OPTIONS] folder", EPILOGUE)
    add = made.add_argument
    add("folder", type=Path, help="Folder of the set-up; created where it does not exist")
    add("--step", action="append", choices=STEPS, default=[], help="Run this step, even if it is done (repeatable)")
    add("--skip", action="append", choices=STEPS, default=[], help="Skip this step, with typed values (repeatable)")
    add("--until", choices=STEPS, help="End after this step")
    add("--answers", type=Path, help="YAML file with the answers: nothing is asked")
    add("--status", action="store_true", help="Print the state of all steps, and end")
    add("--page", action="store_true", help="Serve a page for a browser on this machine instead of asking at the terminal")
    add("--port", type=Number(0, 65535, whole=True), default=0, help="Of the page; 0: any")
    return made


def parse(words: list[str], version: str) -> argparse.Namespace:
    """Options that agree with each other; ends with 64 otherwise."""
    made = parser()
    made.add_argument("--version", action="version", version=version, help="Display program version information and exit")
    options = made.parse_args(words)
    both = set(options.step) & set(options.skip)
    if both:
        made.error(f"--step and --skip exclude each other: {', '.join(sorted(both))}")
    if options.page and (options.answers or options.step or options.skip or options.until or options.status):
        made.error("--page excludes --answers, --step, --skip, --until and --status")
    return options


def status_lines(project: Project) -> list[str]:
    """One for each step."""
    lines = []
    for step in project.steps:
        why = project.why_outdated(step) or project.entry(step.name).get("reason", "")
        lines.append(f"{step.name:<14}{project.status(step):<10}{project.entry(step.name).get('time', ''):<28}{why}".rstrip())
    return lines


def _at_terminal(options: argparse.Namespace, step: Step) -> Optional[str]:
    """What to do with a step that the command line does not name: run, skip, quit."""
    from palpate_setup.person import Terminal

    if options.answers or step.name in options.step:
        return "run"
    while True:
        typed = Terminal.line("  [r]un, [s]kip with typed values, or [q]uit? [r] ").strip().lower()
        chosen = {"": "run", "r": "run", "s": "skip", "q": "quit"}.get(typed)
        if chosen:
            return chosen


def _run(options: argparse.Namespace) -> int:
    from palpate_setup.guide import Guide, next_step
    from palpate_setup.person import AnswersFile, Terminal
    from palpate_setup.programs import Programs
    from palpate_setup.project import DONE, SKIPPED, Project
    from palpate_setup.steps import all_steps

    project = Project(options.folder, all_steps())
    programs = Programs(Path(sys.argv[0]).resolve().parent)
    if options.status:
        print("\n".join(status_lines(project)))
        return 0
    if options.page:
        from palpate_setup.page import serve

        return serve(project, programs, options.port)
    person: Person = AnswersFile(options.answers, STEPS) if options.answers else Terminal()
    guide = Guide(project, programs, person)
    named = [project.step(name) for name in STEPS if name in options.step]
    queue = named or [step for step in project.steps if step.name in options.skip or project.status(step) not in (DONE, SKIPPED)]
    if options.until:
        queue = [step for step in queue if STEPS.index(step.name) <= STEPS.index(options.until)]
    for step in queue:
        print(f"{STEPS.index(step.name) + 1}. {step.title}: {step.about}", flush=True)
        what = "skip" if step.name in options.skip else _at_terminal(options, step)
        if what == "quit":
            break
        guide.perform(step, skip=what == "skip")
    left = next_step(project)
    print(f"next: palpate-setup {options.folder} (step {left.name})" if left else
          f"done: palpated --config {options.folder / 'palpate.yaml'}")  # fmt: skip
    return 0


def main(words: list[str], version: str) -> int:
    """Returns the exit code."""
    options = parse(words, version)
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # so that what was started is ended
    try:
        return exit_code_of("palpate-setup", lambda: _run(options))
    except KeyboardInterrupt:
        print("palpate-setup: interrupted", file=sys.stderr)
        return INTERRUPTED
