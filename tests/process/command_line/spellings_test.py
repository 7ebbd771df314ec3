#!/usr/bin/env python3
"""--output, --config and --url are spelled alike in every program; the old spellings work and print a warning.

usage: spellings_test.py ROOT BIN [UNITTEST-OPTIONS]
"""
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT, BIN = (pathlib.Path(sys.argv.pop(1)).resolve() for _ in range(2))
EXAMPLE = ROOT / "rt/config/examples/bar_long_soft.yaml"
# (words with an old spelling, the warning's end, exit code): each ends before it does anything.
OLD = (
    (["palpated", EXAMPLE, "--set", "no_such_key=1"], "configuration is deprecated; use --config", 78),
    (["palpate-doctor", EXAMPLE, "--channels", "--set", "no_such_key=1"], "use --config", 78),
    (["palpate-export", "png", EXAMPLE, "-o", "a.png", "--configuration", EXAMPLE], "use --config", 1),
    (["palpate-export", "mcap", EXAMPLE, "-o", "a.mcap", f"--configuration={EXAMPLE}"], "use --config", 1),
    (["palpate-fit", "no_such_plan", "--out", "fitted"], "--out is deprecated; use --output", 78),
    (["palpate-train", "no_such_plan", "--data", ".", "--out", "a.pt"], "use --output", 78),
    (["palpate-evaluate", "thesis", "--list", "--out", "thesis"], "use --output", 0),
    (["palpate-collect", "emulate", "--out", "no/such/folder/a.csv"], "use --output", 1),
    (["palpate-command", "--housekeeping", "udpm://10.0.0.1:1", "start"], "use --url housekeeping=...", 1),
    (["palpate-view", "--housekeeping", "udpm://10.0.0.1:1", "--three", "none"], "use --url housekeeping=...", 1),
    (["palpate-inject", "malformed", "udpm://10.0.0.1:1"], "url is deprecated; use --url", 1),
)


def programs():
    for path in sorted(BIN.iterdir()):
        is_ours = re.fullmatch(r"palpated|palpate-[a-z-]+|driver_template", path.name)
        if is_ours and path.name != "palpate-probe" and path.read_bytes()[:4] == b"\x7fELF":
            yield path


def helps(program):
    """Of the program, and of its commands."""
    text = subprocess.run([program, "--help"], capture_output=True, text=True, timeout=60).stdout
    yield [program.name], text
    commands = re.search(r"^Subcommands:\n((?:  .*\n)+)", text, re.M)
    for name in re.findall(r"^  (\S+)", commands.group(1), re.M) if commands else []:
        done = subprocess.run([program, name, "--help"], capture_output=True, text=True, timeout=60)
        yield [program.name, name], done.stdout


class Spellings(unittest.TestCase):
    def test_help_has_the_new_ones_alone(self):
        for program in programs():
            for words, text in helps(program):
                self.assertNotRegex(text, r"--out(?!put)\b", words)
                self.assertNotRegex(text, r"--configuration\b", words)
                self.assertNotRegex(text, r"(?m)^  --housekeeping TEXT=udpm", words)
                for kind in re.findall(r"(?m)^  --url (.*?)(?: {2}|$)", text):
                    self.assertTrue(kind.startswith("[LABEL=]URL"), (words, kind))

    def test_the_old_ones_work_and_warn_in_one_line(self):
        checked = 0
        for words, warning, code in OLD:
            if not (BIN / words[0]).exists():
                continue
            with tempfile.TemporaryDirectory() as folder:
                done = subprocess.run([BIN / words[0], *map(str, words[1:])], cwd=folder, capture_output=True,
                                      text=True, timeout=60)
            said = done.stdout + done.stderr
            self.assertEqual(done.returncode, code, (words, said))
            warnings = re.findall(r"(?m)^warning: (.* is deprecated; use .*)$", done.stderr)
            self.assertEqual(len(warnings), 1, (words, said))
            self.assertTrue(warnings[0].endswith(warning), (words, warnings))
            checked += 1
        print(f"{checked} of {len(OLD)} old spellings; the other programs are not built")


if __name__ == "__main__":
    unittest.main(verbosity=2)
