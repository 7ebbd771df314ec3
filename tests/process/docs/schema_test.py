#!/usr/bin/env python3
"""Fails where the JSON Schemas differ from the code, or from what the programs accept.

usage: schema_test.py ROOT BIN    the files in schema equal the output of palpate-reference --schema; every YAML file
                                  of the repository matches its schema, and wrong entries do not
"""
import copy
import filecmp
import json
import pathlib
import re
import subprocess
import sys
import tempfile

import jsonschema
import yaml

# Files of each schema.
KINDS = {
    "configuration": ("rt/config/examples/*.yaml", "tools/examples/*/*.yaml", "tools/packaging/system/palpated.yaml"),
    "scene": ("sim/scenes/*.yaml", "tools/lab/fit_check/*.yaml"),
    "training": ("tools/train/presets/*.yaml",),
    "fit": ("tools/fit/presets/*.yaml",),
}
# Entries that must be rejected: schema, file, changes as in --set, part of the message.
WRONG = (
    ("configuration", "rt/config/examples/bar_long_soft.yaml", {"control.gain": 1000}, "1000"),
    ("configuration", "rt/config/examples/bar_long_soft.yaml", {"control.gain": "fast"}, "fast"),
    ("configuration", "rt/config/examples/bar_long_soft.yaml", {"control.gian": 1}, "gian"),
    ("configuration", "rt/config/examples/bar_long_soft.yaml", {"control.limits": {"untold_deviation": 0.01}}, "untold_deviation"),
    ("configuration", "rt/config/examples/bar_long_soft.yaml", {"estimation.component": "pose"}, "pose"),
    ("configuration", "rt/config/examples/bar_long_soft.yaml", {"estimation.fade_ms": 10}, "fade_ms|False"),
    ("configuration", "rt/config/examples/bar_long_soft.yaml", {"loop.lock_memory": "perhaps"}, "perhaps"),
    ("configuration", "rt/config/examples/bar_long_soft.yaml", {"frames.sensor_in_flange": {"place": [0, 0, 0]}}, "place"),
    ("configuration", "rt/config/examples/bar_long_soft.yaml", {"object.mesh.box.cells": [10, 1]}, "too short|short"),
    ("configuration", "rt/config/examples/bar_long_soft.yaml", {"object": None}, "mapping|object"),
    ("configuration", "rt/config/examples/wrench.yaml", {"feature": {"component": "point", "rest_points": [[0, 0, 0]]}}, "object"),
    ("configuration", "rt/config/examples/bar_long_hard.yaml", {"object.material.density": -1}, "-1"),
    ("configuration", "rt/config/examples/bar_long_hard.yaml", {"object.material.weight": 1}, "weight"),
    ("scene", "sim/scenes/bar_long_soft_control.yaml", {"robot.speed_of_light": 1}, "speed_of_light"),
    ("training", "tools/train/presets/ft_rnnob.yaml", {"training.epochs": "many"}, "many|epochs"),
    ("fit", "tools/fit/presets/foam_mech.yaml", {"solver.method_of_choice": 1}, "method_of_choice"),
)


class Loader(yaml.SafeLoader):
    """Numbers as in YAML 1.2: 60e3 is one."""


Loader.add_implicit_resolver("tag:yaml.org,2002:float", re.compile(r"^[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?$"),
                             list("-+0123456789."))
Loader.add_implicit_resolver("tag:yaml.org,2002:int", re.compile(r"^[-+]?[0-9]+$"), list("-+0123456789"))
for first in "yYnNoO":  # yes, no, on and off are text
    Loader.yaml_implicit_resolvers[first] = [
        pair for pair in Loader.yaml_implicit_resolvers.get(first, []) if pair[0] != "tag:yaml.org,2002:bool"]


def changed(document, changes):
    result = copy.deepcopy(document)
    for path, value in changes.items():
        *above, key = path.split(".")
        place = result
        for part in above:
            place = place.setdefault(part, {})
        if value is None:
            del place[key]
        else:
            place[key] = value
    return result


def messages(validator, document):
    """Of all errors, those within alternatives among them."""
    found, errors = [], list(validator.iter_errors(document))
    while errors:
        error = errors.pop()
        found.append("/".join(map(str, error.absolute_path)) + ": " + error.message)
        errors += error.context
    return found


def main():
    root, programs = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    failures = []
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([programs / "palpate-reference", "--schema", folder], check=True, timeout=300)
        names = sorted(path.name for path in pathlib.Path(folder).iterdir())
        if names != sorted(path.name for path in (root / "rt/config/schema").iterdir()):
            failures.append(f"schema contains other files than {names}")
        for name in names:
            if not (root / "rt/config/schema" / name).is_file() or not filecmp.cmp(root / "rt/config/schema" / name,
                                                                         pathlib.Path(folder) / name, shallow=False):
                failures.append(f"rt/config/schema/{name} is not current; run: palpate-reference --schema rt/config/schema")
        schemas = {kind: json.loads((pathlib.Path(folder) / f"{kind}.json").read_text()) for kind in KINDS}
    validators = {}
    for kind, schema in schemas.items():
        jsonschema.Draft7Validator.check_schema(schema)
        validators[kind] = jsonschema.Draft7Validator(schema)
    read = lambda name: yaml.load((root / name).read_text(), Loader)
    count = 0
    for kind, patterns in KINDS.items():
        for path in sorted(path for pattern in patterns for path in root.glob(pattern)):
            count += 1
            failures += [f"{path.relative_to(root)}: {message}" for message in messages(validators[kind], read(path))]
            selected = re.match(r"# yaml-language-server: \$schema=(\S+)$", path.read_text(), re.M)
            if not selected:
                failures.append(f"{path.relative_to(root)}: its first line selects no schema")
            elif "share/palpate" not in selected[1] and (path.parent / selected[1]).resolve() != (root / "rt/config/schema" / f"{kind}.json").resolve():
                failures.append(f"{path.relative_to(root)}: {selected[1]} is not rt/config/schema/{kind}.json")
    for kind, name, changes, expected in WRONG:
        found = messages(validators[kind], changed(read(name), changes))
        if not any(re.search(expected, message) for message in found):
            failures.append(f"{name} with {changes} is accepted, or rejected for another reason: {found}")
    print(f"{count} files, {len(WRONG)} wrong entries")
    print("\n".join(failures))
    return 1 if failures or count < 60 else 0


if __name__ == "__main__":
    sys.exit(main())
