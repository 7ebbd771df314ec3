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

    def test_both_packings_are_installed_without_lcm_gen(self) -> None:
        packed = self.folder / "packed"
        self.run_words(SOURCE / "tools/packaging/make_python", packed)
        environment = {"PATH": str(self.folder / "venv/bin"), "PYTHONDONTWRITEBYTECODE": "1"}
        self.run_words("/usr/bin/python3", "-m", "venv", "--system-site-packages", self.folder / "venv")
        python = self.folder / "venv/bin/python"
        packings = sorted(packed.iterdir())
        self.assertEqual([path.suffix for path in packings], [".whl", ".gz"])
        code = "import palpate; print(palpate.__file__, palpate.messages.imu_t().encode().hex())"
        for packing in packings:
            for words in (
                ["-m", "pip", "install", "--quiet", "--no-index", "--no-build-isolation", "--no-deps",
                 "--force-reinstall", str(packing)],
                ["-c", code],
            ):  # fmt: skip
                done = subprocess.run(
                    [str(python), *words], env=environment, cwd=self.folder, capture_output=True, text=True
                )
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            where, message = done.stdout.split()
            self.assertTrue(where.startswith(str(self.folder)), where)
            self.assertEqual(message, palpate.messages.imu_t().encode().hex())


if __name__ == "__main__":
    unittest.main()
