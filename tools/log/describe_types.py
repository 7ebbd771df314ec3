#!/usr/bin/env python3
"""Writes the table of all message types as C++, from their .lcm files and units.txt.

usage: describe_types.py UNITS OUTPUT.cpp TYPE.lcm...
"""
import json
import pathlib
import re
import sys

INTEGERS = {"int8_t": 1, "int16_t": 2, "int32_t": 4, "int64_t": 8}
PRIMITIVES = {**{name: f"kInt{8 * size}" for name, size in INTEGERS.items()},
              "byte": "kByte", "boolean": "kInt8", "float": "kFloat", "double": "kDouble"}
MEMBER = re.compile(r"(\w+)\s+(\w+)((?:\[\w+\])*)$")
UNITS_LINE = re.compile(r"([\w*]+)\.(\w+)(?:\[(\w+)\])?\s+(.*)$")


class Wrong(Exception):
    pass


def read_units(path):
    """{(type, field): (count field or None, [unit])}"""
    units = {}
    for number, line in enumerate(path.read_text().splitlines(), 1):
        line = line.split("#")[0].strip()
        if not line:
            continue
        match = UNITS_LINE.match(line)
        if not match:
            raise Wrong(f"{path}:{number}: is not 'TYPE.FIELD[COUNT] UNIT'")
        kind, field, count, text = match.groups()
        listed = []
        for part in text.split(","):
            repeated = re.match(r"(\d+) (.+)$", part.strip())
            listed += [repeated[2]] * int(repeated[1]) if repeated else [part.strip()]
        if (kind, field) in units:
            raise Wrong(f"{path}:{number}: {kind}.{field} is there twice")
        units[kind, field] = (count, listed)
    return units


def read_type(path):
    """Name, comment, constants and members of the single struct of a file."""
    name, about, constants, members = None, [], [], []
    for number, line in enumerate(path.read_text().splitlines(), 1):
        where = f"{path}:{number}"
        code, _, comment = (part.strip() for part in line.partition("//"))
        if not code:
            if name is None and comment:
                about.append(comment)
            continue
        if code.startswith("package ") or code == "}":
            continue
        if code.startswith("struct "):
            if name is not None:
                raise Wrong(f"{where}: a second struct")
            name = code.split()[1]
            continue
        for statement in filter(None, (part.strip() for part in code.split(";"))):
            if statement.startswith("const "):
                for item in statement.split(None, 2)[2].split(","):
                    constants.append(tuple(part.strip() for part in item.split("=")))
                continue
            match = MEMBER.match(statement)
            if not match or match[1] not in PRIMITIVES:
                raise Wrong(f"{where}: '{statement}' is no member of a type that is known")
            sizes = re.findall(r"\w+", match[3])
            members.append({"type": match[1], "name": match[2], "sizes": sizes, "comment": comment})
    if name is None:
        raise Wrong(f"{path}: holds no struct")
    return {"name": name, "about": " ".join(about), "constants": constants, "members": members}


def describe(kind, units, used):
    """Adds to each member the index of its length or count field, and its units."""
    places = {member["name"]: i for i, member in enumerate(kind["members"])}
    for member in kind["members"]:
        where = f"{kind['name']}.{member['name']}"
        # a former version NAME_v1_t has the units of NAME_t
        names = (kind["name"], re.sub(r"_v\d+_t$", "_t", kind["name"]), "*")
        key = next((k for k in ((name, member["name"]) for name in names) if k in units), None)
        if key is None and member["type"] not in INTEGERS:
            raise Wrong(f"{where} has no line in units.txt")
        used.add(key)
        count, listed = units[key] if key else (None, ["1"])
        lengths = [size for size in member["sizes"] if not size.isdigit()]
        if lengths and (len(member["sizes"]) > 1 or lengths[0] not in places):
            raise Wrong(f"{where}: only arrays of one dimension can have a length of their own")
        if count is not None and (count not in places or not member["sizes"] or lengths):
            raise Wrong(f"{where}: '{count}' cannot be its count")
        is_bytes = member["type"] == "byte"
        if is_bytes != (listed[0] in ("text", "bytes")):
            raise Wrong(f"{where}: a {member['type']} cannot be '{listed[0]}'")
        last = 1 if not member["sizes"] or lengths else int(member["sizes"][-1])
        if len(listed) not in (1, last):
            raise Wrong(f"{where}: {len(listed)} units for {last} places")
        member["length"] = places[lengths[0]] if lengths else -1
        member["count"] = places[count] if count else -1
        member["sizes"] = [int(size) if size.isdigit() else 0 for size in member["sizes"]]
        member["units"] = listed


def quoted(text):
    return json.dumps(text, ensure_ascii=True)


def listed(items):
    return "{" + ", ".join(items) + "}"


def write_cpp(types):
    yield "// Made by tools/log/describe_types.py from lcmtypes/ and tools/log/units.txt."
    yield '#include "tools/log/type_table.hpp"'
    for kind in types:
        yield f"#include <palpate/{kind['name']}.hpp>"
    yield "namespace palpate::log {"
    yield "const std::vector<TypeInfo>& types() {"
    yield "  static const std::vector<TypeInfo> kTypes = {"
    for kind in types:
        constants = listed("{%s, %s}" % (quoted(name), value) for name, value in kind["constants"])
        yield f"    {{{quoted(kind['name'])}, {quoted(kind['about'])}, {kind['name']}::getHash(), {constants}, {{"
        for member in kind["members"]:
            yield ("      {%s, Primitive::%s, %s, %d, %d, %s, %s}," % (
                quoted(member["name"]), PRIMITIVES[member["type"]],
                listed(str(size) for size in member["sizes"]), member["length"], member["count"],
                listed(quoted(unit) for unit in member["units"]), quoted(member["comment"])))
        yield "    }},"
    yield "  };"
    yield "  return kTypes;"
    yield "}"
    yield "}  // namespace palpate::log"


def main():
    if len(sys.argv) < 4:
        print(__doc__)
        return 2
    try:
        units = read_units(pathlib.Path(sys.argv[1]))
        types = [read_type(pathlib.Path(path)) for path in sorted(sys.argv[3:])]
        used = set()
        for kind in types:
            describe(kind, units, used)
        for unknown in units.keys() - used:
            raise Wrong(f"{sys.argv[1]}: there is no {'.'.join(unknown)}")
    except Wrong as wrong:
        print(f"error: {wrong}", file=sys.stderr)
        return 1
    pathlib.Path(sys.argv[2]).write_text("\n".join(write_cpp(types)) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
