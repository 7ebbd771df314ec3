"""An installation of palpate in a separate folder, and shells with completion."""
import os
import pathlib
import pty
import re
import select
import shutil
import signal
import subprocess
import tempfile
import time

PATIENCE = 120  # s, sufficient for a very busy machine


def run(words, **more):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True,
                          timeout=PATIENCE, **more)


class Installation:
    """cmake --install into a temporary folder."""

    def __init__(self, build, prefix=None, destination=None):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="palpate_installed_"))
        self.prefix = pathlib.Path(prefix) if prefix else self.folder / "prefix"
        self.root = self.folder / "root" if destination else None
        environment = {**os.environ, **({"DESTDIR": str(self.root)} if self.root else {})}
        done = run(["cmake", "--install", build, "--prefix", self.prefix], env=environment)
        if done.returncode != 0:
            raise RuntimeError(done.stdout[-2000:] + done.stderr)
        self.manifest = self.folder / "manifest.txt"
        shutil.copy(pathlib.Path(build) / "install_manifest.txt", self.manifest)

    @property
    def here(self):
        """Current paths of its files."""
        return self.root / str(self.prefix).lstrip("/") if self.root else self.prefix

    def programs(self):
        return sorted(path.name for path in (self.here / "bin").iterdir())

    def files(self):
        top = self.root or self.prefix
        return [path for path in top.rglob("*") if path.is_file() or path.is_symlink()]

    def close(self):
        shutil.rmtree(self.folder, ignore_errors=True)


class Shell:
    """An interactive shell on a terminal."""

    def __init__(self, words, environment):
        self.pid, self.terminal = pty.fork()
        if self.pid == 0:
            os.execvpe(words[0], words, environment)
        self.said = ""

    def read(self, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            ready, _, _ = select.select([self.terminal], [], [], 0.05)
            if ready:
                try:
                    self.said += os.read(self.terminal, 65536).decode(errors="replace")
                except OSError:
                    return

    def until(self, pattern):
        """Output since the last call, up to the pattern; fails on time-out."""
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            self.read(0.05)
            found = re.search(pattern, self.said)
            if found:
                heard, self.said = self.said[:found.end()], self.said[found.end():]
                return heard
        raise AssertionError(f"never came: {pattern!r}; but: {self.said[-500:]!r}")

    def type(self, text):
        os.write(self.terminal, text.encode())

    def close(self):
        os.kill(self.pid, signal.SIGKILL)
        os.waitpid(self.pid, 0)
        os.close(self.terminal)
