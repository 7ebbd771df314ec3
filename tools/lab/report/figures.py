"""The figures of the documentation: figures.yaml declares how each is made, docs/data/figures.json
stores what was measured, and pages cite it.

A page holds tables between two comments, which readers do not see, and figures in sentences
before one:

  <!-- figures NAME NAME -->     the rows of these results, written by tools/lab/report/run --pages
  <!-- end of figures -->
  an error of 0.66 mm<!-- = NAME.value:.2f mm -->
"""
import hashlib
import json
import pathlib
import re
import subprocess

import yaml

ROOT = pathlib.Path(__file__).resolve().parents[3]
DECLARED = "tools/lab/report/figures.yaml"
STORED = "docs/data/figures.json"
PAGES = ("README.md", "docs/results.md", "docs/robots/joint_torques.md")
ALWAYS = ("core", "rt", "sim")  # inputs of every result, besides its own
SENTENCE = re.compile(r"(-?\d[\d,.]*)([^<|\n]*)(<!-- = (\w+)\.(\w+):(\S+?)( (?!-->)[^\n]*?)? -->)")
ESCAPED = "\\|"  # in a cell of a table
BLOCK = re.compile(r"(^<!-- figures ([\w ]+?) -->\n)(.*?)(^<!-- end of figures -->)", re.S | re.M)
CITED = re.compile(r"([^\n]*?)<!-- = (\w+)\.(\w+):(\S+?)( (?!-->)[^\n]*?)? -->")


def declared(root=ROOT):
    """The declarations by name, in their order."""
    return yaml.safe_load((root / DECLARED).read_text(encoding="utf-8"))


def stored(root=ROOT):
    return json.loads((root / STORED).read_text(encoding="utf-8"))


def store(results, root=ROOT):
    order = {name: i for i, name in enumerate(declared(root))}
    results = dict(sorted(results.items(), key=lambda result: order.get(result[0], len(order))))
    (root / STORED).write_text(json.dumps(results, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


def hash_of(path, root=ROOT):
    """Hash of the files below a path that the repository holds, as they are in the work tree."""
    names = subprocess.run(["git", "ls-files", "-z", "--", path], cwd=root, check=True, capture_output=True).stdout
    total = hashlib.sha256()
    for name in sorted(name for name in names.split(b"\0") if name):
        file = root / name.decode()
        if file.is_file():
            total.update(name + b"\0" + hashlib.sha256(file.read_bytes()).digest())
    return total.hexdigest()[:12]


def inputs_of(entry, root=ROOT, known=None):
    """Hash by input of an entry; `known` keeps those that many entries share."""
    known = {} if known is None else known
    for path in (*ALWAYS, *entry.get("inputs", ())):
        if path not in known:
            known[path] = hash_of(path, root)
    return {path: known[path] for path in (*ALWAYS, *entry.get("inputs", ()))}


def reason_stale(entry, result, root=ROOT, known=None):
    """Why a stored result is not that of the present state; empty if it is."""
    if result is None:
        return "never run"
    if not result.get("commit"):
        return "from an earlier build, of which no commit was kept"
    if result["command"] != entry["command"]:
        return "another command"
    changed = [path for path, now in inputs_of(entry, root, known).items() if result["inputs"].get(path) != now]
    return "changed since: " + ", ".join(changed) if changed else ""


def minutes_of(entry, result):
    """What it last took with the same command, otherwise what is declared."""
    if result and result.get("command") == entry["command"] and result.get("seconds"):
        return round(result["seconds"] / 60, 1)
    return entry.get("minutes", 1)


def texts_of(entry, result):
    """The text of each row's figure."""
    if not result:
        return ["not measured"] * len(entry["rows"])
    if "texts" in result:
        return result["texts"]
    return [row["figure"].format(**result["values"]) for row in entry["rows"]]


def lines_of(header, rows):
    return ["| " + " | ".join(header) + " |", "| " + " | ".join("---" for _ in header) + " |",
            *("| " + " | ".join(row) + " |" for row in rows)]


def build_of(result):
    if not result:
        return ""
    return result["commit"][:8] + (f", {result['date'][:10]}" if result.get("date") else "") if result.get("commit") else "earlier"


def table_of(names, declarations, results):
    """Markdown of the results' rows; of one with tables of its own, these."""
    lines, rows = [], []
    for name in names:
        entry, result = declarations[name], results.get(name, {})
        if "table" in result:
            lines += [""] * bool(lines) + lines_of(result["table"]["header"], result["table"]["rows"])
            lines += ["", f"`{result.get('command', entry['command'])}`, {build_of(result)}"]
            continue
        if "table" in entry:
            lines += [""] * bool(lines) + [f"Not measured: `{entry['command']}`"]
            continue
        for i, (row, text) in enumerate(zip(entry["rows"], texts_of(entry, result), strict=True)):
            command = f"`{result.get('command', entry['command']).replace('|', ESCAPED)}`"
            command += f", {entry['remark']}" if "remark" in entry else ""
            rows.append([row["what"], text, command if i == 0 else "the same", build_of(result)])
    if rows:
        lines += lines_of(["what", "figure", "command", "build"], rows)
    return "\n".join(lines) + "\n"


def written(page, declarations, results):
    """The page with its tables and the figures in its sentences as the results have them."""
    def figure(cited):
        value = results.get(cited[4], {}).get("values", {}).get(cited[5])
        if value is None or cited[2] != (cited[7] or ""):
            return cited[0]
        return format(value, cited[6]) + cited[2] + cited[3]

    page = SENTENCE.sub(figure, page)
    return BLOCK.sub(lambda block: block[1] + table_of(block[2].split(), declarations, results) + block[4], page)


def differences(page, text, declarations, results):
    """What of a page's text its results do not bear out, one sentence each."""
    found = []
    for block in BLOCK.finditer(text):
        unknown = [name for name in block[2].split() if name not in declarations]
        if unknown:
            found.append(f"{page}: no result is called {', '.join(unknown)}")
            continue
        should = table_of(block[2].split(), declarations, results).splitlines()
        for line in block[3].splitlines():
            if line not in should:
                found.append(f"{page}: not as stored: {line}")
        found += [f"{page}: missing: {line}" for line in should if line not in block[3].splitlines()]
    for cited in CITED.finditer(text):
        before, name, key, form, unit = cited.groups(default="")
        value = results.get(name, {}).get("values", {}).get(key)
        if value is None:
            found.append(f"{page}: no result {name}.{key}")
        elif not (before := re.sub(r"<!--.*?-->", "", before)).endswith(should := format(value, form) + unit):
            found.append(f"{page}: \"{before[-40:]}\" should end with \"{should}\" ({name}.{key})")
    return found


def uncited(text):
    """Rows of tables with numbers that no result is cited for."""
    rest = BLOCK.sub("", text)
    return [line for line in rest.splitlines()
            if line.startswith("|") and re.search(r"\d", re.sub(r"`[^`]*`|\[[^]]*\]\([^)]*\)", "", line)) and "<!-- = " not in line]
