"""A user can build and import what cmake --install installs."""

import os
import subprocess
import sys
import unittest

import palpate

from processes import PATIENCE, SANITIZED, SOURCE, ProcessTest

BUILD = os.environ["PALPATE_BUILD_DIR"]
PLUGIN = SOURCE / "tools/examples/plugin"


class Packages(ProcessTest):
    def run_words(self, *words: object) -> str:
        made = subprocess.run(
            [str(word) for word in words], capture_output=True, text=True, timeout=4 * PATIENCE
        )
        self.assertEqual(made.returncode, 0, made.stdout + made.stderr)
        return made.stdout

    def install(self, component: str) -> None:
        self.run_words(
            "cmake", "--install", BUILD, "--component", component, "--prefix", self.folder / "usr"
        )

    @unittest.skipIf(SANITIZED, "a plug-in of the system's compiler is not one for this build")
    def test_a_plugin_is_built_against_what_is_installed_and_loaded(self) -> None:
        self.install("plugin")
        build = self.folder / "build"
        self.run_words(
            "cmake", "-S", PLUGIN, "-B", build, f"-DCMAKE_PREFIX_PATH={self.folder / 'usr'}"
        )  # fmt: skip
        self.run_words("cmake", "--build", build)
        library = build / "libmy_components.so"
        program = self.start_daemon(
            PLUGIN / "bar_long_soft.yaml", plugins=f"[{{library: {library}}}]"
        )
        daemon = self.connect()
        self.assertEqual(daemon.start().event, "start")
        self.assertEqual(program.end(), 0)

    def test_the_package_is_imported_from_where_it_is_installed(self) -> None:
        self.install("python")
        folder = self.folder / "usr/lib/python3/dist-packages"
        self.assertTrue((folder / "palpate/py.typed").exists())
        code = "import palpate; print(palpate.__file__, palpate.messages.imu_t().encode().hex())"
        environment = {**os.environ, "PYTHONPATH": str(folder)}
        said = subprocess.run(
            [sys.executable, "-c", code], env=environment, capture_output=True, text=True
        ).stdout.split()
        self.assertEqual(said[0], str(folder / "palpate/__init__.py"))
        self.assertEqual(said[1], palpate.messages.imu_t().encode().hex())


if __name__ == "__main__":
    unittest.main()
