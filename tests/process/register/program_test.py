"""palpate-register from files to files: formats, errors, exit codes, a configuration that palpated reads.

usage: program_test.py BINARIES SOURCE
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
BINARIES, SOURCE = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
sys.path[:0] = [str(SOURCE / "tools" / folder) for folder in ("register", "common")]

import numpy as np  # noqa: E402

from palpate_common.input_error import InputError  # noqa: E402
from palpate_common.mesh_files import read_surface  # noqa: E402
from palpate_common.pose import Pose, difference  # noqa: E402
from palpate_common.rotations import exp_rotation, from_wxyz  # noqa: E402
from palpate_common.surface import box_surface  # noqa: E402
from palpate_register.configuration import read_configuration  # noqa: E402
from palpate_register.touch_file import read_touches  # noqa: E402

PROGRAM = BINARIES / "palpate-register"
EXAMPLE = SOURCE / "rt/config/examples/bar_long_soft.yaml"
FILTER = SOURCE / "rt/config/examples/bar_long_soft_unmeasured_table.yaml"
BAR = box_surface([0.5, 0.06, 0.06])
# Of the example, moved by 20 mm and 5 degrees.
POSE = Pose(exp_rotation([0, 0, np.pi]) @ exp_rotation([0.05, 0.06, 0.03]), np.array([1.37, 0.045, 0.29]))


def run(*words):
    return subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True)


class Case(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def touches(self, surface=BAR, count=16):
        """A CSV file of touches with normals."""
        on, of = surface.samples(count, seed=4)
        points = POSE.of(on) + 2e-4 * np.random.default_rng(1).normal(size=on.shape)
        rows = np.hstack([points, surface.normals[of] @ POSE.R.T])
        file = self.folder / "touches.csv"
        file.write_text("x,y,z,nx,ny,nz\n" + "\n".join(",".join(f"{v:.6f}" for v in row) for row in rows) + "\n")
        return file

    def refused(self, reader, path, *parts):
        with self.assertRaises(InputError) as caught:
            reader(path)
        for part in (path.name, *parts):
            self.assertIn(part, str(caught.exception))


class Program(Case):
    def test_writes_the_pose_the_prior_and_a_picture(self):
        for base, is_filter in ((EXAMPLE, False), (FILTER, True)):
            output = self.folder / "registered.yaml"
            done = run("--config", base, "--touches", self.touches(), "--output", output, "--json", self.folder / "all.json",
                       "--picture", self.folder / "fit.png", "--table", 0.1)  # fmt: skip
            self.assertEqual(done.returncode, 0, done.stderr)
            for words in ("95 % interval", "the mesh fits", "the same after a quarter turn about its long axis", "next touch"):
                self.assertIn(words, done.stdout)
            self.assertEqual((self.folder / "fit.png").read_bytes()[:4], b"\x89PNG")
            found = json.loads((self.folder / "all.json").read_text())
            pose = Pose(from_wxyz(found["object_in_base"]["quaternion"]), np.array(found["object_in_base"]["position"]))
            step = difference(pose, POSE, BAR.center)
            self.assertLess(np.linalg.norm(step[:3]), 1e-3)
            self.assertLess(np.linalg.norm(step[3:]), np.radians(1.5))
            self.assertEqual(len(found["symmetry"]["poses"]), 8)
            self.assertEqual(np.array(found["covariance_of_origin"]).shape, (6, 6))
            again = read_configuration(output)
            np.testing.assert_allclose(again.object_in_base.p, pose.p, atol=1e-6)
            if is_filter:
                self.assertGreater(again.pose_position_deviation, read_configuration(base).pose_position_deviation)
            if (BINARIES / "palpated").exists():
                checked = subprocess.run([BINARIES / "palpated", "--config", output, "--check"], capture_output=True, text=True)
                self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)

    def test_another_size_ends_with_1_and_writes_nothing(self):
        output = self.folder / "registered.yaml"
        done = run("--box", 0.5, 0.06, 0.06, "--touches", self.touches(BAR.scaled(1.1), 24), "--guess", 1.37, 0.04, 0.29, 0, 0, 180,
                   "--output", output)  # fmt: skip
        self.assertEqual(done.returncode, 1)
        self.assertIn("times as large as the mesh", done.stdout)
        self.assertFalse(output.exists())

    def test_wrong_command_lines_end_with_64(self):
        for words in (["--no-such-option"], ["--touches", "a.csv"], ["--box", 1, 1, 1], ["--box", 1, 1, 0, "--touches", "a.csv"],
                      ["--config", EXAMPLE, "--touches", "a.csv", "--deviation", 1]):  # fmt: skip
            done = run(*words)
            self.assertEqual(done.returncode, 64, words)
            self.assertIn("--help", done.stderr)

    def test_help_states_the_exit_codes_once(self):
        done = run("--help")
        self.assertEqual((done.returncode, done.stdout.count("Exit codes:")), (0, 1))

    def test_a_wrong_configuration_ends_with_78(self):
        wrong = self.folder / "wrong.yaml"
        wrong.write_text(f"base: {EXAMPLE}\nobject:\n  mesh: {{box: {{size: [0.5, 0.06]}}}}\n")
        done = run("--config", wrong, "--touches", self.touches())
        self.assertEqual(done.returncode, 78)
        self.assertIn("wrong.yaml:3: object.mesh.box.size: [0.5, 0.06]; allowed: 3 numbers from 0.001 to 10", done.stderr)


class Files(Case):
    def test_wrong_touches_are_named(self):
        file = self.folder / "a.csv"

        def read(path):
            return read_touches(path, 3e-4, 0.2, 0, 0)

        for text, parts in (("x,y\n1,2\n", ("a.csv:1", "'z'")), ("x,y,z,q\n", ("'q'",)), ("x,y,z\n1,2\n", ("a.csv:2", "2 values")),
                            ("x,y,z\n\n1,b,3\n", ("a.csv:3", "y", "'b'", "-100 to 100")), ("", ("empty",)),
                            ("x,y,z,deviation\n1,1,1,0\n", ("deviation", "1e-06 to 0.1"))):  # fmt: skip
            file.write_text(text)
            self.refused(read, file, *parts)
        file.write_text("deviation, z,y,x\n# a comment\n0.001,3,2,1\n")
        self.assertEqual(read(file).points.tolist(), [[1, 2, 3]])
        self.assertEqual(read(file).deviation.tolist(), [0.001])

    def test_meshes_of_palpate_mesh(self):
        maker = BINARIES / "palpate-mesh"
        if not maker.exists():
            self.skipTest("palpate-mesh is not built")
        first = self.folder / "bar.msh"
        subprocess.run([maker, "box", first, "--size", "0.5", "0.06", "0.06", "--cells", "5", "1", "1"], check=True, capture_output=True)
        files = [first]
        for words in (["old.msh", "--msh", "2.2"], ["bar.stl"], ["bar.obj"], ["quadratic.msh", "--order", "2"]):
            files.append(self.folder / words[0])
            subprocess.run([maker, "convert", first, files[-1], *words[1:]], check=True, capture_output=True)
        for file in files:
            surface = read_surface(file)
            np.testing.assert_allclose(surface.sides, [0.5, 0.06, 0.06], atol=1e-6, err_msg=file.name)
            self.assertAlmostEqual(surface.volume, BAR.volume, places=8)
        self.refused(read_surface, self.folder / "bar.veg", "palpate-mesh convert")
        first.write_text("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n")
        self.refused(read_surface, first, "$Nodes is missing")

    def test_keys_of_a_file_replace_those_of_its_base(self):
        own = self.folder / "own.yaml"
        own.write_text(f"base: {FILTER}\nframes: {{object_in_base: {{position: [1, 2, 3], rpy_deg: ~, quaternion: [1, 0, 0, 0]}}}}\n"
                       "estimation: {pose_position_deviation: 2e-3}\n")  # fmt: skip
        read = read_configuration(own)
        self.assertEqual(read.object_in_base.p.tolist(), [1, 2, 3])
        np.testing.assert_allclose(read.object_in_base.R, np.eye(3))
        self.assertEqual((read.component, read.pose_position_deviation, read.pose_rotation_deviation),
                         ("pose_wrench_filter", 2e-3, 3.5e-3))  # fmt: skip
        np.testing.assert_allclose(read.grasp, [0.47, 0.03, 0.03])
        np.testing.assert_allclose(read.surface.sides, [0.5, 0.06, 0.06])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
