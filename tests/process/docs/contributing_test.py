#!/usr/bin/env python3
"""Fails where a task of docs/contributing.md does not work as it is written.

usage: contributing_test.py ROOT BUILD

Task 1 is carried out in an empty folder; tasks 2 and 3 in a copy of the sources, of which the files that
change are compiled with the flags of BUILD and linked to its libraries.
"""
import pathlib
import re
import shlex
import shutil
import json
import subprocess
import sys
import tempfile
import unittest

ROOT, BUILD = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
PATIENCE = 600  # s
MOST_FILES = 4  # that a task may touch
INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"', re.M)


def task(number):
    """Blocks of a task: (name of the file in the text before it, language, body)."""
    text = (ROOT / "docs/contributing.md").read_text(encoding="utf-8")
    part = re.search(rf"^## Task {number}:.*?(?=^## |\Z)", text, re.M | re.S).group(0)
    blocks, end = [], 0
    for match in re.finditer(r"^```(\w+)\n(.*?)^```", part, re.M | re.S):
        names = re.findall(r"`([\w./-]+\.\w+)`", part[end:match.start()])
        blocks.append((names[-1] if names else "", match.group(1), match.group(2)))
        end = match.end()
    return blocks


def patched(text, diff):
    """Hunks without line numbers: context and removed lines must stand in the text once, in this order."""
    position = 0
    for hunk in re.split(r"^@@.*\n", diff, flags=re.M):
        lines = hunk.splitlines()
        before = "".join(line[1:] + "\n" for line in lines if not line.startswith("+"))
        after = "".join(line[1:] + "\n" for line in lines if not line.startswith("-"))
        at = text.find(before, position)
        if at < 0:
            raise AssertionError(f"these lines are not in the file:\n{before}")
        text = text[:at] + after + text[at + len(before):]
        position = at + len(after)
    return text


def without_precompiled(words):
    """The words of a compiler without the headers that are precompiled with the build's optimisation; no source needs them."""
    of_headers = ("-Xclang", "-include-pch", "-include", "-Winvalid-pch")
    return [word for word in words if word not in of_headers and not word.endswith((".pch", "cmake_pch.hxx"))]


def run(words, **options):
    done = subprocess.run(words, capture_output=True, text=True, timeout=PATIENCE, **options)
    if done.returncode != 0:
        raise AssertionError(f"{words}\n{done.stdout[-3000:]}{done.stderr[-3000:]}")
    return done.stdout


class Copy:
    """Sources in a folder of their own, compiled as in BUILD."""

    def __init__(self, folder, diffs):
        self.root = folder
        for name in ("core", "rt", "sim", "tools", "tests"):
            shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("*.csv", "data", "corpus"))
        self.changed = set(diffs)
        for name, diff in diffs.items():
            path = folder / name
            path.write_text(patched(path.read_text(encoding="utf-8"), diff), encoding="utf-8")
        self.database = json.loads((BUILD / "compile_commands.json").read_text())
        self.known = {}

    def includes(self, name):
        """Files of ours that `name` includes, itself among them."""
        if name not in self.known:
            self.known[name] = {name}
            path = self.root / name
            if path.is_file():
                for other in INCLUDE.findall(path.read_text(encoding="utf-8")):
                    self.known[name] |= self.includes(other)
        return self.known[name]

    def flags(self, target):
        """Words of the compiler for any source of that target."""
        for entry in self.database:
            words = shlex.split(entry["command"])
            if f"CMakeFiles/{target}.dir/" in words[words.index("-o") + 1]:
                at = words.index("-o")
                words = words[:at] + [word for word in words[at + 2:] if word != "-c" and not word.endswith((".cpp", ".cxx"))]
                own = [f"-I{self.root}" if word == f"-I{ROOT}" else word for word in words if "ccache" not in word]
                own = [word for word in own if "=" not in word or not word.startswith("CCACHE")]
                return [*without_precompiled(own), "-O0"]
        raise AssertionError(f"{target} is not in compile_commands.json")

    def batches(self, target, folder):
        """(object of BUILD, copy of its source) where BUILD compiles several sources at a time; the copy includes those
        of this copy."""
        made = []
        built = {entry["file"] for entry in self.database}  # besides what a former configuration has left
        for batch in sorted((BUILD / folder / f"CMakeFiles/{target}.dir/Unity").glob("*.cxx")):
            if str(batch) not in built:
                continue
            lines = [line for line in batch.read_text(encoding="utf-8").splitlines() if f'"{ROOT / folder}/' in line]
            copy = self.root / f"{target}_{batch.stem}.cpp"
            copy.write_text("\n".join(lines).replace(f'"{ROOT}/', f'"{self.root}/') + "\n", encoding="utf-8")
            made.append((batch.with_suffix(".cxx.o"), copy))
        return made

    def is_reached(self, batch):
        """Whether the change reaches one of the sources of a batch."""
        sources = re.findall(rf'"{self.root}/([^"]+)"', batch.read_text(encoding="utf-8"))
        return any(self.includes(source) & self.changed for source in sources)

    def of_folder(self, folder):
        return [path for path in sorted((self.root / folder).glob("*.cpp")) if path.name != "main.cpp"]

    def compile(self, target, folder, whole=False):
        """Objects of the sources of `folder` that the change reaches, or of all but main.cpp, those of BUILD where the
        change reaches none of a batch."""
        flags = self.flags(target)
        flags = flags[next(i for i, word in enumerate(flags) if word.endswith("++")):]
        objects = []
        if whole:
            batches = self.batches(target, folder)
            together = "".join(copy.read_text(encoding="utf-8") for _, copy in batches)
            sources = [copy for _, copy in batches if self.is_reached(copy)]
            sources += [path for path in self.of_folder(folder) if str(path) not in together]
            objects = [str(built) for built, copy in batches if not self.is_reached(copy)]
        else:
            sources = [path for path in self.of_folder(folder) if self.includes(path.relative_to(self.root).as_posix()) & self.changed]
        for path in sources:
            made = self.root / (path.relative_to(self.root).as_posix().replace("/", "_") + ".o")
            run([*flags, "-c", str(path), "-o", str(made)], cwd=BUILD)
            objects.append(str(made))
        return objects

    def link(self, target, objects, without=""):
        """The program of that target with `objects` in place of its own and before its libraries, of which one
        may be left out: a library compiled several sources at a time cannot be replaced in part."""
        command = run(["ninja", "-C", BUILD, "-t", "commands", target]).splitlines()[-1]
        words = shlex.split(command.split("&&")[1])
        words = [word for word in words if f"CMakeFiles/{target}.dir/" not in word]
        if without:
            words = [word for word in words if not word.endswith(f"/{without}")]
        program = self.root / target
        words[words.index("-o") + 1] = str(program)
        run([words[0], *objects, *words[1:]], cwd=BUILD)
        return program


class Tasks(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name)
        self.addCleanup(self.folder.cleanup)

    def files(self, number):
        named = {}
        for name, language, body in task(number):
            if language != "bash" and name:
                named[name] = body
        self.assertLessEqual(len(named), MOST_FILES, named.keys())
        return named

    def test_task_1_a_law_as_a_plug_in(self):
        for name, body in self.files(1).items():
            (self.path / name).write_text(body.replace("base: palpate/", f"base: {ROOT}/"), encoding="utf-8")
        run(["cmake", "-S", ".", "-B", "build", "-DCMAKE_BUILD_TYPE=Release",
             f"-Dpalpate-plugin_DIR={BUILD}/palpate-plugin"], cwd=self.path)
        run(["cmake", "--build", "build"], cwd=self.path)
        run([BUILD / "bin/palpated", "--check", "--config", "my_law.yaml"], cwd=self.path)
        wrong = subprocess.run([BUILD / "bin/palpated", "--check", "--config", "my_law.yaml", "--set", "control.step=9"],
                               cwd=self.path, capture_output=True, text=True, timeout=PATIENCE)
        printed = wrong.stdout + wrong.stderr
        self.assertEqual(wrong.returncode, 78, printed)
        self.assertIn("step", printed)

    def test_task_2_a_new_key(self):
        copy = Copy(self.path, {name: body for name, body in self.files(2).items() if name.endswith("pp")})
        objects = copy.compile("palpate_registry", "rt/registry", whole=True)
        tests = copy.compile("unit_rt_pipeline", "tests/unit/rt/pipeline")
        program = copy.link("unit_rt_pipeline", tests + objects, without="libpalpate_registry.a")
        printed = run([program, "--gtest_filter=PipelineConfiguration.*"])
        self.assertIn("ReleaseOfTheDeadBandIsAtLeastOne", printed)

    def test_task_3_a_channel_in_the_browser(self):
        named = self.files(3)
        self.assertTrue(any(name.endswith(".js") for name in named))
        copy = Copy(self.path, named)
        page = self.path / "tools/view/page_files.cpp"
        run(["cmake", f"-DOUTPUT={page}", f"-DFOLDER={self.path}/tools/view/page", "-DHEADER=tools/view/viewer.hpp",
             "-DFUNCTION=palpate::view::page_files", "-P", ROOT / "tools/serve/embed.cmake"])
        objects = copy.compile("palpate_view", "tools/view", whole=True)
        tests = copy.compile("unit_tools_view", "tests/unit/tools/view")
        self.assertTrue(tests)
        program = copy.link("unit_tools_view", tests + objects, without="libpalpate_view.a")
        run([program])
        self.assertIn(b"external contact, estimated", program.read_bytes())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
