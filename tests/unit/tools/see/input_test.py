"""Depth images and series of files: back projection, edges, time stamps, and what is wrong with them."""
import pathlib
import tempfile
import unittest

import support  # noqa: F401

import numpy as np

from palpate_common.input_error import InputError
from palpate_see.depth_images import Intrinsics, back_project, read_depth
from palpate_see.edges import EdgeFilter
from palpate_see.file_source import IMAGES, exposures, read_clouds, read_images

CAMERA = Intrinsics(40, 30, 50.0, 60.0, 19.5, 14.5)
ALL = EdgeFilter(pixels=0)


class Images(unittest.TestCase):
    def test_points_project_back_to_their_pixels(self):
        depth = np.random.default_rng(1).uniform(1, 1.001, (30, 40))
        points = back_project(depth, CAMERA)
        pixels = np.column_stack([CAMERA.fx * points[:, 0] / points[:, 2] + CAMERA.cx,
                                  CAMERA.fy * points[:, 1] / points[:, 2] + CAMERA.cy])  # fmt: skip
        rows, columns = np.indices(depth.shape)
        np.testing.assert_allclose(pixels, np.column_stack([columns.ravel(), rows.ravel()]), atol=1e-9)
        np.testing.assert_array_equal(points[:, 2], depth.ravel())

    def test_pixels_without_depth_have_no_point(self):
        depth = np.ones((30, 40))
        depth[3, 4] = 0
        self.assertEqual(np.flatnonzero(np.isnan(back_project(depth, CAMERA)[:, 0])).tolist(), [3 * 40 + 4])

    def test_pixels_at_a_jump_are_left_out_on_both_sides(self):
        depth = np.ones((30, 40))
        depth[:, 20:] = 1.1
        for pixels in (1, 2, 3):
            at_edge = EdgeFilter(0.02, pixels).of_image(depth)
            expected = [20 - pixels <= column < 20 + pixels for column in range(40)]
            self.assertEqual(at_edge[7].tolist(), expected)
        # A surface that is steep but smooth has no edge.
        self.assertFalse(EdgeFilter(0.02, 2).of_image(1 + 0.015 * np.arange(40.0)[None] * np.ones((30, 1))).any())

    def test_edges_of_a_cloud_are_those_of_its_image(self):
        depth = np.ones((30, 40))
        depth[8:20, 10:25] = 0.9
        depth[2:5, 30:33] = 0
        points = back_project(depth, Intrinsics(40, 30, 50.0, 50.0, 19.5, 14.5))  # square pixels
        in_order = np.flatnonzero(np.isfinite(points[:, 0]))
        shuffled = np.random.default_rng(3).permutation(in_order)
        for pixels in (1, 2):
            edges = EdgeFilter(0.02, pixels)
            expected = edges.of_image(depth).reshape(-1)
            found = np.zeros(depth.size, bool)
            found[shuffled] = edges.of_cloud(points[shuffled], points[in_order])
            self.assertTrue(found[expected].all())
            # Away from borders and holes: of a square of neighbours, with its corners.
            inner = np.zeros(depth.shape, bool)
            inner[6:24, 6:28] = True
            squares = np.lib.stride_tricks.sliding_window_view(np.pad(depth, pixels, mode="edge"), (2 * pixels + 1,) * 2)
            jumps = (squares.max(axis=(2, 3)) - squares.min(axis=(2, 3)) > 0.05) & inner
            np.testing.assert_array_equal(found[inner.reshape(-1)], jumps[inner])
            # The edge is also found where only the object's side is asked for.
            of_object = shuffled[depth.reshape(-1)[shuffled] == 0.9]
            self.assertTrue(edges.of_cloud(points[of_object], points[in_order])[expected[of_object]].all())
        self.assertFalse(EdgeFilter(0.02, 0).of_cloud(points[in_order], points[in_order]).any())
        self.assertEqual(EdgeFilter().of_cloud(np.zeros((0, 3)), points[in_order]).shape, (0,))

    def test_units_of_png_and_npy(self):
        from PIL import Image

        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            depth = np.random.default_rng(2).integers(0, 5000, (30, 40)).astype(np.uint16)
            Image.fromarray(depth).save(folder / "a.png")
            np.save(folder / "a.npy", depth)
            np.save(folder / "b.npy", np.where(depth > 0, depth / 1000, np.nan))
            for file in ("a.png", "a.npy", "b.npy"):
                np.testing.assert_allclose(read_depth(folder / file, CAMERA), depth / 1000, err_msg=file)
            Image.fromarray(depth.astype(np.uint8)).save(folder / "8.png")
            np.save(folder / "wide.npy", np.ones((30, 41)))
            (folder / "broken.png").write_bytes(b"\x89PNG\r\n\x1a\n123")
            for file, words in (("8.png", "uint8.*16 bits"), ("wide.npy", "41 x 30 pixels; allowed: 40 x 30"),
                                ("broken.png", "broken"),
                                ("none.png", "No such file"), ("a.tif", "reads .png")):  # fmt: skip
                with self.assertRaisesRegex(InputError, words):
                    read_depth(folder / file, CAMERA)


class Series(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_a_folder_is_sorted_by_its_stamps(self):
        for stamp in (1000, 20, 300):
            np.save(self.folder / f"d_{stamp}.npy", np.full((30, 40), stamp / 1000))
        (self.folder / "notes.txt").write_text("")
        self.assertEqual([utime for utime, _ in exposures(self.folder, IMAGES)], [20, 300, 1000])
        clouds = list(read_images(self.folder, CAMERA, ALL))
        self.assertEqual([(cloud.utime, cloud.points[0, 2]) for cloud in clouds], [(20, 0.02), (300, 0.3), (1000, 1.0)])

    def test_a_list_keeps_its_order_and_names_relative_files(self):
        (self.folder / "sub").mkdir()
        (self.folder / "sub/a.xyz").write_text("0 0 1 255 0 0\n0 1 1 0 0 255\n")
        (self.folder / "list.csv").write_text("file,utime\nsub/a.xyz, 7\nsub/a.xyz,3\n")
        clouds = list(read_clouds(self.folder / "list.csv"))
        self.assertEqual([cloud.utime for cloud in clouds], [7, 3])
        np.testing.assert_allclose(clouds[0].colours, [[1, 0, 0], [0, 0, 1]])

    def test_what_is_wrong_is_named(self):
        listed = self.folder / "list.csv"
        for text, words in (("time,file\n1,a\n", "list.csv:1: unknown column 'time'; allowed: utime,file"),
                            ("utime,file\n1.5,a.ply\n", "list.csv:2: utime: '1.5'; allowed: a whole number of us"),
                            ("utime,file\n1\n", "list.csv:2: 1 values for 2 columns"),
                            ("utime,file\n1,\n", "list.csv:2: file: is absent"), ("utime,file\n", "lists no file"),
                            ("", "is empty; its first line names the columns: utime,file")):  # fmt: skip
            listed.write_text(text)
            with self.assertRaisesRegex(InputError, words):
                exposures(listed, IMAGES)
        with self.assertRaisesRegex(InputError, "holds no file of .png"):
            exposures(self.folder, IMAGES)
        (self.folder / "a.png").write_bytes(b"")
        with self.assertRaisesRegex(InputError, "a.png: its name has no time stamp; .*cloud_1700000000000000.png"):
            exposures(self.folder, IMAGES)
        with self.assertRaisesRegex(InputError, "none.csv: No such file"):
            exposures(self.folder / "none.csv", IMAGES)


if __name__ == "__main__":
    unittest.main(verbosity=2)
