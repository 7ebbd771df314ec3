"""Names used in pages of the documentation, and those that exist: programs with their
commands and options, configuration keys, files, identifiers."""
import functools
import os
import pathlib
import re
import shlex
import subprocess

import yaml

PATIENCE = 120  # s, sufficient for a very busy machine
TOP = ("core", "rt", "sim", "tools", "tests", "lcmtypes", "docs")
SOURCES = {".cpp", ".hpp", ".py", ".yaml", ".lcm", ".cmake", ".txt", ".js", ".html", ".json", ".in", ".service", ".conf", ""}
PROGRAM = re.compile(r"(?:palpated|palpate-[a-z-]+|(?:bench|fuzz|process|integration|unit)_\w+|driver_template)$")
# Shell words that may precede a program.
BEFORE = {"sudo", "nice", "time", "exec", "until", "while", "if", "!", "then", "do", "else", "{", "("}
OPTION = re.compile(r"(?<![\w-])(--[A-Za-z][\w-]*|-[A-Za-z])\b")
IDENTIFIER = re.compile(r"\b[A-Za-z][A-Za-z0-9]*(?:_[A-Za-z0-9]+)+\b")
FRAMES = re.compile(r"[A-Za-z]+_[A-Z]{1,2}(?:_[A-Z])?$|.*_[12x]$")  # X_AB, p_AB_C, F_P_A
WRITTEN = re.compile(r"\.(?:csv|json|html|log|png|svg|mp4|vtu|vtk|xml|sdf|scn|pt)$")  # files that programs write
FILE = re.compile(r"[\w-]+\.(?:hpp|cpp|yaml|py|md|lcm|cmake|service|conf)$")


def blocks(text):
    """(language, first line, lines) of fenced blocks."""
    found, lines, language, start = [], None, "", 0
    for number, line in enumerate(text.splitlines(), 1):
        fence = re.match(r"\s*```(\w*)", line)
        if lines is None and fence:
            lines, language, start = [], fence.group(1), number + 1
        elif lines is not None and fence:
            found.append((language, start, lines))
            lines = None
        elif lines is not None:
            lines.append(line)
    return found


def spans(text):
    """(line, code) of the text between single back-ticks outside fenced blocks."""
    inside = False
    for number, line in enumerate(text.splitlines(), 1):
        if re.match(r"\s*```", line):
            inside = not inside
        elif not inside:
            for code in re.findall(r"`([^`]+)`", line):
                yield number, code


def without_documents(lines):
    """Lines of a shell without here-documents (<< END), and these, as (name, text)."""
    commands, documents, end, name = [], [], None, ""
    for line in lines:
        if end is None:
            commands.append(line)
            begin = re.search(r"<<-?\s*'?(\w+)'?", line)
            if begin:
                end = begin.group(1)
                target = re.search(r">\s*(\S+)", line)
                name = target.group(1) if target else ""
                documents.append((name, []))
        elif line.strip() == end:
            end = None
        else:
            documents[-1][1].append(line)
    return commands, [(name, "\n".join(text)) for name, text in documents]


def simple_commands(line):
    """The commands in a shell line, each as its words."""
    line = re.sub(r"(^|\s)#.*", "", line)
    line = re.sub(r"\\\s*$", "", line)
    for part in re.split(r"&&|\|\||[;|&]|\$\(|\{ |\)\s*$", line):
        try:
            words = shlex.split(part)
        except ValueError:
            words = part.split()
        while words and (words[0] in BEFORE or re.match(r"\w+=", words[0])):
            words = words[1:]
        if words:
            yield words


class Tree:
    """The sources and the programs built from them."""

    def __init__(self, root, programs):
        self.root, self.programs = pathlib.Path(root), pathlib.Path(programs)
        self.pages = [page for page in sorted(self.root.rglob("*.md"))
                      if not page.relative_to(self.root).parts[0].startswith(("build", "out", "."))]
        self.files = [path for top in TOP for path in (self.root / top).rglob("*") if path.is_file()]
        self.files += [path for path in self.root.iterdir() if path.is_file()]
        self.names = {path.name for path in self.files}
        self.words = {path.stem for path in self.files} | {path.name for path in self.programs.iterdir()}
        for path in self.files:
            if "process/docs" in path.parent.as_posix():
                continue  # wrong names, to verify that they are found
            if path.suffix in SOURCES and path.stat().st_size < 1 << 20:
                text = path.read_text(errors="replace")
                self.words.update(re.findall(r"[A-Za-z_][A-Za-z0-9_]*", text))
        cmake = (self.root / "tools/packaging/debian/control.cmake").read_text()
        self.packages = set(re.findall(r"palpate_package\(\w+ (\S+)", cmake)) | {"palpate-plugin"}
        self.units = {path.stem for path in (self.root / "tools/packaging/system").glob("*.service")}
        self.keys, self.paths = self._configuration()

    def _configuration(self):
        """Names of keys, and their location: control.limits.slip."""
        keys, paths, section = set(), set(), ""
        for line in (self.root / "docs/configuration.md").read_text().splitlines():
            heading = re.match(r"###+ (?:`(.*)`|Top level)", line)
            if heading:
                section = (heading.group(1) or "").replace("[]", "").replace("..", ".")
                if section:
                    paths.add(section)
            key = re.match(r"\| `(\w+)` \|", line)
            if key:
                keys.add(key.group(1))
                paths.add(f"{section}.{key.group(1)}".lstrip("."))
        return keys, paths

    @functools.lru_cache(maxsize=None)
    def help(self, *words):
        program = self.programs / words[0]
        done = subprocess.run([program, *words[1:], "--help"], capture_output=True, text=True, timeout=PATIENCE)
        return done.stdout + done.stderr

    def commands(self, program):
        found = re.search(r"^Subcommands:\n((?:  .*\n)+)", self.help(program), re.M)
        return re.findall(r"^  (\S+)", found.group(1), re.M) if found else []

    @functools.lru_cache(maxsize=None)
    def ctests(self):
        """Names of ctest, without the instance and number of parametrised tests."""
        names = set()
        for label in ("unit", "property", "integration", "fault", "process"):
            for path in (self.root / "tests" / label).rglob("*"):
                if path.suffix == ".cpp":
                    flat = "_".join(path.parent.relative_to(self.root / "tests" / label).parts)
                    for suite, test in re.findall(r"TEST(?:_[FP])?\(\s*(\w+),\s*(\w+)\)", path.read_text()):
                        names.add(f"{label}.{flat}.{suite}.{test}")
                elif path.name == "CMakeLists.txt":
                    names.update(re.findall(r"add_test\(NAME (\S+)", path.read_text()))
                elif path.name.endswith("_test.py"):
                    names.add(".".join(["process", path.parent.name, path.stem[:-len("_test")]]))
        return names

    @functools.lru_cache(maxsize=None)
    def tests(self, program):
        """Names of the tests of a gtest program."""
        done = subprocess.run([self.programs / program, "--gtest_list_tests"], capture_output=True, text=True,
                              timeout=PATIENCE)
        found, suite = [], ""
        for line in done.stdout.splitlines():
            if line.startswith("  "):
                found.append(suite + line.split("#")[0].strip())
            elif line.split("#")[0].strip().endswith("."):
                suite = line.split("#")[0].strip()
        return found


class Page:
    """Checks one page against the tree; `wrong` lists nonexistent names."""

    def __init__(self, tree, path, text):
        self.tree, self.path, self.text, self.wrong = tree, path, text, []
        self.checked = 0
        self.aliases = dict(re.findall(r"(\w+)\(\) \{ ([\w-]+)", text))
        fenced = "\n".join("\n".join(lines) for _, _, lines in blocks(text))
        self.made = set(re.findall(r"[\w-]+\.\w+", fenced))  # files that the page itself creates
        for language, start, lines in blocks(text):
            if language in ("", "sh"):
                self.shell(start, lines, language == "sh")
            elif language == "yaml":
                self.yaml(start, "\n".join(lines))
        for line, code in spans(text):
            self.span(line, code)
        self.links()
        for word in set(re.findall(r"(?<![\w/.-])(palpated|palpate-[a-z][a-z-]*[a-z])(?![\w-]|\.\w)", text)):
            known = self.is_program(word) or self.is_script(word) or word in tree.packages | tree.units
            self.need(1, word, known, "is no program")

    def need(self, line, what, exists, complaint):
        self.checked += 1
        if not exists:
            self.wrong.append(f"{self.path}:{line}: {what}: {complaint}")

    def is_program(self, name):
        return (self.tree.programs / name).is_file()

    def is_script(self, name):
        """Whether it is run from the sources."""
        return any(path.name == name and os.access(path, os.X_OK) for path in self.tree.files)

    def shell(self, start, lines, is_shell):
        commands, documents = without_documents(lines)
        for number, line in enumerate(commands):
            for words in simple_commands(line):
                if is_shell or PROGRAM.match(words[0].rsplit("/", 1)[-1]):
                    self.command(start + number, words)
        for name, text in documents:
            if name.endswith(".yaml"):
                self.yaml(start, re.sub(r"\$(?=\w)", "", text))

    def command(self, line, words):
        first = re.sub(r"^\$\w+/", "", words[0])
        name = self.aliases.get(first, first.rsplit("/", 1)[-1])
        if PROGRAM.match(name) and not self.is_script(name):
            self.need(line, name, self.is_program(name), "is no program")
            if self.is_program(name):
                self.program(line, name, words[1:])
        elif first.startswith(TOP):
            self.file(line, first)
            script = self.tree.root / first
            if script.is_file():
                text = script.read_text()
                if first == "tools/demo":
                    text += self.tree.help("palpate-evaluate", "demo")
                for option in OPTION.findall(" ".join(words[1:])):
                    self.need(line, f"{first} {option}", option in text, "no such option")
        for word in words[1:]:
            self.file(line, re.sub(r"^\$\w+/", "", word))

    def program(self, line, name, words):
        commands = self.tree.commands(name)
        command = next((word for word in words if word in commands), None)
        texts = self.tree.help(name) + (self.tree.help(name, command) if command else "")
        needs_command = commands and "\nPositionals:" not in self.tree.help(name)
        plain = [word for word in words if not word.startswith("-")]
        needs_command = needs_command and "$@" not in words
        if needs_command and not command and plain and "--make-key" not in words:
            self.need(line, f"{name} {' '.join(words)}", False, f"none of the commands {', '.join(commands)}")
        known = set(OPTION.findall(texts))
        for word in words:
            option = re.match(r"(--[A-Za-z][\w-]*|-[A-Za-z](?=$))", word)
            if not option or word.startswith(("--gtest_", "--benchmark_")):
                continue
            self.need(line, f"{name} {command or ''} {option.group(1)}", option.group(1) in known, "no such option")
        for word in words:
            pattern = re.match(r"--gtest_filter=(.*)", word)
            if pattern:
                regex = re.compile("|".join(re.escape(p).replace(r"\*", ".*") for p in pattern.group(1).split(":")))
                self.need(line, word, any(regex.fullmatch(test) for test in self.tree.tests(name)), "no such test")

    def file(self, line, word):
        """A path of the tree, possibly with * and {a,b}."""
        word = re.sub(r":[\w.*:]*$", "", word).rstrip(".,")
        match = re.match(rf"(?:{'|'.join(TOP)})/[\w./*{{}},-]*$", word)
        if not match or re.search(r"(?:^|/)[A-Z]+(?:/|$)", word):
            return
        patterns = [word]
        brace = re.search(r"\{([^}]*)\}", word)
        if brace:
            patterns = [word.replace(brace.group(0), choice) for choice in brace.group(1).split(",")]
        for pattern in patterns:
            self.need(line, pattern, any(self.tree.root.glob(pattern.rstrip("/"))), "is not in the tree")

    def yaml(self, line, text):
        try:
            document = yaml.safe_load(re.sub(r",?\s*\.\.\.", "", text))
        except yaml.YAMLError as error:
            self.need(line, "YAML", False, str(error).replace("\n", " "))
            return
        self.yaml_keys(line, document)

    def yaml_keys(self, line, node):
        if isinstance(node, list):
            for item in node:
                self.yaml_keys(line, item)
        elif isinstance(node, dict):
            for key, value in node.items():
                known = key == "base" or str(key) in self.tree.keys or str(key) in self.tree.words
                self.need(line, key, known, "is no key")
                self.yaml_keys(line, value)

    def span(self, line, code):
        words = code.split()
        if not words:
            return
        first = words[0].rsplit("/", 1)[-1]
        if PROGRAM.match(first) and first not in self.tree.packages | self.tree.words or self.is_program(first):
            for command in simple_commands(code):
                self.command(line, command)
        elif (re.match(r"[a-z_]+(?:\.[a-z_0-9]+)+$", code) and code.split(".")[0] in self.tree.paths
              and not WRITTEN.search(code)):
            path = re.sub(r"\.\d+", "", code)
            self.need(line, code, path in self.tree.paths, "is no key of docs/configuration.md")
        elif re.match(r"(?:unit|property|integration|fault|process)\.\w+\.[\w.]+$", code):
            self.need(line, code, code in self.tree.ctests(), "is no test of ctest")
            return
        elif FILE.match(code):
            here = code in self.tree.names or code in self.made or re.match(r"(?:my|your|own|mine|NAME)\b|my_", code)
            self.need(line, code, bool(here), "is not in the tree")
        elif re.match(r"[a-z_]+: ", code):
            self.yaml(line, code)
        for word in words:
            self.file(line, word)
        for word in IDENTIFIER.findall(code):
            if not FRAMES.match(word) and not word.startswith(("my_", "lib")):
                self.need(line, word, word in self.tree.words, "is nowhere in the sources")

    def links(self):
        for number, line in enumerate(self.text.splitlines(), 1):
            for target in re.findall(r"\]\(([^)\s]+)\)", line):
                if not re.match(r"\w+:", target):
                    path = (self.tree.root / self.path).parent / target.split("#")[0]
                    self.need(number, target, path.exists(), "leads nowhere")
