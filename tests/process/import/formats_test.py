#!/usr/bin/env python3
"""docs/import.md is what palpate-import --formats prints, and its --help names that option.

usage: formats_test.py ROOT BIN [UNITTEST-OPTIONS]
"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT, BIN = (pathlib.Path(sys.argv.pop(1)).resolve() for _ in range(2))


def run(*words):
    return subprocess.run([str(BIN / "palpate-import"), *map(str, words)], capture_output=True, text=True, timeout=60)


class Formats(unittest.TestCase):
    def test_the_page_is_what_the_program_prints(self):
        done = run("--formats")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual((ROOT / "docs/import.md").read_text(), done.stdout,
                         "write it again: palpate-import --formats > docs/import.md")

    def test_help_names_the_option(self):
        text = run("--help").stdout
        self.assertRegex(text, r"(?m)^  --formats ")
        self.assertIn("--formats lists", " ".join(text.split()))

    def test_missing_columns_are_one_error_of_one_line(self):
        with tempfile.TemporaryDirectory() as folder:
            csv = pathlib.Path(folder) / "in.csv"
            csv.write_text("t;fx;fy\n0;1;2\n")
            done = run(csv, "--format", "force_torque", "--channel", "FT_WRENCH", "-o", csv.with_suffix(".log"))
            self.assertEqual(done.returncode, 1)
            self.assertIn("no columns 'fz', 'tx', 'ty', 'tz'; the columns are t, fx, fy", done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
            self.assertFalse(csv.with_suffix(".log").exists())


if __name__ == "__main__":
    unittest.main(verbosity=2)
