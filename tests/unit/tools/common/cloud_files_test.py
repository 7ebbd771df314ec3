"""Clouds of all formats, with and without colours, and what is wrong with them."""
import os
import pathlib
import struct
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(os.environ["PALPATE_SOURCE_DIR"])
sys.path.insert(0, str(SOURCE / "tools/common"))

import numpy as np  # noqa: E402

from palpate_common.cloud_files import read_cloud, read_coloured_cloud  # noqa: E402
from palpate_common.input_error import InputError  # noqa: E402

PLY = "ply\nformat {}\nelement vertex 20\nproperty float x\nproperty float y\nproperty float z\n{}end_header\n"
PCD = "VERSION 0.7\nFIELDS x y z{}\nSIZE 4 4 4{}\nTYPE F F F{}\nCOUNT 1 1 1{}\nWIDTH 20\nHEIGHT 1\nPOINTS 20\nDATA {}\n"
POINTS = np.random.default_rng(1).normal(size=(20, 3)).astype(np.float32)
COLOURS = np.random.default_rng(2).integers(0, 256, (20, 3))
TEXT = "\n".join(f"{a:.9g} {b:.9g} {c:.9g}" for a, b, c in POINTS)


class Clouds(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def refused(self, path, *parts):
        with self.assertRaises(InputError) as caught:
            read_cloud(path)
        for part in (path.name, *parts):
            self.assertIn(part, str(caught.exception))

    def test_points_of_all_formats(self):
        packed = b"".join(struct.pack("<fffB", *point, 7) for point in POINTS)
        contents = {
            "a.xyz": TEXT.encode(),
            "b.xyz": "\n".join(line + " 1 a" for line in TEXT.splitlines()).encode(),
            "a.ply": (PLY.format("ascii 1.0", "") + TEXT).encode(),
            "b.ply": PLY.format("binary_little_endian 1.0", "property uchar red\n").encode() + packed,
            "a.pcd": (PCD.format("", "", "", "", "ascii") + TEXT).encode(),
            "b.pcd": PCD.format(" i", " 1", " U", " 1", "binary").encode() + packed,
        }
        for name, data in contents.items():
            file = self.folder / name
            file.write_bytes(data)
            np.testing.assert_allclose(read_cloud(file), POINTS, rtol=1e-6, err_msg=name)
            self.assertIsNone(read_coloured_cloud(file).colours, name)
        for shape in ((20, 3), (4, 5, 3)):
            np.save(self.folder / "a.npy", POINTS.reshape(shape))
            np.testing.assert_allclose(read_cloud(self.folder / "a.npy"), POINTS)
        (self.folder / "b.ply").write_bytes(contents["b.ply"][:-40])
        self.refused(self.folder / "b.ply", "ends before the 20 points")
        (self.folder / "a.xyz").write_text("1 2 3\n1 2\n")
        self.refused(self.folder / "a.xyz", "line 2")

    def test_colours_of_all_formats(self):
        words = [(r << 16) | (g << 8) | b for r, g, b in COLOURS.tolist()]
        channels = "property uchar red\nproperty uchar green\nproperty uchar blue\n"
        lines = [line + " " + " ".join(map(str, colour)) for line, colour in zip(TEXT.splitlines(), COLOURS)]
        contents = {
            "a.xyz": "\n".join(lines).encode(),
            "a.ply": (PLY.format("ascii 1.0", channels) + "\n".join(lines)).encode(),
            "b.ply": PLY.format("binary_big_endian 1.0", channels).encode()
            + b"".join(struct.pack(">fffBBB", *point, *colour) for point, colour in zip(POINTS, COLOURS.tolist())),
            "a.pcd": PCD.format(" rgb", " 4", " U", " 1", "binary").encode()
            + b"".join(struct.pack("<fffI", *point, word) for point, word in zip(POINTS, words)),
            "b.pcd": PCD.format(" rgb", " 4", " F", " 1", "binary").encode()
            + b"".join(struct.pack("<fffI", *point, word) for point, word in zip(POINTS, words)),
        }
        for name, data in contents.items():
            file = self.folder / name
            file.write_bytes(data)
            read = read_coloured_cloud(file)
            np.testing.assert_allclose(read.points, POINTS, rtol=1e-6, err_msg=name)
            np.testing.assert_allclose(read.colours, COLOURS / 255, rtol=1e-9, err_msg=name)
        np.save(self.folder / "a.npy", np.hstack([POINTS, COLOURS / 255]))
        np.testing.assert_allclose(read_coloured_cloud(self.folder / "a.npy").colours, COLOURS / 255, rtol=1e-6)

    def test_too_few_and_too_far(self):
        file = self.folder / "a.xyz"
        file.write_text("1 2 3\nnan 0 0\n")
        self.assertEqual(read_coloured_cloud(file).points.shape, (2, 3))
        self.refused(file, "1 finite points", "10 or more")
        file.write_text("1000 0 0\n" * 10)
        self.refused(file, "1000 m", "in mm")
        self.refused(self.folder / "a.las", ".ply, .pcd")
        self.refused(self.folder / "none.ply", "No such file")


if __name__ == "__main__":
    unittest.main(verbosity=2)
