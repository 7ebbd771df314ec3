"""All channels as one LCM log."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from palpate_common import palpate_package
from palpate_import.layouts import encoded
from palpate_import.recording import Channel


def write_log(path: Path, channels: list[Channel], session: int) -> None:
    """Events in the order of their times, at equal times in that of the files, rows and channels. The file has its name once it is
    complete. Raises OSError."""
    bytes_of = []
    for channel in channels:
        channel.messages["utime"], channel.messages["session"] = channel.utimes, session
        channel.messages["seq"] = np.arange(len(channel.utimes))
        bytes_of.append(encoded(channel.messages))
    utimes = np.concatenate([channel.utimes for channel in channels])
    index = np.concatenate([np.full(len(channel.utimes), i) for i, channel in enumerate(channels)])
    within = np.concatenate([np.arange(len(channel.utimes)) for channel in channels])
    rows = np.concatenate([channel.rows for channel in channels])
    files = np.concatenate([np.full(len(channel.utimes), channel.file) for channel in channels])
    part = path.with_name(path.name + ".part")
    try:
        with palpate_package.load().EventLogWriter(part) as writer:
            for at in np.lexsort((index, rows, files, utimes)).tolist():
                channel = channels[index[at]]
                writer.write(int(utimes[at]), channel.name, bytes_of[index[at]][within[at]])
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)
