"""YAML sections: places in messages, and configurations that change the file they name as their base."""

import os
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(os.environ["PALPATE_SOURCE_DIR"], "tools/common")))

from palpate_common.frames import rotation_and_position  # noqa: E402
from palpate_common.input_error import InputError  # noqa: E402
from palpate_common.section import plain, read_configuration_section, read_section  # noqa: E402


class Files(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def file(self, name, text):
        path = self.folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
        return path

    def test_messages_name_file_line_key_value_and_what_is_allowed(self):
        section = read_section(self.file("a.yaml", "x: 1\ny:\n  z: [1, two]\n"))
        with self.assertRaises(InputError) as caught:
            section.section("y").numbers("z", 2, 0, 3)
        self.assertEqual(str(caught.exception), f"{self.folder}/a.yaml:3: y.z: [1, 'two']; allowed: 2 numbers from 0 to 3")
        with self.assertRaisesRegex(InputError, r"a.yaml:1: x: is unknown; allowed: y"):
            section.check_unused()
        with self.assertRaisesRegex(InputError, r"a.yaml:2: .*"):
            read_section(self.file("a.yaml", "x: 1\n y: 2\n"))
        with self.assertRaisesRegex(InputError, "none.yaml: No such file"):
            read_section(self.folder / "none.yaml")

    def test_whole_numbers(self):
        section = read_section(self.file("a.yaml", "a: 3\nb: 3.0\nc: true\nd: 12\n"))
        self.assertEqual((section.whole("a", 1, 10), section.whole("e", 1, 10, 7)), (3, 7))
        for key, words in (("b", "b: 3.0; allowed: a whole number from 1 to 10"), ("c", "c: True"), ("d", "d: 12"),
                           ("e", "required")):  # fmt: skip
            with self.assertRaisesRegex(InputError, words):
                section.whole(key, 1, 10)

    def test_numbers_are_read_as_palpated_reads_them(self):
        section = read_section(self.file("a.yaml", "e: 30e3\nf: 1.5E-2\ng: -2\nt: e3\n"))
        self.assertEqual([section.number(key, -10, 1e6) for key in "efg"], [30e3, 0.015, -2.0])
        self.assertEqual(section.text("t"), "e3")

    def test_a_file_changes_its_base_key_by_key(self):
        self.file("deep/base.yaml", "a: {b: 1, c: {d: 2}}\nlist: [1, 2]\nmesh: {file: bar.msh}\n")
        top = read_configuration_section(self.file("own.yaml", "base: deep/base.yaml\na: {b: ~, c: {e: 3}}\nlist: [4]\n"))
        self.assertEqual(plain(top.values), {"a": {"c": {"d": 2, "e": 3}}, "list": [4], "mesh": {"file": "bar.msh"}})
        self.assertEqual(top.section("mesh").file_of("file"), self.folder / "deep/base.yaml")
        with self.assertRaisesRegex(InputError, r"deep/base.yaml:1: a.c.d: 2; allowed: a number from 3 to 4"):
            top.optional("a", "c").number("d", 3, 4)
        with self.assertRaisesRegex(InputError, r"own.yaml:2: a.c.e: 3"):
            top.optional("a", "c").number("e", 4, 5)

    def test_a_circle_of_bases_ends(self):
        with self.assertRaisesRegex(InputError, "base: own.yaml; allowed: at most 16 files"):
            read_configuration_section(self.file("own.yaml", "base: own.yaml\n"))

    def test_one_notation_of_a_rotation(self):
        pose = read_section(self.file("a.yaml", "position: [1, 2, 3]\nrpy_deg: [0, 0, 90]\n"))
        rotation, position = rotation_and_position(pose)
        self.assertEqual([round(v) for v in rotation @ [1, 0, 0]], [0, 1, 0])
        self.assertEqual(list(position), [1, 2, 3])
        for text, expected in (("rpy_deg: [0, 0, 1]\nquaternion: [1, 0, 0, 0]", "in addition to rpy_deg"),
                               ("quaternion: [1, 1, 0, 0]", "allowed: length 1")):
            with self.assertRaisesRegex(InputError, expected):
                rotation_and_position(read_section(self.file("a.yaml", text + "\n")))


if __name__ == "__main__":
    unittest.main()
