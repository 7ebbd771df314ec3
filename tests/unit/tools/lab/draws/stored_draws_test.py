"""Stored results are reused by the code that made them, and by no other."""

import os
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(os.environ.get("PALPATE_SOURCE_DIR", Path(__file__).resolve().parents[5]))
sys.path.append(str(SOURCE / "tools/lab/draws"))

from stored_draws import StoredDraws, fingerprint  # noqa: E402


class StoredDrawsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        self.code = self.root / "code"
        self.code.mkdir()
        (self.code / "study.py").write_text("a = 1\n")
        self.computed = 0

    def compute(self):
        self.computed += 1
        return {"error": (0.5, self.computed)}

    def draws(self):
        return StoredDraws(self.root / "out", [self.code])

    def test_a_finished_draw_is_not_computed_again(self):
        first = self.draws().get("draw_1", self.compute)
        self.assertEqual(self.draws().get("draw_1", self.compute), first)
        self.assertEqual(first, {"error": [0.5, 1]})
        self.assertEqual(self.computed, 1)

    def test_changed_code_computes_again(self):
        self.draws().get("draw_1", self.compute)
        (self.code / "study.py").write_text("a = 2\n")
        self.assertEqual(self.draws().get("draw_1", self.compute)["error"][1], 2)
        (self.code / "other.py").write_text("b = 1\n")
        self.assertEqual(self.draws().get("draw_1", self.compute)["error"][1], 3)

    def test_a_draw_that_fails_leaves_nothing(self):
        def fail():
            raise RuntimeError("no")

        with self.assertRaises(RuntimeError):
            self.draws().get("draw_1", fail)
        self.draws().get("draw_1", self.compute)
        self.assertEqual(self.computed, 1)

    def test_a_file_that_was_written_half_is_no_result(self):
        (self.root / "out").mkdir()
        (self.root / "out/draw_1.partial").write_text('{"made_by"')
        self.draws().get("draw_1", self.compute)
        self.assertEqual(self.computed, 1)

    def test_compiled_files_do_not_count(self):
        before = fingerprint([self.code])
        (self.code / "__pycache__").mkdir()
        (self.code / "__pycache__/study.cpython-311.pyc").write_bytes(b"x")
        self.assertEqual(fingerprint([self.code]), before)

    def test_a_folder_without_sources_is_an_error(self):
        (self.root / "empty").mkdir()
        with self.assertRaisesRegex(ValueError, "empty"):
            fingerprint([self.root / "empty"])


if __name__ == "__main__":
    unittest.main()
