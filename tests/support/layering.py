#!/usr/bin/env python3
"""Fails where a file includes what its layer may not know.

usage: layering.py ROOT | layering.py --self-test
"""
import pathlib
import re
import sys

# folder -> prefixes of our own headers that it may include
ALLOWED = {
    "core": ["core/"],
    "rt": ["core/", "rt/", "palpate/"],
    # Of sensing, only what the maker publishes of the sensor itself.
    "sim": ["core/math/", "core/mesh/", "core/sensing/biotac_geometry.hpp", "rt/bus/", "rt/config/",
            "rt/loop/sanitizer.hpp", "sim/", "palpate/"],
    "tools": ["core/", "rt/", "sim/", "tools/", "palpate/"],
    "tests": ["core/", "rt/", "sim/", "tools/", "tests/", "palpate/"],
}
# folder -> outside headers (regular expressions) that it may not include
FORBIDDEN_OUTSIDE = {
    "core": r"lcm/|yaml-cpp/|spdlog/|CLI/|dart/|torch/|urdf|thread>|mutex>|chrono>|fstream>|iostream>|"
            r"condition_variable>|future>|sys/|unistd|pthread|GL/|ceres/|filesystem>",
    "rt": r"dart/|GL/|ceres/",
    "sim": r"torch/|ceres/|cholmod",
}
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def violations(root):
    for top in ALLOWED:
        for path in sorted((root / top).rglob("*")):
            if path.suffix not in (".hpp", ".cpp", ".h"):
                continue
            relative = path.relative_to(root)
            for number, line in enumerate(path.read_text().splitlines(), 1):
                match = INCLUDE.match(line)
                if not match:
                    continue
                quote, header = match.groups()
                ours = header.split("/")[0] in (*ALLOWED, "palpate") and "/" in header
                if ours and not any(header.startswith(p) for p in ALLOWED[top]):
                    yield f"{relative}:{number}: {top} may not include {header}"
                forbidden = FORBIDDEN_OUTSIDE.get(top)
                if not ours and forbidden and re.match(forbidden, header + (">" if quote == "<" else "")):
                    yield f"{relative}:{number}: {top} may not include <{header}>"


def self_test():
    import tempfile
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for top in ALLOWED:
            (root / top).mkdir()
        (root / "core" / "a.cpp").write_text('#include "rt/bus/message_bus.hpp"\n#include <thread>\n')
        (root / "sim" / "b.cpp").write_text('#include "core/elasticity/body.hpp"\n#include "core/math/rigid.hpp"\n')
        found = list(violations(root))
        expected = 3
        if len(found) != expected:
            print(f"expected {expected} violations, found {found}")
            return 1
    return 0


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    if len(sys.argv) != 2:
        print(__doc__)
        return 2
    found = list(violations(pathlib.Path(sys.argv[1])))
    print("\n".join(found) if found else "layers hold")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
