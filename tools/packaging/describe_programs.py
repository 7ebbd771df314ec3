#!/usr/bin/env python3
"""Writes manual pages and shell completion for palpate's programs from their own --help.

usage: describe_programs.py --programs FOLDER --output FOLDER NAME...

Each NAME is run with --help, and so is each of its subcommands. Below the output folder come
man/NAME.1, bash/NAME (loaded by bash-completion when NAME is first completed) and zsh/_NAME.
Exit codes: 0 done, 1 a program does not describe itself.
"""
import argparse
import os
import pathlib
import re
import subprocess
import sys

COLUMN = 30  # column at which CLI11 starts the text of an option
GROUPS = ("Positionals:", "Options:", "Subcommands:")


class Item:
    """A positional, option or subcommand: its notation and meaning."""

    def __init__(self, spec):
        self.spec = spec
        self.text = []

    @property
    def names(self):
        """-o, --output; or the name of a positional or subcommand."""
        return self.spec.split(" ", 1)[0].split(",")

    @property
    def takes(self):
        """The text after the name: a type, its default, conditions."""
        parts = self.spec.split(" ", 1)
        return parts[1] if len(parts) > 1 else ""

    @property
    def wants_value(self):
        return bool(re.match(r"(TEXT|INT|UINT|FLOAT|ENUM|BOOLEAN|\{|\[)", self.takes))

    @property
    def choices(self):
        found = re.search(r"\{([^}]*)\}", self.takes)
        return found.group(1).split(",") if found else []


class Command:
    """A program, or a subcommand of one."""

    def __init__(self, words, text):
        self.words = words
        self.head, self.usage, self.tail = [], "", []
        self.groups = {name: [] for name in GROUPS}
        self.parse(text.splitlines())
        self.children = []

    def parse(self, lines):
        group = None
        place = "head"
        for number, line in enumerate(lines):
            following = lines[number + 1] if number + 1 < len(lines) else ""
            if place == "head" and line.startswith("Usage: "):
                self.usage = " ".join(self.words) + line[len("Usage: "):].partition(self.words[-1])[2]
                place = "groups"
            elif place == "head":
                self.head.append(line)
            elif place == "groups" and line in GROUPS:
                group = self.groups[line]
            elif place == "groups" and line.startswith(" " * COLUMN) and group:
                group[-1].text.append(line[COLUMN:])
            elif place == "groups" and re.match(r"  \S", line) and group is not None:
                group.append(self.item(line, following))
            elif place == "groups" and line == "":
                continue
            else:
                place = "tail"
                self.tail.append(line)
        if not self.usage:
            raise ValueError(f"{' '.join(self.words)} --help prints no usage")

    @staticmethod
    def item(line, following):
        padded = line[COLUMN - 2:COLUMN] == "  " or (
            line[COLUMN - 1:COLUMN] == " " and not following.startswith(" " * COLUMN))
        if not padded or len(line) <= COLUMN:
            return Item(line.strip())
        item = Item(line[:COLUMN].strip())
        item.text.append(line[COLUMN:])
        return item

    def all(self):
        yield self
        for child in self.children:
            yield from child.all()


def ask(program, words):
    """The command, with its subcommands."""
    done = subprocess.run([str(program), *words[1:], "--help"], capture_output=True, text=True,
                          env={**os.environ, "LC_ALL": "C"}, timeout=60)
    if done.returncode != 0:
        raise ValueError(f"{' '.join(words)} --help ends with {done.returncode}: {done.stderr}")
    command = Command(words, done.stdout)
    for item in command.groups["Subcommands:"]:
        command.children.append(ask(program, words + [item.names[0]]))
    return command


# Manual page.


def roff(text):
    text = text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq")
    return "\\&" + text if text.startswith(".") else text


def paragraphs(lines):
    """Indented lines are kept, the others are filled."""
    out, literal = [], False
    for line in lines:
        indented = line.startswith("  ")
        if indented != literal:
            out.append(".EX" if indented else ".EE")
            literal = indented
        out.append(roff(line) if line.strip() else (".PP" if not literal else ""))
    if literal:
        out.append(".EE")
    return out


def sections(command):
    """The text before and after the options: description, examples, exit codes."""
    found = {"DESCRIPTION": [], "EXAMPLES": [], "EXIT STATUS": []}
    where = "DESCRIPTION"
    for line in command.head + [""] + command.tail:
        if line.startswith("Exit codes: "):
            found["EXIT STATUS"].append("  " + line[len("Exit codes: "):])
            where = "EXIT STATUS"
        elif where == "EXIT STATUS" and line.startswith("            "):
            found[where].append("  " + line.strip())
        elif re.match(r"Examples?:", line):
            where = "EXAMPLES"
            rest = line.partition(":")[2].strip()
            if rest:
                found[where].append("  " + rest)
        else:
            if where == "EXIT STATUS" or (where == "EXAMPLES" and line and not line.startswith("  ")):
                where = "DESCRIPTION"
            found[where].append(line)
    for lines in found.values():
        while lines and not lines[0].strip():
            lines.pop(0)
        while lines and not lines[-1].strip():
            lines.pop()
    return found


def options(command, group, out):
    for item in command.groups[group]:
        out.append(".TP")
        takes = roff(item.takes).replace(",", ",\\:") if item.takes else ""  # lines may break between choices
        out.append("\\fB" + roff(", ".join(item.names)) + "\\fR" + (" " + takes if takes else ""))
        out.extend(roff(line) for line in item.text or ["."])


def manual(command, version, others):
    name = command.words[0]
    parts = sections(command)
    brief = re.split(r"(?<=[a-z0-9])[.:](?:\s|$)", " ".join(parts["DESCRIPTION"]))[0]
    brief = re.sub(r"^" + re.escape(name) + r"\s+", "", brief)
    out = [f'.TH {name.upper()} 1 "" "palpate {version}" "palpate"', ".nh", ".ad l",
           ".SH NAME", f"{roff(name)} \\- {roff(brief)}", ".SH SYNOPSIS"]
    for one in command.all():
        if "SUBCOMMAND" not in one.usage or "[SUBCOMMAND]" in one.usage:
            out += [".B " + roff(one.usage), ".br"]
    out += [".SH DESCRIPTION"] + paragraphs(parts["DESCRIPTION"])
    if command.groups["Positionals:"]:
        out.append(".SH ARGUMENTS")
        options(command, "Positionals:", out)
    out.append(".SH OPTIONS")
    options(command, "Options:", out)
    below = [one for one in command.all() if one is not command]
    if below:
        out.append(".SH COMMANDS")
    for one in below:
        out.append(".SS " + roff(" ".join(one.words[1:])))
        own = sections(one)
        out += paragraphs(own["DESCRIPTION"])
        options(one, "Positionals:", out)
        options(one, "Options:", out)
        if own["EXAMPLES"]:
            out += [".PP", "Example:"] + paragraphs(own["EXAMPLES"])
    for title in ("EXAMPLES", "EXIT STATUS"):
        if parts[title]:
            out += [f".SH {title}"] + paragraphs(parts[title])
    seen = sorted(set(others) - {name})
    out += [".SH SEE ALSO", ", ".join(f"\\fB{roff(other)}\\fR(1)" for other in seen) or "palpate"]
    return "\n".join(out) + "\n"


# Completion.


def quoted(words):
    return "'" + " ".join(word.replace("'", "") for word in words) + "'"


def bash(command):
    name = command.words[0]
    function = "_complete_" + name.replace("-", "_")
    steps, sets, values = [], [], []
    for one in command.all():
        state = "/".join([""] + one.words[1:])
        for child in one.children:
            steps.append(f"      {state}:{child.words[-1]}) state={state}/{child.words[-1]} ;;")
        names = [n for item in one.groups["Options:"] for n in item.names]
        words = [child.words[-1] for child in one.children]
        words += [w for item in one.groups["Positionals:"] for w in item.choices]
        sets.append(f"    '{state}') options={quoted(names)} words={quoted(words)} ;;")
        for item in one.groups["Options:"]:
            if item.wants_value:
                patterns = "|".join(f"'{state}:{n}'" for n in item.names)
                values.append(f"    {patterns}) options='' words={quoted(item.choices)} value=1 ;;")
    steps = "\n".join(steps) or "      *) ;;"
    values = "\n".join(values) or "    *) ;;"
    sets = "\n".join(sets)
    return f"""# bash completion for {name}, made from its --help
{function}() {{
  local cur=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}} state='' options words value=0 i
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case "$state:${{COMP_WORDS[i]}}" in
{steps}
    esac
  done
  case "$state" in
{sets}
  esac
  case "$state:$before" in
{values}
  esac
  if [[ $value == 0 && $cur == -* ]]; then words=$options; fi
  COMPREPLY=($(compgen -W "$words" -- "$cur"))
}}
complete -o default -F {function} {name}
"""


def zsh(command):
    name = command.words[0]
    function = "_complete_" + name.replace("-", "_")
    return f"""#compdef {name}
# Uses the completion for bash in the folder next to this one.
autoload -U +X bashcompinit && bashcompinit
source ${{${{(%):-%x}}:A:h}}/../../bash-completion/completions/{name}
_bash_complete -o default -F {function}
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--programs", type=pathlib.Path, required=True, help="folder of the programs")
    parser.add_argument("--output", type=pathlib.Path, required=True, help="folder to write")
    parser.add_argument("names", nargs="+", metavar="NAME")
    arguments = parser.parse_args()
    for folder in ("man", "bash", "zsh"):
        (arguments.output / folder).mkdir(parents=True, exist_ok=True)
    for name in arguments.names:
        program = arguments.programs / name
        try:
            command = ask(program, [name])
            version = subprocess.run([str(program), "--version"], capture_output=True, text=True,
                                     timeout=60, check=True).stdout.split()[-1]
        except (OSError, ValueError, IndexError, subprocess.SubprocessError) as error:
            print(f"error: {name}: {error}", file=sys.stderr)
            return 1
        (arguments.output / "man" / f"{name}.1").write_text(manual(command, version, arguments.names))
        (arguments.output / "bash" / name).write_text(bash(command))
        (arguments.output / "zsh" / f"_{name}").write_text(zsh(command))
    return 0


if __name__ == "__main__":
    sys.exit(main())
