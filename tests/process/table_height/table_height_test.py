"""measure_height finds the height of a table that is configured 5 mm too low, and resumes.

usage: table_height_test.py BINARIES SOURCE
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

BINARIES, SOURCE = sys.argv[1:3]
PROGRAM = pathlib.Path(SOURCE, "tools/lab/table_height/measure_height")


def measure(folder, *words):
    return subprocess.run(["/usr/bin/python3", "-B", PROGRAM, "--draws", "1", "--programs", BINARIES, "--output", folder, *words],
                          capture_output=True, text=True)


class TableHeightTest(unittest.TestCase):
    def test_one_draw(self):
        with tempfile.TemporaryDirectory() as folder:
            done = measure(folder)
            self.assertEqual(done.returncode, 0, done.stderr)
            draw = json.loads(pathlib.Path(folder, "table_height.json").read_text())["draws"][0]
            self.assertEqual(draw["offset"], -0.005)
            self.assertLess(abs(draw["height_error"]), 2e-3)
            self.assertLess(abs(draw["height_error"]), 1.96 * draw["deviation"])
            self.assertLess(draw["shape_error"], 2e-3)
            self.assertTrue(pathlib.Path(folder, "heights.png").exists())
            stored = pathlib.Path(folder, "draw_0.json")
            document = json.loads(stored.read_text())
            document["result"]["shape_error"] = 0.123
            stored.write_text(json.dumps(document))
            self.assertIn("123.00 /", measure(folder).stdout)  # what is finished is not run again

    def test_a_wrong_command_line_is_refused(self):
        self.assertEqual(measure("unused", "--dra", "x").returncode, 64)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
