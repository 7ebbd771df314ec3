#!/usr/bin/env python3
"""Builds the documentation site: guides, configuration by section, messages and the API reference.

usage: tools/docs [--output FOLDER] [--without-api]

Writes HTML to FOLDER/site (default build/docs) and fails where a link leads nowhere. Needs mkdocs with the theme
material and, for the API reference, doxygen (all packaged by Debian).
"""

from __future__ import annotations

import argparse
import html.parser
import re
import shutil
import subprocess
import sys
from pathlib import Path
from urllib.parse import unquote, urlparse

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent.parent
LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)")


def slug(title: str) -> str:
    return re.sub(r"[^a-z0-9]+", "-", title.lower().replace("`", "")).strip("-")


def with_links(text: str, page: Path, pages: set[str]) -> str:
    """Links of a page of the repository as the site needs them: those to sources become their paths."""

    def moved(match: re.Match[str]) -> str:
        image, label, target = match.groups()
        if re.match(r"\w+:|#", target):
            return match[0]
        path, _, anchor = target.partition("#")
        relative = (page.parent / path).resolve().relative_to(ROOT).as_posix()
        name = relative.removeprefix("docs/")
        if name not in pages and not (relative.startswith("docs/") and (ROOT / relative).is_file()):
            return label if relative in label else f"{label} (`{relative}`)"
        if name == "configuration.md":
            name = "configuration/index.md"
        up = "" if page.parent == ROOT else "../" * len(page.parent.relative_to(ROOT / "docs").parts)
        return f"{image}[{label}]({up}{name}{'#' + anchor if anchor else ''})"

    return LINK.sub(moved, text)


def split_configuration(text: str, folder: Path) -> list[str]:
    """One page for each top-level section of each kind of file. Returns their entries of the navigation."""
    folder.mkdir(parents=True)
    navigation = ["Overview: configuration/index.md"]
    introduction, *documents = re.split(r"^## ", text, flags=re.M)
    index = [introduction.strip(), ""]
    for document in documents:
        title, _, body = document.partition("\n")
        about, *parts = re.split(r"^### ", body, flags=re.M)
        sections: dict[str, list[str]] = {}
        for part in parts:
            name = part.partition("\n")[0].strip("` ")
            top = "top level" if name == "Top level" else re.split(r"[.\[:]", name)[0].replace("`", "")
            sections.setdefault(top, []).append(f"## {part.strip()}\n")
        index += [f"## {title}", "", about.strip(), ""]
        navigation.append(f"\"{title}\":")
        for top, texts in sections.items():
            page = f"{slug(title)}-{slug(top)}.md"
            (folder / page).write_text(f"# {title}: {top}\n\n" + "\n".join(texts))
            index.append(f"- [{top}]({page})")
            navigation.append(f"    - \"{top}\": configuration/{page}")
        index.append("")
    (folder / "index.md").write_text("\n".join(index))
    return navigation


def write_sources(folder: Path) -> list[str]:
    """Fills the folder that mkdocs reads. Returns the navigation of the configuration's pages."""
    navigation: list[str] = []
    shutil.copytree(ROOT / "docs", folder, ignore=shutil.ignore_patterns("data", "*.md"))
    pages = {path.relative_to(ROOT / "docs").as_posix() for path in (ROOT / "docs").rglob("*.md")}
    for name in sorted(pages):
        page = ROOT / "docs" / name
        text = with_links(page.read_text(), page, pages)
        if name == "configuration.md":
            navigation = split_configuration(text, folder / "configuration")
        else:
            (folder / name).write_text(text)
    readme = with_links((ROOT / "README.md").read_text(), ROOT / "README.md", pages)
    (folder / "index.md").write_text(readme)
    (folder / "api.md").write_text(
        "# API reference\n\nClasses, functions and files of the libraries `palpate::math` to `palpate::daemon`:\n"
        '<a href="../api/index.html">API reference by Doxygen</a>.\n'
    )
    return navigation


class Links(html.parser.HTMLParser):
    """Targets and anchors of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.targets: list[str] = []
        self.anchors: set[str] = set()
        self.feed(text)

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        for name, value in attributes:
            if name in ("href", "src") and value:
                self.targets.append(value)
            elif name in ("id", "name") and value:
                self.anchors.add(value)


def dead_links(site: Path) -> list[str]:
    """Links between pages of the site whose file or anchor does not exist. Doxygen's own pages are left out."""
    pages = {path: Links(path.read_text()) for path in site.rglob("*.html") if "api" not in path.relative_to(site).parts[:1]}
    dead = []
    for page, links in pages.items():
        if page.name == "404.html":
            continue
        for target in links.targets:
            parts = urlparse(target)
            if parts.scheme or parts.netloc:
                continue
            path = (page.parent / unquote(parts.path)).resolve() if parts.path else page
            path = path / "index.html" if path.is_dir() else path
            anchor = unquote(parts.fragment)
            if not path.is_file():
                dead.append(f"{page.relative_to(site)}: {target}: no such file")
            elif anchor and path in pages and anchor not in pages[path].anchors:
                dead.append(f"{page.relative_to(site)}: {target}: no such heading")
    return sorted(set(dead))


def run(command: list[str], folder: Path, text: str | None = None) -> None:
    done = subprocess.run(command, cwd=folder, input=text, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise ValueError(f"{' '.join(command)}: exit code {done.returncode}\n{done.stdout}{done.stderr}")


def build(output: Path, with_api: bool) -> None:
    for program, package in (("mkdocs", "mkdocs mkdocs-material"), ("doxygen", "doxygen")):
        if shutil.which(program) is None and (with_api or program != "doxygen"):
            raise ValueError(f"{program}: not found; install the packages {package}")
    if output.exists():
        shutil.rmtree(output)
    output.mkdir(parents=True)
    entries = [entry if entry.startswith(" ") else f"- {entry}" for entry in write_sources(output / "source")]
    navigation = "- Configuration:\n" + "\n".join(" " * 10 + entry for entry in entries)
    settings = (HERE / "mkdocs.yml").read_text().replace("- Configuration: configuration/index.md", navigation)
    (output / "mkdocs.yml").write_text(settings)
    run(["mkdocs", "build", "--quiet"], output)
    if with_api:
        inputs = " ".join(str(ROOT / top) for top in ("core", "rt"))
        settings = (HERE / "Doxyfile").read_text() + f"INPUT = {inputs}\nSTRIP_FROM_PATH = {ROOT}\n"
        run(["doxygen", "-"], output, settings + f"OUTPUT_DIRECTORY = {output / 'site'}\n")
    dead = dead_links(output / "site")
    if not with_api:
        dead = [link for link in dead if "api/index.html" not in link]
    if dead:
        raise ValueError("dead links:\n" + "\n".join(dead))


def main() -> int:
    parser = argparse.ArgumentParser(
        prog="tools/docs", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--output", type=Path, default=ROOT / "build" / "docs", help="folder (default: build/docs)")
    parser.add_argument("--without-api", action="store_true", help="leave out the API reference")
    options = parser.parse_args()
    try:
        build(options.output.resolve(), not options.without_api)
    except (OSError, ValueError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    print(f"documentation: {options.output.resolve() / 'site' / 'index.html'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
