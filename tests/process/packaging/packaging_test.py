#!/usr/bin/env python3
"""What cmake --install leaves: programs that find their data, manual pages, completion; and that it
goes away again.

usage: packaging_test.py BUILD SOURCE [UNITTEST-OPTIONS]
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from installed import PATIENCE, Installation, Shell, run  # noqa: E402

BUILD, SOURCE = pathlib.Path(sys.argv.pop(1)), pathlib.Path(sys.argv.pop(1))


class Prefix(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.installed = Installation(BUILD)
        cls.prefix = cls.installed.prefix

    @classmethod
    def tearDownClass(cls):
        cls.installed.close()

    def helps(self):
        """(words, text) of every program and of its commands."""
        for name in self.installed.programs():
            text = run([self.prefix / "bin" / name, "--help"]).stdout
            yield [name], text
            commands = re.search(r"^Subcommands:\n((?:  .*\n)+)", text, re.M)
            for command in re.findall(r"^  (\S+)", commands.group(1) if commands else "", re.M):
                yield [name, command], run([self.prefix / "bin" / name, command, "--help"]).stdout

    def test_1_no_file_knows_where_it_was_built(self):
        for path in self.installed.files():
            if path.is_symlink():
                continue
            text = path.read_bytes()
            for folder in (BUILD, SOURCE):
                self.assertNotIn(str(folder).encode() + b"/", text, path)

    def test_2_every_program_says_how_to_use_it(self):
        self.assertGreaterEqual(len(self.installed.programs()), 10)
        for words, text in self.helps():
            self.assertIn("Usage: ", text, words)
            if len(words) == 1:
                self.assertRegex(text, r"(?m)^Examples?:", words)
                self.assertIn("Exit codes: 0 ", text, words)

    def test_3_manual_pages_render(self):
        for name in self.installed.programs():
            page = self.prefix / "share/man/man1" / f"{name}.1"
            done = run(["man", "--warnings", "-l", page], env={**os.environ, "MANWIDTH": "80", "LC_ALL": "C.UTF-8"})
            self.assertEqual((done.returncode, done.stderr), (0, ""), name)
            for section in ("NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "EXAMPLES", "EXIT STATUS"):
                self.assertIn(section, done.stdout, name)

    def test_4_bash_completes_options_and_commands(self):
        folder = self.prefix / "share/bash-completion/completions"
        for words, text in self.helps():
            name = words[0]
            for start, wanted in (("--", re.findall(r"^  (?:-\w,)?(--[\w-]+)", text, re.M)),
                                  ("", self.commands(text))):
                typed = " ".join(words + [f"'{start}'"])
                script = (f"source '{folder / name}'; COMP_WORDS=({typed}); COMP_CWORD={len(words)}; "
                          f"_complete_{name.replace('-', '_')}; printf '%s\\n' \"${{COMPREPLY[@]}}\"")
                offered = run(["bash", "-c", script]).stdout.split()
                self.assertLessEqual(set(wanted), set(offered), words)

    @staticmethod
    def commands(text):
        found = re.search(r"^Subcommands:\n((?:  .*\n)+)", text, re.M)
        return re.findall(r"^  (\S+)", found.group(1), re.M) if found else []

    def test_5_a_shell_completes_what_is_typed(self):
        path = f"{self.prefix}/bin:{os.environ['PATH']}"
        loader = "/usr/share/bash-completion/bash_completion"
        if pathlib.Path(loader).exists():
            shell = Shell(["bash", "--norc", "-i"], {**os.environ, "PATH": path, "TERM": "dumb", "PS1": "",
                                                     "XDG_DATA_DIRS": f"{self.prefix}/share"})
            shell.type(f"source {loader}; bind 'set bell-style none'; echo rea''dy\n")
            self.complete(shell)
        if shutil.which("zsh"):
            shell = Shell(["zsh", "-f", "-i"], {**os.environ, "PATH": path, "TERM": "dumb", "PS1": ""})
            shell.type(f"unsetopt zle_bracketed_paste; fpath=({self.prefix}/share/zsh/site-functions $fpath); "
                       "autoload -U compinit; compinit -u -D; echo rea''dy\n")
            self.complete(shell)

    def complete(self, shell):
        try:
            shell.until("(?m)^ready")
            shell.type("palpated --ste\t")
            shell.until("--stepped")
            shell.type("\x15palpate-command repl\t")
            shell.until("palpate-command repl.*?ace")
            shell.type("\x15palpate-import --format biot\t")
            shell.until("biot.*?ac")
        finally:
            shell.close()

    def test_6_it_works_after_a_move(self):
        moved = self.prefix.with_name("moved")
        self.prefix.rename(moved)
        try:
            data = moved / "share/palpate"
            for words in (["palpated", "--config", data / "rt/config/examples/bar_long_soft.yaml"],
                          ["palpate-sim", data / "sim/scenes/bar_long_soft_control.yaml"]):
                done = run([moved / "bin" / words[0], *words[1:], "--set", "no_such_key=1"])
                self.assertEqual(done.returncode, 78, done.stdout + done.stderr)
                self.assertIn("no_such_key", done.stdout + done.stderr)
            self.assertIn("elastomer_tensile", run([moved / "bin/palpate-fit", "--help"]).stdout)
            self.assertIn("bar", run([moved / "bin/palpate-evaluate", "thesis", "--list"]).stdout)
            # It reads every example, and runs networks by the library installed with the programs.
            done = run([moved / "bin/palpate-reference"])
            self.assertEqual(done.returncode, 0, done.stderr)
            self.closed_loop(moved)
            self.fit(moved)
        finally:
            moved.rename(self.prefix)

    def fit(self, prefix):
        """A fit, whose report and picture are made by Python programs of the installation."""
        folder = self.installed.folder
        (folder / "press.csv").write_text("d,F\n" + "".join(f"{d},{d ** 1.5}\n" for d in range(9)))
        (folder / "press.yaml").write_text(
            "name: ball\nrecordings:\n  - {kind: hertz, file: press.csv, columns: {depth: {name: d, unit: mm}, "
            "force: {name: F}}, geometry: {radius: 5 mm}}\n")
        done = run([prefix / "bin/palpate-fit", folder / "press.yaml", "--data", folder, "--output", folder / "fitted"])
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("young_modulus", done.stdout)
        self.assertEqual((folder / "fitted/fit.png").read_bytes()[1:4], b"PNG", done.stdout)

    def closed_loop(self, prefix):
        """Simulator and daemon in lock-step, which is independent of any clock."""
        number = os.getpid()
        group = f"239.255.{90 + number % 100}.{1 + number // 100 % 250}"
        control, housekeeping = (f"udpm://{group}:{10000 + number % 11000 * 2 + k}?ttl=0" for k in (0, 1))
        bus = ["--set", f"bus.control={control}", "--set", f"bus.housekeeping={housekeeping}"]
        data, result = prefix / "share/palpate", self.installed.folder / "sim.json"
        daemon = subprocess.Popen(
            [prefix / "bin/palpated", "--config", data / "rt/config/examples/bar_long_soft.yaml", "--stepped", *bus],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        try:
            simulator = subprocess.Popen(
                [prefix / "bin/palpate-sim", data / "sim/scenes/bar_long_soft_control.yaml", "--fast", "--duration", "4",
                 "--json", result, *bus], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
            try:
                said = simulator.communicate(timeout=PATIENCE)[0]
            finally:
                simulator.kill()
        finally:
            daemon.terminate()
            heard = daemon.communicate(timeout=PATIENCE)[0]
        self.assertEqual(simulator.returncode, 0, said + heard)
        self.assertGreaterEqual(json.loads(result.read_text())["commands_accepted"], 3900, said + heard)

    def test_7_a_program_finds_the_libraries(self):
        """The examples of tools/examples/library, by CMake and by pkg-config."""
        examples, made = SOURCE / "tools/examples/library", self.installed.folder / "library"
        done = run(["cmake", "-S", examples, "-B", made, f"-DCMAKE_PREFIX_PATH={self.prefix}"])
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        done = run(["cmake", "--build", made])
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        (folder,) = self.prefix.rglob("pkgconfig")
        flags = run(["pkg-config", "--cflags", "--libs", "palpate"], env={**os.environ, "PKG_CONFIG_PATH": str(folder)})
        self.assertEqual(flags.returncode, 0, flags.stderr)
        for name in ("bend_a_bar", "read_the_bus"):
            done = run(["c++", "-O1", examples / f"{name}.cpp", "-o", made / f"{name}_2", *flags.stdout.split()])
            self.assertEqual(done.returncode, 0, done.stderr)
        said = [run([made / name]).stdout for name in ("bend_a_bar", "bend_a_bar_2")]
        self.assertEqual(said[0], said[1])
        self.assertIn("hand applies", said[0])

    def test_7_python_finds_its_package(self):
        folder = self.prefix / "lib/python3/dist-packages"
        done = run(["/usr/bin/python3", "-c", "import palpate; print(palpate.__file__, palpate.messages.shape_t().seq)"],
                   env={**os.environ, "PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1"})
        self.assertEqual((done.returncode, done.stdout), (0, f"{folder}/palpate/__init__.py 0\n"), done.stderr)

    def test_7_systemd_takes_the_units(self):
        if not shutil.which("systemd-analyze"):
            self.skipTest("no systemd here")
        units = sorted((self.prefix / "lib/systemd/system").iterdir())
        self.assertEqual([unit.name for unit in units], ["palpate-multicast.service", "palpated.service"])
        done = run(["systemd-analyze", "verify", "--man=no", *units])
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))

    def test_8_nothing_is_left_of_it(self):
        self.assertGreater(len(self.installed.files()), 300)
        done = run([SOURCE / "tools/packaging/uninstall", self.installed.manifest])
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.installed.files() if self.prefix.exists() else [], [])


class Debian(unittest.TestCase):
    """As the packages are built: below /usr, but in a separate folder."""

    def test_files_stand_where_debian_has_them(self):
        installed = Installation(BUILD, prefix="/usr", destination=True)
        try:
            root = installed.root
            unit = (root / "lib/systemd/system/palpated.service").read_text()
            self.assertIn("ExecStart=/usr/bin/palpated --config /etc/palpate/palpated.yaml", unit)
            for name in ("etc/palpate/palpated.yaml", "etc/security/limits.d/palpate.conf",
                         "usr/lib/sysctl.d/60-palpate.conf", "usr/share/man/man1/palpated.1.gz",
                         "usr/share/doc/palpate-dev/copyright",
                         "usr/share/doc/python3-palpate/copyright",
                         "usr/lib/python3/dist-packages/palpate/__init__.py", "usr/share/zsh/vendor-completions/_palpated"):
                self.assertTrue((root / name).is_file(), name)
            conffiles = (SOURCE / "tools/packaging/debian/conffiles").read_text().split()
            self.assertEqual(sorted(conffiles), sorted("/" + str(path.relative_to(root))
                                                       for path in (root / "etc").rglob("*") if path.is_file()))
            # The configuration finds its base.
            done = run([root / "usr/bin/palpated", "--config", root / "etc/palpate/palpated.yaml", "--set", "no_such_key=1"])
            self.assertEqual(done.returncode, 78)
            self.assertIn("no_such_key", done.stdout + done.stderr)
            done = run([SOURCE / "tools/packaging/uninstall", installed.manifest],
                       env={**os.environ, "DESTDIR": str(root)})
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(installed.files(), [])
        finally:
            installed.close()


if __name__ == "__main__":
    unittest.main(verbosity=2)
