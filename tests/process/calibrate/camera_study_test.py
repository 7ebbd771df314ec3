"""measure_camera on few draws: figures, resumption, and wrong use.

usage: camera_study_test.py BINARIES SOURCE
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

PROGRAM = pathlib.Path(sys.argv[2]).resolve() / "tools/lab/camera_calibration/measure_camera"


def measure(folder, *words):
    return subprocess.run([PROGRAM, "--way", "touches", "--draws", "2", "--first", "3000", "--output", folder, *words],
                          capture_output=True, text=True)  # fmt: skip


class Study(unittest.TestCase):
    def test_two_draws(self):
        with tempfile.TemporaryDirectory() as folder:
            done = measure(folder)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(done.stdout.count("goal"), 5)
            values = json.loads(pathlib.Path(folder, "camera_calibration.json").read_text())["touches"]
            self.assertLess(values["position"], 3)
            self.assertLess(values["rotation"], 0.3)
            stored = pathlib.Path(folder, "touches_3000.json")
            document = json.loads(stored.read_text())
            document["result"]["at_work"] = 7.0
            stored.write_text(json.dumps(document))
            self.assertRegex(measure(folder).stdout, "95 % within 6[0-9]{3}")  # what is finished is not run again

    def test_a_wrong_command_line_is_refused(self):
        self.assertEqual(measure("unused", "--way", "x").returncode, 64)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
