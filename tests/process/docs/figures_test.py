#!/usr/bin/env python3
"""Fails where a figure of README.md, docs/results.md or docs/robots differs from the stored result that it cites,
where a table has figures that cite none, and where a result is stored or declared in vain.

usage: figures_test.py ROOT
"""
import pathlib
import sys

ROOT = pathlib.Path(sys.argv[1])
sys.path.insert(0, str(ROOT / "tools/lab/report"))
import figures  # noqa: E402


def main():
    declarations, results = figures.declared(ROOT), figures.stored(ROOT)
    wrong, cited = [], set()
    for page in figures.PAGES:
        text = (ROOT / page).read_text(encoding="utf-8")
        wrong += figures.differences(page, text, declarations, results)
        wrong += [f"{page}: cites no result: {line}" for line in figures.uncited(text)]
        cited.update(name for block in figures.BLOCK.finditer(text) for name in block[2].split())
        cited.update(found[2] for found in figures.CITED.finditer(text))
    wrong += [f"{figures.STORED}: {name} is not declared in {figures.DECLARED}" for name in results if name not in declarations]
    wrong += [f"{figures.DECLARED}: no page cites {name}" for name in declarations if name not in cited]
    for name, entry in declarations.items():
        wrong += [f"{figures.DECLARED}: {name}: there is no {path}" for path in entry.get("inputs", ()) if not (ROOT / path).exists()]
    print("\n".join(wrong) or f"{len(results)} results, {len(cited)} cited")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
