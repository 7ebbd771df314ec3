"""measure_regrasp follows a cube and a bar that are put down and grasped again elsewhere, and resumes.

usage: regrasp_test.py BINARIES SOURCE
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

BINARIES, SOURCE = sys.argv[1:3]
PROGRAM = pathlib.Path(SOURCE, "tools/lab/regrasp/measure_regrasp")


def measure(folder, *words):
    return subprocess.run(["/usr/bin/python3", "-B", PROGRAM, "--draws", "2", "--programs", BINARIES, "--output", folder, *words],
                          capture_output=True, text=True)


class RegraspTest(unittest.TestCase):
    def test_a_sequence_of_each_object(self):
        with tempfile.TemporaryDirectory() as folder:
            done = measure(folder)
            self.assertEqual(done.returncode, 0, done.stderr)
            draws = json.loads(pathlib.Path(folder, "regrasp.json").read_text())["draws"]
            self.assertEqual([draw["object"] for draw in draws], ["cube", "bar"])
            for draw in draws:
                self.assertEqual(draw["grasps_found"], draw["closings"])
                self.assertEqual(draw["rejected_commands"], 0)
                self.assertLess(draw["largest_mean_error"], 1.5e-3)
            stored = pathlib.Path(folder, "draw_0.json")
            document = json.loads(stored.read_text())
            document["result"]["mean_error"] = 0.123
            stored.write_text(json.dumps(document))
            self.assertIn("mean error 123.00 mm", measure(folder).stdout)  # what is finished is not run again

    def test_a_wrong_command_line_is_refused(self):
        self.assertEqual(measure("unused", "--dra", "x").returncode, 64)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
