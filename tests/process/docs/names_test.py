#!/usr/bin/env python3
"""Every program, command, option, key and file that a page of the documentation names exists.

usage: names_test.py ROOT BIN [UNITTEST-OPTIONS]
"""
import json
import re
import subprocess
import sys
import unittest

from names import Page, Tree

TREE = Tree(*(sys.argv.pop(1) for _ in range(2)))


class Pages(unittest.TestCase):
    def test_name_what_there_is(self):
        wrong, checked = [], 0
        for path in TREE.pages:
            name = path.relative_to(TREE.root)
            if str(name) == "docs/configuration.md":
                continue  # which is generated, and checked against the code by another test
            page = Page(TREE, name, path.read_text())
            wrong += page.wrong
            checked += page.checked
        print(f"{checked} names of {len(TREE.pages)} pages")
        self.assertGreater(checked, 500)
        self.assertEqual(wrong, [], "\n" + "\n".join(wrong))


class Troubleshooting(unittest.TestCase):
    def test_lists_every_check_of_the_doctor(self):
        done = subprocess.run([TREE.programs / "palpate-doctor", "--config", TREE.root / "rt/config/examples/bar_long_soft.yaml",
                               "--json", "-", "--no-live"], capture_output=True, text=True, timeout=120)
        checks = {finding["check"] for finding in json.loads(done.stdout)["findings"]} | {"loopback", "daemons"}
        self.assertGreater(len(checks), 20)
        text = (TREE.root / "docs/troubleshooting.md").read_text()
        section = text.split("## What palpate-doctor checks")[1].split("\n## ")[0]
        rows = re.findall(r"^\| (`[^|]*) \|", section, re.M)
        self.assertEqual(set(re.findall(r"`(\w+)`", " ".join(rows))), checks)


class Licences(unittest.TestCase):
    def setUp(self):
        self.documented = set(re.findall(r"`([^`]+)`", (TREE.root / "docs/licences.md").read_text()))

    def test_list_every_package_that_is_installed_for_the_build(self):
        lines = (TREE.root / "tools/packaging/packages.txt").read_text().split("\n")
        packages = {line for line in lines if line and not line.startswith("#")}
        self.assertGreater(len(packages), 50)
        self.assertEqual(packages - self.documented, set())

    def test_list_every_library_that_a_program_is_linked_to(self):
        system = {"libstdc++", "libm", "libgcc_s", "libc", "ld-linux-x86-64"}
        for program in sorted(TREE.programs.glob("palpate*")) + [TREE.programs / "libpalpate_torch.so"]:
            if program.suffix == ".source" or program.read_bytes()[:4] != b"\x7fELF":
                continue
            said = subprocess.run(["readelf", "-d", program], capture_output=True, text=True, check=True).stdout
            needed = {re.split(r"\.so", name)[0] for name in re.findall(r"NEEDED.*\[(.*)\]", said)}
            needed = {re.sub(r"-0$", "", re.sub(r"\.\d.*$", "", name)) for name in needed}
            self.assertGreater(len(needed), 1, program)
            self.assertEqual(needed - system - self.documented, set(), program.name)


class Wrong(unittest.TestCase):
    """Nonexistent names are found."""

    def complaints(self, text):
        return Page(TREE, "README.md", text).wrong

    def test_names_that_are_right_pass(self):
        self.assertEqual(self.complaints(
            "`palpated` and `palpate-command replace control --set provider=kinematic`, `gate.linear_speed`, "
            "`sim/scenes`, [here](docs/tutorial.md)\n```sh\ntools/test -L unit\npalpate-top --once | head\n```\n"), [])

    def test_each_kind_of_wrong_name_is_found(self):
        for text, expected in (
                ("`palpate-fly`", "palpate-fly: is no program"),
                ("The program palpate-fly", "palpate-fly: is no program"),
                ("```sh\npalpate-export movie run.log\n```", "none of the commands info"),
                ("```sh\npalpate-top --twice\n```", "palpate-top  --twice: no such option"),
                ("`palpate-command target --speed 1`", "palpate-command target --speed: no such option"),
                ("```sh\ntell() { palpate-command \"$@\"; }\ntell jump\n```", "none of the commands start"),
                ("`process_faults --gtest_filter=Flod.*`", "no such test"),
                ("`tools/demonstrate`", "tools/demonstrate: is not in the tree"),
                ("```sh\npalpated rt/config/examples/none.yaml\n```", "none.yaml: is not in the tree"),
                ("`gate.linear_sped`", "gate.linear_sped: is no key"),
                ("`grasp_boxx: 3`", "grasp_boxx: is no key"),
                ("```yaml\nobject: {grasp_boxx: 3}\n```", "grasp_boxx: is no key"),
                ("```sh\ncat > a.yaml <<END\ngrasp_boxx: 3\nEND\n```", "grasp_boxx: is no key"),
                ("`quadratic_programme`", "quadratic_programme: is nowhere in the sources"),
                ("`unit.rt_bus.Subscription.HearsAll`", "is no test of ctest"),
                ("`plug_in.hpp`", "plug_in.hpp: is not in the tree"),
                ("[there](docs/nowhere.md)", "docs/nowhere.md: leads nowhere")):
            self.assertIn(expected, "\n".join(self.complaints(text)), text)


if __name__ == "__main__":
    unittest.main(verbosity=2)
