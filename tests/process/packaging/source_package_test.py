#!/usr/bin/env python3
"""The Debian source package: unpacked, described as the packages that CPack makes, clean for lintian.

usage: source_package_test.py BUILD SOURCE [UNITTEST-OPTIONS]
"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

BUILD, SOURCE = pathlib.Path(sys.argv.pop(1)), pathlib.Path(sys.argv.pop(1))


def run(words, **options):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True, **options)


class SourcePackage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        for program in ("git", "dpkg-source", "dh"):
            if not shutil.which(program):
                raise unittest.SkipTest(f"no {program} here")
        if run(["git", "-C", SOURCE, "rev-parse", "HEAD"]).returncode != 0:
            raise unittest.SkipTest("not a clone of git")
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="palpate_source_"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        done = run([SOURCE / "tools/packaging/make_source_package", cls.folder, "--maintainer", "A Lab <lab@example.com>"])
        if done.returncode != 0:
            raise RuntimeError(done.stdout + done.stderr)
        (cls.described,) = cls.folder.glob("palpate_*-1.dsc")
        cls.unpacked = cls.folder / "unpacked"
        done = run(["dpkg-source", "--require-strong-checksums", "-x", cls.described, cls.unpacked])
        if done.returncode != 0:
            raise RuntimeError(done.stdout + done.stderr)
        cls.paragraphs = [cls.fields(text) for text in (cls.unpacked / "debian/control").read_text().split("\n\n")]

    @staticmethod
    def fields(paragraph):
        return {name: value.strip() for name, value in re.findall(r"^(\S+?): (.*(?:\n .*)*)", paragraph, re.M)}

    def test_it_holds_the_committed_tree(self):
        listed = run(["git", "-C", SOURCE, "ls-tree", "-r", "--name-only", "HEAD"]).stdout.splitlines()
        files = {str(path.relative_to(self.unpacked)) for path in self.unpacked.rglob("*") if not path.is_dir()}
        self.assertEqual({name for name in files if not name.startswith(("debian/", ".pc/"))}, set(listed))

    def test_its_packages_are_those_of_cpack(self):
        if "PALPATE_SUITESPARSE:BOOL=OFF" in (BUILD / "CMakeCache.txt").read_text():
            self.skipTest("a build without SuiteSparse depends on less")
        cpack = dict(re.findall(r'^set\((CPACK_\w+) "((?:[^"\\]|\\.)*)"\)', (BUILD / "CPackConfig.cmake").read_text(), re.M))
        named = {}
        for component in cpack["CPACK_COMPONENTS_ALL"].split(";"):
            of = f"CPACK_DEBIAN_{component.upper()}_PACKAGE_"
            named[cpack[of + "NAME"]] = [
                {re.sub(r" \(.*\)", "", one) for one in cpack.get(of + field, "").split(", ") if one}
                for field in ("DEPENDS", "RECOMMENDS", "SUGGESTS")
            ] + [cpack[f"CPACK_COMPONENT_{component.upper()}_DESCRIPTION"].replace("\n", "\n ")]
        written = {}
        for package in self.paragraphs[1:]:
            written[package["Package"]] = [
                {re.sub(r" \(.*\)", "", one) for one in package.get(field, "").split(", ") if one and one[0] != "$"}
                for field in ("Depends", "Recommends", "Suggests")
            ] + [package["Description"]]
        self.assertEqual(len(written), 5)
        self.assertEqual(written, named)
        self.assertEqual(self.paragraphs[0]["Maintainer"], "A Lab <lab@example.com>")

    def test_what_it_needs_is_what_the_build_is_given(self):
        needed = {re.split(r" \(", one)[0] for one in re.split(r",\s+", self.paragraphs[0]["Build-Depends"])}
        listed = set((SOURCE / "tools/packaging/packages.txt").read_text().split("\n"))
        self.assertGreater(len(needed), 30)
        self.assertEqual(needed - listed, {"debhelper-compat"})
        self.assertLessEqual({"libeigen3-dev", "libdart-dev", "default-jdk-headless"}, needed)
        self.assertNotIn("libgtest-dev", needed)
        # After tools/packaging/install-dependencies dpkg-buildpackage misses nothing.
        done = run(["dpkg-checkbuilddeps"], cwd=self.unpacked)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_its_rules_are_those_of_debhelper(self):
        done = run(["debian/rules", "clean"], cwd=self.unpacked)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        steps = run(["dh", "binary", "--no-act", "--buildsystem=cmake+ninja"], cwd=self.unpacked).stdout
        for step in ("override_dh_auto_configure", "override_dh_auto_install"):
            self.assertIn(f"debian/rules {step}", steps)
        self.assertNotRegex(steps, r"(?m)^\s*dh_installsystemd ")  # it would enable and start the daemon

    def test_lintian_has_no_remark(self):
        if not shutil.which("lintian"):
            self.skipTest("no lintian here")
        done = run(["lintian", "--allow-root", "--fail-on", "error,warning", self.described])
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


class Tries(unittest.TestCase):
    """The programs that try an installation say what they lack before they begin."""

    def test_without_packages_they_end(self):
        with tempfile.TemporaryDirectory() as empty:
            for name in ("try_packages", "try_service"):
                done = run([SOURCE / "tools/packaging" / name, empty])
                expected = {1: f"error: no packages in {empty}", 77: "cannot be tried"}
                self.assertIn(done.returncode, expected, name)
                self.assertIn(expected[done.returncode], done.stderr, name)
                self.assertEqual(list(pathlib.Path(empty).iterdir()), [], name)

    def test_the_container_has_packages_that_exist(self):
        text = (SOURCE / "tools/packaging/Containerfile").read_text()
        copied = re.search(r"^COPY (.*) /tmp/packages/$", text, re.M).group(1).split()
        named = re.findall(r"^palpate_package\(\w+ (\S+)", (SOURCE / "tools/packaging/debian/control.cmake").read_text(), re.M)
        self.assertEqual(copied, [f"{name}_*.deb" for name in named if name != "palpate-dev"])


if __name__ == "__main__":
    unittest.main(verbosity=2)
