"""The page: the same steps and questions in a browser on this machine."""

from __future__ import annotations

import json
import secrets
import threading
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any, Mapping, Optional

from palpate_common.input_error import InputError
from palpate_common.section import Section
from palpate_setup.guide import Guide
from palpate_setup.programs import Programs
from palpate_setup.project import REPORT, Project
from palpate_setup.questions import Question, asked, asked_keys, with_defaults
from palpate_setup.step import Step

WEB = Path(__file__).with_name("web")
TYPES = {".html": "text/html; charset=utf-8", ".js": "text/javascript", ".css": "text/css", ".png": "image/png"}
FILES = {"/": "index.html", "/page.js": "page.js", "/page.css": "page.css"}
LARGEST = 65536  # bytes, of a request
KEPT = 200  # lines of the log
POLICY = "default-src 'none'; script-src 'self'; style-src 'self'; img-src blob:; connect-src 'self'; base-uri 'none'; form-action 'none'"


class PagePerson:
    """Answers that the page has sent; waits where the page has to confirm."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.waits_for = ""
        self._typed: Mapping[str, str] = {}
        self._ready, self._stop = threading.Event(), threading.Event()

    def begin(self, typed: Mapping[str, str]) -> None:
        """A new step with these answers."""
        self._typed, self.lines, self.waits_for = typed, [], ""
        self._ready.clear()
        self._stop.clear()

    def answers(self, step: Step, project: Project, skip: bool) -> dict[str, Any]:
        questions = step.questions_to_skip(project) if skip else step.questions(project)
        unknown = set(self._typed) - {question.key for question in questions}
        if unknown:
            raise InputError(f"{sorted(unknown)[0]}: is no question of step {step.name}")
        return asked(questions, lambda question: question.parse(self._typed.get(question.key, "")))

    def ready(self, text: str) -> None:
        self._ready.clear()
        self.waits_for = text
        self._ready.wait()
        self.waits_for = ""
        self.check()

    def say(self, text: str) -> None:
        self.lines = [*self.lines[-KEPT:], text]

    def check(self) -> None:
        if self._stop.is_set():
            raise InputError("stopped at the page")

    def command(self, step: str) -> Optional[str]:
        return None

    def resume(self) -> None:
        """What was asked for is done."""
        self._ready.set()

    def stop(self) -> None:
        """Ends the step at its next check."""
        self._stop.set()
        self._ready.set()


class Office:
    """The project behind the page; one step runs at a time."""

    def __init__(self, project: Project, programs: Programs) -> None:
        self.project = project
        self.person = PagePerson()
        self._guide = Guide(project, programs, self.person)
        self._lock = threading.Lock()
        self._thread: Optional[threading.Thread] = None
        self._step = ""

    def state(self) -> dict[str, Any]:
        """Everything that the page shows."""
        running = self._thread is not None and self._thread.is_alive()
        return {"project": self.project.folder.name, "running": self._step if running else "", "log": self.person.lines,
                "waits_for": self.person.waits_for if running else "",
                "steps": [self._shown(step) for step in self.project.steps]}  # fmt: skip

    def _shown(self, step: Step) -> dict[str, Any]:
        entry = self.project.entry(step.name)
        missing = self.project.missing_needs(step)
        shown: dict[str, Any] = {"name": step.name, "title": step.title, "about": step.about, "status": self.project.status(step),
                                 "why": self.project.why_outdated(step) or entry.get("reason", ""), "lines": entry.get("lines", []),
                                 "pictures": entry.get("pictures", []), "time": entry.get("time", ""), "missing": missing}  # fmt: skip
        if not missing:
            earlier = entry.get("answers", {})
            shown["questions"] = [_described(q) for q in with_defaults(step.questions(self.project), earlier)]
            shown["questions_to_skip"] = [_described(q) for q in with_defaults(step.questions_to_skip(self.project), earlier)]
        return shown

    def _step_of(self, name: str) -> Step:
        step = next((step for step in self.project.steps if step.name == name), None)
        if step is None:
            raise InputError(f"{name}: there is no such step")
        return step

    def asked(self, name: str, typed: Mapping[str, str]) -> list[str]:
        """Keys of a step's questions, run or skipped, that apply with these answers. Raises InputError if there is no such step."""
        step = self._step_of(name)
        if self.project.missing_needs(step):
            return []
        return [*asked_keys(step.questions(self.project), typed), *asked_keys(step.questions_to_skip(self.project), typed)]

    def run(self, name: str, skip: bool, typed: Mapping[str, str]) -> None:
        """Begins a step. Raises InputError if one is running or there is no such step."""
        step = self._step_of(name)
        with self._lock:
            if self._thread is not None and self._thread.is_alive():
                raise InputError(f"step {self._step} is running")
            self.person.begin(typed)
            self._step = name
            self._thread = threading.Thread(target=self._perform, args=(step, skip), daemon=True)
            self._thread.start()

    def _perform(self, step: Step, skip: bool) -> None:
        try:
            self._guide.perform(step, skip)
        except InputError as error:
            self.person.say(f"stopped: {error}")
        except Exception as error:
            self.person.say(f"stopped: {type(error).__name__}: {error}")
            raise

    def close(self) -> None:
        """Ends a step that is running."""
        self.person.stop()
        if self._thread is not None:
            self._thread.join(60)

    def picture(self, name: str) -> Optional[bytes]:
        """A picture of a step, or the report; None if it is neither."""
        allowed = {REPORT} | {picture for step in self.project.steps for picture in self.project.entry(step.name).get("pictures", [])}
        path = self.project.folder / name
        return path.read_bytes() if name in allowed and path.is_file() else None


def _described(question: Question) -> dict[str, Any]:
    return {"key": question.key, "text": question.text, "allowed": question.allowed, "default": question.shown_default,
            "choices": list(question.choices)}  # fmt: skip


class _Handler(BaseHTTPRequestHandler):
    """Of a loopback server: it checks the header Host (against names that resolve here), Origin, and the token."""

    server: _Server
    server_version, sys_version = "palpate-setup", ""

    def log_message(self, format: str, *args: Any) -> None:
        pass

    def _send(self, status: HTTPStatus, kind: str, body: bytes) -> None:
        self.send_response(status)
        for name, value in (("Content-Type", kind), ("Content-Length", str(len(body))), ("Cache-Control", "no-store"),
                            ("Content-Security-Policy", POLICY), ("X-Content-Type-Options", "nosniff"),
                            ("Referrer-Policy", "no-referrer")):  # fmt: skip
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(body)

    def _send_json(self, value: Any, status: HTTPStatus = HTTPStatus.OK) -> None:
        self._send(status, "application/json", json.dumps(value).encode())

    def _fault(self, needs_token: bool) -> Optional[HTTPStatus]:
        host = self.headers.get("Host", "")
        if host not in self.server.hosts:
            return HTTPStatus.FORBIDDEN
        origin = self.headers.get("Origin")
        if origin is not None and origin != f"http://{host}":
            return HTTPStatus.FORBIDDEN
        given = self.headers.get("X-Palpate-Token", "")
        if needs_token and not secrets.compare_digest(given.encode(), self.server.token.encode()):
            return HTTPStatus.UNAUTHORIZED
        return None

    def do_GET(self) -> None:
        fault = self._fault(self.path not in FILES)
        if fault is not None:
            self._send(fault, "text/plain", fault.phrase.encode())
        elif self.path in FILES:
            path = WEB / FILES[self.path]
            self._send(HTTPStatus.OK, TYPES[path.suffix], path.read_bytes())
        elif self.path == "/state":
            self._send_json(self.server.office.state())
        else:
            name = self.path.removeprefix("/file/")
            body = self.server.office.picture(name)
            if body is None:
                self._send(HTTPStatus.NOT_FOUND, "text/plain", b"not found")
            else:
                self._send(HTTPStatus.OK, TYPES.get(Path(name).suffix, "application/octet-stream"), body)

    def do_POST(self) -> None:
        fault = self._fault(True)
        length = int(self.headers.get("Content-Length") or 0)
        if fault is None and length > LARGEST:
            fault = HTTPStatus.REQUEST_ENTITY_TOO_LARGE
        if fault is not None:
            self._send(fault, "text/plain", fault.phrase.encode())
            return
        try:
            self._send_json(self._obey(json.loads(self.rfile.read(length) or b"{}")))
        except (InputError, ValueError, KeyError, TypeError, AttributeError) as error:
            self._send_json({"error": str(error)}, HTTPStatus.BAD_REQUEST)

    def _obey(self, request: Any) -> dict[str, Any]:
        """The answer."""
        office = self.server.office
        if self.path in ("/run", "/asked"):
            asks = Section(request, Path("request"))
            answers = {str(key): str(value) for key, value in request.get("answers", {}).items()}
            if self.path == "/asked":
                return {"keys": office.asked(asks.text("step"), answers)}
            office.run(asks.text("step"), asks.flag("skip", False), answers)
        elif self.path == "/continue":
            office.person.resume()
        elif self.path == "/stop":
            office.person.stop()
        else:
            raise InputError(f"{self.path}: unknown")
        return {}


class _Server(ThreadingHTTPServer):
    daemon_threads = True

    def __init__(self, office: Office, port: int) -> None:
        super().__init__(("127.0.0.1", port), _Handler)
        self.office, self.token = office, secrets.token_hex(32)
        self.hosts = {f"{name}:{self.server_port}" for name in ("127.0.0.1", "localhost")}


def serve(project: Project, programs: Programs, port: int) -> int:
    """Until it is interrupted. Raises OSError where the port is taken."""
    office = Office(project, programs)
    with _Server(office, port) as server:
        print(f"http://127.0.0.1:{server.server_port}/#token={server.token}", flush=True)
        try:
            server.serve_forever()
        except KeyboardInterrupt:
            pass
        finally:
            office.close()
    return 0
