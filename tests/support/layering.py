#!/usr/bin/env python3
"""Fails where a file includes what its folder may not know, and where folders include each other in a circle.

usage: layering.py ROOT | layering.py --self-test

ALLOWED lists, for each second-level folder, every other folder that it may include. A new arrow is a
decision: add it here.
"""
import pathlib
import re
import sys
import tempfile

ALLOWED = {
    "core/math": "",
    "core/mesh": "core/math",
    "core/collision": "core/math core/mesh",
    "core/factor": "core/math",
    "core/elasticity": "core/math core/mesh core/collision core/factor",
    "core/solid": "core/math core/factor core/elasticity",
    "core/sensing": "core/math core/kinematics",
    "core/contact": "core/math core/mesh core/sensing",
    "core/estimation": "core/math core/mesh core/collision core/elasticity core/sensing core/contact",
    "core/frames": "core/math core/sensing core/estimation",
    "core/shape": "core/math core/mesh",
    "core/kinematics": "core/math",
    "core/control": "core/math core/collision core/elasticity core/contact core/shape core/kinematics",
    "rt/loop": "core/math",
    "rt/bus": "rt/loop",
    "rt/client": "rt/bus",
    "rt/config": "core/math core/mesh rt/bus",
    "rt/inference": "core/math core/sensing rt/loop rt/config",
    "rt/plugin": "core/mesh core/sensing core/contact core/estimation core/control rt/loop rt/config",
    "rt/registry": "core/math core/mesh core/collision core/factor core/elasticity core/sensing core/contact core/estimation core/frames "
                   "core/shape core/kinematics core/control rt/loop rt/config rt/inference rt/plugin",
    "rt/pipeline": "core/math core/mesh core/collision core/elasticity core/sensing core/estimation core/frames core/control rt/plugin rt/registry",
    "rt/daemon": "core/elasticity core/sensing core/estimation core/shape rt/loop rt/bus rt/config rt/plugin rt/registry rt/pipeline",
    # The plant must not share the estimator's model: no core/elasticity, no core/collision; of
    # sensing only the manufacturer's data of the sensor; of the loop its clock.
    "sim/draw": "core/math rt/loop/sanitizer.hpp",
    "sim/camera": "core/math sim/draw",
    "sim/object": "core/math",
    "sim/robot": "core/math",
    "sim/sensors": "core/math core/sensing/biotac_geometry.hpp rt/config sim/camera",
    "sim/scenes": "core/math core/mesh rt/loop/fixed_rate_loop.hpp rt/bus rt/config sim/draw sim/camera sim/object sim/robot sim/sensors",
    "tools/common": "core/math rt/config",
    "tools/log": "core/math core/mesh rt/bus",
    "tools/recordings": "core/math core/sensing rt/bus rt/config rt/inference tools/common tools/log",
    "tools/bridge": "core/math core/kinematics rt/loop/real_time.hpp rt/bus rt/client rt/config rt/registry tools/common "
                    "tools/driver tools/record",
    "tools/collect": "core/math core/sensing rt/bus rt/config sim/sensors tools/common tools/log tools/recordings",
    "tools/command": "rt/bus rt/client rt/config tools/common",
    "tools/doctor": "rt/loop rt/bus rt/client rt/config rt/daemon tools/common tools/log tools/record",
    "tools/drawing": "core/math core/mesh core/collision core/kinematics rt/bus rt/config rt/registry",
    "tools/driver": "core/math core/kinematics rt/bus rt/config rt/registry",
    "tools/examples": "core/mesh core/elasticity core/sensing core/control rt/bus rt/config rt/plugin",
    "tools/export": "core/math core/mesh core/elasticity rt/bus rt/config rt/registry sim/draw tools/common "
                    "tools/log tools/drawing tools/types",
    "tools/fit": "core/math core/mesh core/elasticity core/solid core/sensing core/contact core/control rt/config "
                 "rt/registry tools/common tools/log tools/recordings",
    "tools/mesh": "core/math core/mesh core/elasticity core/contact rt/config sim/draw tools/common tools/serve",
    "tools/record": "rt/loop rt/bus rt/config tools/common tools/types",
    "tools/reference": "core/sensing rt/bus rt/config rt/inference rt/plugin rt/daemon rt/pipeline sim/scenes tools/common "
                       "tools/fit tools/recordings",
    "tools/replay": "core/math rt/loop rt/bus rt/client rt/config rt/daemon tools/common tools/log "
                    "tools/record",
    "tools/serve": "rt/bus",
    "tools/top": "rt/loop rt/client rt/config tools/common tools/record tools/types",
    "tools/types": "",
    "tools/train": "core/math core/sensing rt/config rt/inference tools/common tools/recordings",
    "tools/view": "core/math core/elasticity core/sensing rt/bus rt/client rt/config rt/registry "
                  "tools/common tools/drawing tools/export tools/log tools/serve tools/types",
    # Any may include core, rt, sim and tools; listed here are other folders of the laboratory.
    "tools/lab/inject": "",
    "tools/lab/baselines": "",
    "tools/lab/unruly": "",
    "tools/lab/runs": "",
    "tools/lab/scores": "tools/lab/runs",
    "tools/lab/cases": "",
    "tools/lab/shapes": "tools/lab/cases",
    "tools/lab/uncertainty": "tools/lab/runs",
    "tools/lab/studies": "tools/lab/baselines tools/lab/runs tools/lab/scores tools/lab/uncertainty",
    "tools/lab/sensor_models": "tools/lab/runs tools/lab/scores tools/lab/studies",
    "tools/lab/faults": "tools/lab/runs tools/lab/unruly",
    "tools/lab/endurance": "tools/lab/runs tools/lab/scores tools/lab/faults",
    "tools/lab/demo": "tools/lab/runs tools/lab/scores tools/lab/sensor_models tools/lab/uncertainty",
    "tools/lab/fit_check": "",
    # palpate-evaluate's main, which includes every command.
    "tools/lab": "tools/lab/cases tools/lab/demo tools/lab/endurance tools/lab/faults tools/lab/scores "
                 "tools/lab/sensor_models tools/lab/shapes tools/lab/studies tools/lab/uncertainty",
}
# top folder -> outside headers (regular expressions) that it may not include
FORBIDDEN_OUTSIDE = {
    "core": r"lcm/|yaml-cpp/|spdlog/|CLI/|dart/|torch/|urdf|thread>|mutex>|chrono>|fstream>|iostream>|"
            r"condition_variable>|future>|sys/|unistd|pthread|GL/|ceres/|filesystem>",
    "rt": r"dart/|GL/|ceres/",
    "sim": r"torch/|ceres/|cholmod",
}
TOPS = ("core", "rt", "sim", "tools")
MOST_SOURCES = 60  # of one folder
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.M)


def folder_of(path):
    """The entry of ALLOWED that a file belongs to."""
    parts = path.split("/")
    depth = 3 if parts[:2] == ["tools", "lab"] and len(parts) > 3 else 2
    return "/".join(parts[:depth])


def allows(entry, folder, header):
    """Whether `folder` may include `header`, of another folder."""
    if folder.startswith("tools/lab") and not header.startswith("tools/lab/"):
        return True
    return any(header == allowed or header.startswith(allowed + "/") for allowed in entry.split())


def violations(root):
    sources = {}
    for top in TOPS:
        for path in sorted((root / top).rglob("*")):
            if path.suffix not in (".hpp", ".cpp", ".h"):
                continue
            relative = path.relative_to(root).as_posix()
            folder = folder_of(relative)
            sources.setdefault(relative.rpartition("/")[0], []).append(relative)
            if folder not in ALLOWED:
                yield f"{relative}: {folder} has no entry in ALLOWED"
                continue
            text = path.read_text()
            for match in INCLUDE.finditer(text):
                quote, header = match.groups()
                place = f"{relative}:{text.count(chr(10), 0, match.start()) + 1}"
                ours = header.split("/")[0] in (*TOPS, "tests") and "/" in header
                if ours and folder_of(header) != folder and not allows(ALLOWED[folder], folder, header):
                    yield f"{place}: {folder} may not include {header}"
                forbidden = FORBIDDEN_OUTSIDE.get(top)
                if not ours and forbidden and re.match(forbidden, header + (">" if quote == "<" else "")):
                    yield f"{place}: {top} may not include <{header}>"
    for folder, files in sources.items():
        if len(files) > MOST_SOURCES:
            yield f"{folder}: {len(files)} source files, at most {MOST_SOURCES}"


def circles(allowed):
    """Include cycles, as chains of folders."""
    arrows = {folder: [folder_of(arrow + "/x") if not arrow.endswith(".hpp") else folder_of(arrow)
                       for arrow in entry.split()] for folder, entry in allowed.items()}
    done = set()

    def follow(folder, path):
        for target in arrows.get(folder, []):
            if target in path:
                yield " -> ".join([*path[path.index(target):], target])
            elif target not in done:
                yield from follow(target, [*path, target])
        done.add(folder)

    for folder in arrows:
        if folder not in done:
            yield from follow(folder, [folder])


def compiled_twice(root):
    """Sources that a folder's CMakeLists.txt takes from another folder's library."""
    for top in (*TOPS, "tests"):
        for path in sorted((root / top).rglob("CMakeLists.txt")):
            if path.parent.name == "stress":  # compiles weakened copies on purpose
                continue
            for match in re.finditer(r"\$\{CMAKE_SOURCE_DIR\}/((?:core|rt|sim|tools)/[\w/]+\.cpp)", path.read_text()):
                yield f"{path.relative_to(root)}: compiles {match.group(1)} again; link to its library"


def self_test():
    with tempfile.TemporaryDirectory() as name:
        root = pathlib.Path(name)
        for folder in ("core/math", "sim/object", "tools/lab/runs", "tools/top", "core/unknown", "rt/bus"):
            (root / folder).mkdir(parents=True)
        (root / "core/math/a.cpp").write_text('#include "rt/bus/message_bus.hpp"\n#include <thread>\n')
        (root / "sim/object/b.cpp").write_text('#include "core/elasticity/body.hpp"\n#include "core/math/rigid.hpp"\n')
        (root / "tools/lab/runs/c.cpp").write_text('#include "core/elasticity/body.hpp"\n')
        (root / "tools/top/d.cpp").write_text('#include "tools/lab/runs/operator.hpp"\n')
        (root / "core/unknown/e.cpp").write_text("\n")
        (root / "rt/bus/CMakeLists.txt").write_text("add_library(x ${CMAKE_SOURCE_DIR}/core/math/rigid.cpp)\n")
        for i in range(MOST_SOURCES + 1):
            (root / f"rt/bus/f{i}.hpp").write_text("\n")
        found = [*violations(root), *compiled_twice(root), *circles({"a/b": "c/d", "c/d": "e/f", "e/f": "a/b"})]
        expected = 8
        if len(found) != expected:
            print(f"expected {expected} violations, found", *found, sep="\n")
            return 1
    return 0


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    if len(sys.argv) != 2:
        print(__doc__)
        return 2
    root = pathlib.Path(sys.argv[1])
    found = [*violations(root), *compiled_twice(root), *(f"circle: {circle}" for circle in circles(ALLOWED))]
    print("\n".join(found) if found else "layers hold")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
