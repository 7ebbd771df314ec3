"""What several steps share: URLs of the project, recordings, and palpated as a process."""

from __future__ import annotations

from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Iterator, Optional, Sequence

from palpate_common.input_error import InputError
from palpate_setup.configuration import own_settings, text_of
from palpate_setup.programs import Child
from palpate_setup.project import Project
from palpate_setup.step import Setting, Work

if TYPE_CHECKING:
    from palpate.daemon import Daemon

READY = "waits for start"
RECORDED = "ROBOT_STATE|FT_WRENCH|IMU|HAND_STATE"
ANSWER = 30.0  # s, for an answer of the daemon


def urls(project: Project) -> tuple[str, str]:
    """Control and housekeeping."""
    answers = project.entry("channels").get("answers", {})
    return str(answers["control"]), str(answers["housekeeping"])


def key_file(project: Project) -> Optional[Path]:
    name = project.entry("channels").get("answers", {}).get("key_file")
    return project.folder / name if name else None


@contextmanager
def recording(work: Work, name: str) -> Iterator[Path]:
    """palpate-record of the control URL while the block runs; yields the log that it writes."""
    path = work.folder / name
    path.unlink(missing_ok=True)
    control, _ = urls(work.project)
    child = work.programs.start("palpate-record", "--url", f"control={control}", "--only", "control",
                                "--channel", RECORDED, path,
                                log=work.folder / "palpate-record.txt")  # fmt: skip
    try:
        yield path
    finally:
        child.end()
    if not path.exists():
        raise InputError(f"palpate-record has written no {path.name}: {child.said()}")


def configuration_of(work: Work, name: str, more: Sequence[Setting]) -> Path:
    """A complete configuration in the step's folder: what is set up so far, changed by `more`. Names of files are those of
    the project's folder, which is where palpated has to look for them: raises InputError for another place."""
    path = work.project.folder / name
    path.write_text(text_of([*work.project.settings(), *own_settings(work.project), *more],
                            f"Written by palpate-setup for its step {work.folder.name}; palpate.yaml is the result."))  # fmt: skip
    return path


@contextmanager
def daemon(work: Work, configuration: Path) -> Iterator[tuple[Daemon, Child]]:
    """palpated with a configuration, and a client of it. It is stopped and ended with the block, whatever happens."""
    from palpate.daemon import Daemon, NoAnswer, Refused

    work.programs.run("palpated", "--config", configuration, "--check")
    control, housekeeping = urls(work.project)
    with work.programs.start("palpated", "--config", configuration, log=work.folder / "palpated.txt") as child:
        child.wait_for(READY)
        try:
            with Daemon(control, housekeeping, key_file=key_file(work.project), timeout=ANSWER) as client:
                try:
                    yield client, child
                finally:
                    if child.is_running():
                        client.stop()
        except (NoAnswer, Refused) as error:
            raise InputError(f"palpated: {error}") from error


def state_fault(client: Any) -> Optional[str]:
    """Why the daemon is not active; None if it is."""
    state = client.state()
    return None if state == "active" else f"palpated is {state}"
