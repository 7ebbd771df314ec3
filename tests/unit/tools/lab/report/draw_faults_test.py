"""The picture of palpate-evaluate faults, from its CSV."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
from importlib.machinery import SourceFileLoader

sys.dont_write_bytecode = True
FILE = pathlib.Path(os.environ["PALPATE_SOURCE_DIR"]) / "tools/lab/report/draw_faults"
draw_faults = SourceFileLoader("draw_faults", str(FILE)).load_module()
HEADER = "row,fault,seeds,unaffected,degraded,safe_stop,failed,state_s,back_s,met\n"


class Faults(unittest.TestCase):
    def draw(self, text):
        """(output, width and height of the picture)."""
        with tempfile.TemporaryDirectory() as name:
            file = pathlib.Path(name) / "faults.csv"
            file.write_text(HEADER + text, encoding="utf-8")
            done = subprocess.run([sys.executable, FILE, file], capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
            data = file.with_suffix(".png").read_bytes()
            return done.stdout, [int.from_bytes(data[at:at + 4], "big") for at in (16, 20)]

    def test_each_row_has_its_place(self):
        row = '{},"a $fault$, named",100,90,10,0,0,0.012,-1,1\n'
        said, one = self.draw(row.format(1))
        self.assertIn("faults.png", said)
        _, three = self.draw("".join(row.format(k) for k in range(3)))
        self.assertEqual((one[0], three[0], three[1] - one[1]), (1100, 1100, 44))

    def test_a_label_has_the_times_and_what_was_missed(self):
        row = {"row": "7", "fault": "x", "state_s": "0.012", "back_s": "-1", "met": "1"}
        self.assertEqual(draw_faults.label(row), "7 x  (12 / - ms)")
        self.assertEqual(draw_faults.label({**row, "state_s": "-1", "met": "0"}), "7 x  MISSED")

    def test_a_single_seed_is_no_longer_white(self):
        self.assertEqual(draw_faults.colour(0xff0000, 0), [1, 1, 1])
        self.assertEqual(draw_faults.colour(0xff0000, 1), [1, 0, 0])
        self.assertLess(draw_faults.colour(0xff0000, 1e-3)[1], 0.81)


if __name__ == "__main__":
    unittest.main()
