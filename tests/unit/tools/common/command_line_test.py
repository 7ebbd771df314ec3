"""Exit codes of wrong input, and options whose values have ranges."""

import contextlib
import io
import os
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(os.environ["PALPATE_SOURCE_DIR"], "tools/common")))

from palpate_common.command_line import Number, Parser, PositionAndAngle, exit_code_of  # noqa: E402
from palpate_common.input_error import WRONG_CONFIGURATION, InputError  # noqa: E402


def raised(error):
    raise error


class ExitCodes(unittest.TestCase):
    def test_are_those_of_the_work_or_of_the_error_that_ends_it(self):
        for work, code, message in (
            (lambda: 0, 0, ""),
            (lambda: 1, 1, ""),
            (lambda: raised(InputError("a.csv:2: x")), 1, "palpate-x: a.csv:2: x\n"),
            (lambda: raised(InputError("a.yaml:2: y", WRONG_CONFIGURATION)), 78, "palpate-x: a.yaml:2: y\n"),
            (lambda: open("/no/such"), 1, "palpate-x: /no/such: No such file or directory\n"),
            (lambda: raised(OSError("closed")), 1, "palpate-x: closed\n"),
        ):
            with contextlib.redirect_stderr(io.StringIO()) as said:
                self.assertEqual(exit_code_of("palpate-x", work), code)
            self.assertEqual(said.getvalue(), message)


class Ranges(unittest.TestCase):
    def setUp(self):
        self.parser = Parser("palpate-x", "", "[OPTIONS]", "")
        self.parser.add_argument("--off", default=[0.1, 5.0], action=PositionAndAngle, position=Number(0.01, 1),
                                 angle=Number(1, 20), help="m, degrees")  # fmt: skip

    def test_both_values_are_checked(self):
        self.assertEqual(self.parser.parse_args([]).off, [0.1, 5.0])
        self.assertEqual(self.parser.parse_args(["--off", "1", "20"]).off, [1, 20])
        for values in (("2", "5"), ("0.1", "0.5"), ("nan", "5")):
            with contextlib.redirect_stderr(io.StringIO()) as said, self.assertRaises(SystemExit) as caught:
                self.parser.parse_args(["--off", *values])
            self.assertEqual(caught.exception.code, 64)
            self.assertIn("allowed: 0.01 to 1 m, 1 to 20 degrees", said.getvalue())

    def test_help_states_the_defaults(self):
        self.assertIn("--off FLOAT=0.1 5.0 x 2     m, degrees", self.parser.format_help())


if __name__ == "__main__":
    unittest.main(verbosity=2)
