"""Common parts of the tests of tools/import."""

import contextlib
import io
import os
import pathlib
import sys
import tempfile
import unittest

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
SOURCE = pathlib.Path(os.environ["PALPATE_SOURCE_DIR"])
sys.path[:0] = [str(SOURCE / "tools" / folder) for folder in ("import", "common")]

import palpate  # noqa: E402

from palpate_import.command import main  # noqa: E402
from palpate_import.layouts import TYPES  # noqa: E402

URDF = SOURCE / "sim/robot/lwr_hand.urdf"
WRENCH = "t,fx,fy,fz,tx,ty,tz\n"


class ImportTest(unittest.TestCase):
    """A folder of its own, and the program as its command line runs it."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.csv, self.log = self.folder / "in.csv", self.folder / "out.log"
        self.said = self.complaint = ""

    def write(self, text, name="in.csv"):
        (self.folder / name).write_text(text)
        return self.folder / name

    def run_program(self, *words):
        """Exit code; what it printed is in `said` and `complaint`."""
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            try:
                code = main([str(word) for word in words], "0")
            except SystemExit as ended:
                code = ended.code
        self.said, self.complaint = out.getvalue(), err.getvalue()
        return code

    def imported(self, *words):
        """{channel: [(utime of the event, message)]} of a log with session 42."""
        code = self.run_program(*words, "-o", self.log, "--session", 42)
        self.assertEqual(code, 0, self.complaint)
        return self.read()

    def read(self):
        found = {}
        kinds = {
            getattr(palpate.messages, name)._get_packed_fingerprint(): getattr(palpate.messages, name)
            for name in TYPES.values()
        }
        for event in palpate.EventLog(self.log):
            found.setdefault(event.channel, []).append((event.utime, kinds[event.data[:8]].decode(event.data)))
        return found

    def messages(self, *words, channel="CHANNEL"):
        return [message for _, message in self.imported(*words)[channel]]

    def refused(self, *words, code=1):
        """What is complained about, in one line; nothing is written."""
        self.assertEqual(self.run_program(*words, "-o", self.log), code, self.complaint)
        self.assertFalse(self.log.exists())
        self.assertFalse(self.log.with_name(self.log.name + ".part").exists())
        self.assertEqual(self.complaint.count("\n"), 1 if code != 64 else 2, self.complaint)
        return self.complaint

    def of(self, kind, *words):
        """Words of one channel of the file."""
        return [self.csv, "--format", kind, "--channel", "CHANNEL", *words]
