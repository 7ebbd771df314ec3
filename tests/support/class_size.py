#!/usr/bin/env python3
"""Fails where a class with member functions that change its state has more than 25 data members.

usage: class_size.py ROOT [--list N] | class_size.py --self-test

Counts the non-static data members that a class or struct of core, rt, sim and tools declares itself, by universal-ctags.
Structs without member functions that change them (options, messages, results) may be of any size. --list N prints
every such class of at least N members. Exit code 77 (skipped) without universal-ctags.
"""
import collections
import json
import pathlib
import re
import subprocess
import sys
import tempfile

MOST = 25
TOPS = ("core", "rt", "sim", "tools")
SKIPPED = 77


def tags_of(files):
    """ctags' entries of functions, prototypes and data members within classes."""
    command = ["ctags", "--output-format=json", "--languages=C++", "--language-force=C++", "--kinds-C++=fpm",
               "--fields=+neZKSi", "--fields-C++=+{properties}", "-L", "-", "-f", "-"]
    done = subprocess.run(command, input="\n".join(map(str, files)), capture_output=True, text=True, check=True)
    for line in done.stdout.splitlines():
        tag = json.loads(line)
        if tag.get("scopeKind") in ("class", "struct") and not tag["name"].startswith("__anon"):
            yield tag


def changes_state(tag):
    """Whether a member function may change its object. Constructors, destructor and assignments do not count."""
    properties = set(tag.get("properties", "").split(","))
    if properties & {"const", "static", "delete", "default"}:
        return False
    own = re.sub(r"<.*", "", tag["scope"].rpartition("::")[2])
    return tag["name"].replace(" ", "") not in (own, "~" + own, "operator=")


def classes_of(root):
    """(path, line, name, data members, functions that change them) of every class with data members."""
    files = [path for top in TOPS for path in sorted((root / top).rglob("*")) if path.suffix in (".hpp", ".cpp", ".h")]
    members, functions = collections.defaultdict(dict), collections.defaultdict(set)
    declared = set()  # functions whose definition, which does not repeat "static", follows in the same file
    for tag in sorted(tags_of(files), key=lambda tag: tag["kind"] != "prototype"):
        owner = pathlib.Path(tag["path"]).relative_to(root).as_posix(), tag["scope"]
        if tag["kind"] == "member":
            if "static" not in tag.get("properties", "").split(","):
                members[owner].setdefault(tag["name"], tag["line"])
            continue
        if tag["kind"] == "prototype":
            declared.add((owner, tag["name"]))
        elif (owner, tag["name"]) in declared:
            continue
        if changes_state(tag):
            functions[owner].add(tag["name"])
    for (path, name), found in members.items():
        yield path, min(found.values()), name, len(found), functions[path, name]


def too_large(root, most):
    """(data members, "place: class") of every class with state and more than `most` members, largest first."""
    found = [(count, f"{path}:{line}: {name}") for path, line, name, count, functions in classes_of(root)
             if count > most and functions]
    return sorted(found, reverse=True)


def self_test():
    members = " ".join(f"int m{i}_{{{i}}}, n{i}_ = {i};" for i in range(13))  # 26
    with tempfile.TemporaryDirectory() as name:
        root = pathlib.Path(name)
        for top in TOPS:
            (root / top).mkdir()
        (root / "core/a.hpp").write_text(
            "namespace palpate::a {\n"
            f"class Large {{ public: void change() noexcept; private: {members} }};\n"
            f"struct Options {{ {members} int sum() const; static Options read(); }};\n"
            f"class Fixed {{ public: Fixed(); Fixed& operator=(const Fixed&) = delete; ~Fixed(); {members} }};\n"
            f"struct Table {{ explicit Table(int a); static Table load(); {members} }};\n"
            "Table Table::load() { return Table(1); }\n"
            f"class Outer {{ public: void change(); struct Inner {{ {members} }}; Inner inner_; }};\n"
            "class Small { public: void change() { x_ = 1; } private: int x_; static constexpr int kY = 1;\n"
            "  std::function<int(int)> f_ = [](int a) { int b = a; return b; };\n"
            "  std::array<std::map<int, int>, 3> y_{{{{1, 2}}}}; };\n}\n")
        (root / "rt/b.hpp").write_text("class Hidden { public: void change(); private: struct State; };\n")
        (root / "rt/b.cpp").write_text(f"struct Hidden::State {{ void change() {{ m0_ = 1; }} {members} }};\n")
        found = [place for _, place in too_large(root, MOST)]
        expected = ["rt/b.cpp:1: Hidden::State", "core/a.hpp:2: palpate::a::Large"]
        if sorted(found) != sorted(expected):
            print("expected", *expected, "found", *found, sep="\n")
            return 1
        if not any(place.endswith("Small") for _, place in too_large(root, 2)) or \
                any(place.endswith("Small") for _, place in too_large(root, 3)):
            print("Small has three members")
            return 1
    return 0


def main():
    try:
        version = subprocess.run(["ctags", "--version"], capture_output=True, text=True, check=True).stdout
    except OSError:
        version = ""
    if "Universal Ctags" not in version:
        print("needs universal-ctags")
        return SKIPPED
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    if len(sys.argv) not in (2, 4) or (len(sys.argv) == 4 and sys.argv[2] != "--list"):
        print(__doc__)
        return 64
    root = pathlib.Path(sys.argv[1]).resolve()
    if len(sys.argv) == 4:
        for count, place in too_large(root, int(sys.argv[3]) - 1):
            print(f"{count:4} {place}")
        return 0
    found = too_large(root, MOST)
    for count, place in found:
        print(f"{place} has {count} data members and member functions that change them; at most {MOST}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
