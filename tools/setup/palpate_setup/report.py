"""The report: an HTML page with what each step found, and its pictures."""

from __future__ import annotations

from datetime import datetime, timezone
from pathlib import Path

from palpate_setup.project import CONFIGURATION, REPORT, Project

TEMPLATE = Path(__file__).with_name("report.html")


def write(project: Project) -> None:
    """report.html in the project's folder; its pictures are those of the steps' folders."""
    import jinja2

    environment = jinja2.Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
    steps = []
    for number, step in enumerate(project.steps, 1):
        entry = project.entry(step.name)
        steps.append({"number": number, "name": step.name, "title": step.title, "about": step.about,
                      "status": project.status(step), "why": project.why_outdated(step) or entry.get("reason", ""),
                      "time": entry.get("time", ""), "lines": entry.get("lines", []), "pictures": entry.get("pictures", []),
                      "settings": entry.get("settings", [])})  # fmt: skip
    path = project.configuration
    text = environment.from_string(TEMPLATE.read_text()).render(
        name=project.folder.name, steps=steps, configuration=path.read_text() if path.exists() else "", file=CONFIGURATION,
        time=datetime.now(timezone.utc).isoformat(timespec="seconds"))  # fmt: skip
    (project.folder / REPORT).write_text(text)
