#!/usr/bin/env python3
"""Fails where the interface of plug-ins has changed and its version has not.

usage: plugin_interface.py ROOT [--write]

plugin_interface.txt holds the version and a digest of the code of the headers, without comments and
white space; --write brings it up to date, for a version that has been raised.
"""
import hashlib
import pathlib
import re
import sys

HEADERS = ("rt/plugin/plugin.hpp", "rt/plugin/plugin_components.hpp")
RECORD = pathlib.Path(__file__).with_suffix(".txt")


def current(root):
    code = "".join((root / name).read_text(encoding="utf-8") for name in HEADERS)
    version = re.search(r"kPluginInterface = (\d+);", code).group(1)
    code = re.sub(r"//[^\n]*|\s+", "", code)
    return version, hashlib.sha256(code.encode()).hexdigest()


def main():
    version, digest = current(pathlib.Path(sys.argv[1]))
    recorded, known = RECORD.read_text(encoding="utf-8").split() if RECORD.exists() else ("0", "")
    if "--write" in sys.argv[2:]:
        if int(version) <= int(recorded) and digest != known:
            print(f"kPluginInterface is still {version}: raise it first")
            return 1
        RECORD.write_text(f"{version} {digest}\n", encoding="utf-8")
        return 0
    if (version, digest) == (recorded, known):
        return 0
    print("the interface of plug-ins has changed: raise kPluginInterface in rt/plugin/plugin.hpp, then\n"
          "tests/support/plugin_interface.py . --write")
    return 1


if __name__ == "__main__":
    sys.exit(main())
