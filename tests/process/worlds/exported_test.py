"""Models by `palpate-fit export`, run by MuJoCo and Drake, compared with palpate's own statics."""

from __future__ import annotations

import os
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

SOURCE = Path(os.environ["PALPATE_SOURCE_DIR"])
FIT = Path(os.environ["PALPATE_BIN_DIR"]) / "palpate-fit"
sys.path.insert(0, str(SOURCE / "tools/lab/worlds"))

from exported import SETTLE, Exported, export, extrapolated  # noqa: E402

BAR = SOURCE / "rt/config/examples/bar_long_soft.yaml"
FORMATS = {"mujoco": "--mjcf", "drake": "--drake-sdf"}
# Linear elements in palpate too: the same mesh everywhere.
LINEAR = ("--set", "object.order=linear", "--set", "object.mesh.box.cells=[20,2,2]")
STIFF = ("--set", "object.material.young_modulus=3e5")


class Sag(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def exported(self, name: str, *words: str) -> Exported:
        folder = self.folder / "_".join([name, *words]).replace("/", "")
        return export(FIT, BAR, folder, [FORMATS[name], *words])

    def test_a_held_bar_sags_as_by_palpates_statics_on_the_same_mesh(self) -> None:
        for name, settle in SETTLE.items():
            with self.subTest(name):
                exported = self.exported(name, "--grasp", "held", *LINEAR)
                self.assertGreater(exported.sag, 1.5e-3)
                positions = settle(exported)
                self.assertAlmostEqual(exported.sag_of(positions) / exported.sag, 1, delta=5e-3)
                error = np.linalg.norm(positions - exported.under_weight, axis=1)
                self.assertLess(error.max(), 0.01 * exported.sag)

    def test_a_cantilever_bends_as_by_palpates_statics_on_the_same_mesh(self) -> None:
        for name, settle in SETTLE.items():
            with self.subTest(name):
                exported = self.exported(name, *LINEAR, *STIFF)
                self.assertGreater(exported.sag, 1e-2)
                positions = settle(exported)
                self.assertAlmostEqual(exported.sag_of(positions) / exported.sag, 1, delta=5e-3)

    def test_divided_meshes_approach_the_sag_of_quadratic_elements(self) -> None:
        levels = [self.exported("drake", "--grasp", "held", "--refine", str(n)) for n in (0, 1)]
        coarse, fine = (level.sag_of(SETTLE["drake"](level)) for level in levels)
        self.assertLess(coarse, fine)
        self.assertAlmostEqual(extrapolated(coarse, fine) / levels[0].sag, 1, delta=0.05)


if __name__ == "__main__":
    unittest.main()
