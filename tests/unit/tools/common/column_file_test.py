"""CSV files with named columns: what is read, and what is refused with file, line, column and value."""

import os
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(os.environ["PALPATE_SOURCE_DIR"], "tools/common")))

from palpate_common.column_file import Layout, read_columns  # noqa: E402
from palpate_common.input_error import FAILED, InputError  # noqa: E402

LAYOUT = Layout(("name", "x"), (("a", "b"),), {"x": (-1, 1), "a": (0, 9), "b": (0, 9)})


class Columns(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name, "t.csv")

    def read(self, text):
        self.path.write_text(text)
        return read_columns(self.path, LAYOUT)

    def test_numbers_and_texts_in_any_order_of_columns(self):
        table = self.read("x, name\n# a comment\n0.5, one.ply\n\n-1, two.ply # the second\n")
        self.assertEqual(table.texts["name"], ["one.ply", "two.ply"])
        self.assertEqual(table.numbers("x").tolist(), [[0.5], [-1]])
        self.assertEqual((table.has("name"), table.has("a")), (True, False))
        with self.assertRaisesRegex(InputError, "t.csv:5: is too far"):
            table.fail(1, "is too far")
        self.assertEqual(self.read("name,x\n").numbers("x").shape, (0, 1))

    def test_wrong_files_are_refused(self):
        for text, expected in (
            ("", "t.csv: is empty; its first line names the columns: name,x\\[,a,b\\]"),
            ("name\n", "t.csv:1: column 'x' is missing"),
            ("name,x,a\n", "t.csv:1: column 'b' is missing"),
            ("name,x,y\n", "t.csv:1: unknown column 'y'; allowed: name,x"),
            ("name,x,x\n", "t.csv:1: a column twice"),
            ("name,x\none\n", "t.csv:2: 1 values for 2 columns"),
            ("name,x\none,2\n", "t.csv:2: x: '2'; allowed: a number, -1 to 1"),
            ("name,x\none,nan\n", "t.csv:2: x: 'nan'"),
        ):
            with self.assertRaisesRegex(InputError, expected) as caught:
                self.read(text)
            self.assertEqual(caught.exception.exit_code, FAILED)
        with self.assertRaisesRegex(InputError, "none.csv: No such file"):
            read_columns(self.path.with_name("none.csv"), LAYOUT)


if __name__ == "__main__":
    unittest.main(verbosity=2)
