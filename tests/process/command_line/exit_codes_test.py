#!/usr/bin/env python3
"""Every program ends with the exit codes that its --help and docs/exit_codes.md state.

usage: exit_codes_test.py ROOT BIN [UNITTEST-OPTIONS]
"""
import pathlib
import re
import subprocess
import sys
import unittest

ROOT, BIN = (pathlib.Path(sys.argv.pop(1)).resolve() for _ in range(2))
# Neither has --help: started by palpated with a module on standard input; google-benchmark's and
# googletest's own options.
WITHOUT = {"palpate-probe", "bench_core_control", "bench_core_elasticity", "bench_core_math_qp", "bench_rt_bus",
           "bench_sim_camera", "bench_sim_object", "bench_core_elasticity_agreement"}


def programs():
    for path in sorted(BIN.iterdir()):
        is_ours = re.fullmatch(r"palpated|palpate-[a-z-]+|bench_\w+|driver_template", path.name)
        if is_ours and path.name not in WITHOUT and path.read_bytes()[:4] == b"\x7fELF":
            yield path


def run(*words):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=60)


def table(text):
    """{code: meaning} of a --help."""
    found = re.search(r"^Exit codes: .*(?:\n {12}.*)*", text, re.M)
    lines = found.group(0)[len("Exit codes: "):].splitlines() if found else []
    return {int(line.split()[0]): line.strip().split(None, 1)[1] for line in lines}


def documented():
    """{code: programs} of docs/exit_codes.md."""
    rows = re.findall(r"^\| (\d+) \| [^|]* \| ([^|]*) \|$", (ROOT / "docs/exit_codes.md").read_text(), re.M)
    return {int(code): cell for code, cell in rows}


class ExitCodes(unittest.TestCase):
    def test_some_programs_are_built(self):
        self.assertGreater(len(list(programs())), 0)

    def test_a_wrong_command_line_ends_with_64_and_names_help(self):
        for program in programs():
            done = run(program, "--no-such-option")
            self.assertEqual(done.returncode, 64, f"{program.name}: {done.stdout}{done.stderr}")
            self.assertIn("--help", done.stderr, program.name)

    def test_help_states_the_codes_once(self):
        for program in programs():
            done = run(program, "--help")
            self.assertEqual(done.returncode, 0, program.name)
            self.assertLessEqual({0, 1, 64}, set(table(done.stdout)), program.name)
            self.assertEqual(done.stdout.count("Exit codes:"), 1, program.name)

    def test_so_does_the_help_of_each_command(self):
        for program in programs():
            commands = re.search(r"^Subcommands:\n((?:  .*\n)+)", run(program, "--help").stdout, re.M)
            for name in re.findall(r"^  (\S+)", commands.group(1), re.M) if commands else []:
                done = run(program, name, "--help")
                self.assertEqual(done.returncode, 0, (program.name, name))
                self.assertEqual(done.stdout.count("Exit codes:"), 1, (program.name, name))

    def test_the_page_has_each_code_and_no_two_mean_different_things(self):
        page = documented()
        for program in programs():
            for code in table(run(program, "--help").stdout):
                self.assertIn(code, page, f"{program.name}: {code} is not in docs/exit_codes.md")
                if page[code].startswith("`"):
                    self.assertIn(f"`{program.name}`", page[code], code)
        self.assertNotIn(2, page, "had three meanings")


if __name__ == "__main__":
    unittest.main(verbosity=2)
