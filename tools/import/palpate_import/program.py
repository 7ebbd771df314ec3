"""What palpate-import does: recordings in, one log out."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path
from typing import Any

from palpate_common.input_error import WRONG_CONFIGURATION, InputError
from palpate_common.json_output import write_json
from palpate_common.section import read_section
from palpate_import import summary
from palpate_import.clock import NotObservable, Offset, Signal, fit_offset
from palpate_import.csv_table import CsvOptions
from palpate_import.description import ClockFit, Defaults, FileDescription, preset_file, read_description
from palpate_import.log_output import write_log
from palpate_import.quantities import values_of
from palpate_import.recording import Channel, Recording, read_recording
from palpate_import.streams import StreamDescription


def _pairs(texts: list[str]) -> dict[str, str]:
    return {name: value for name, _, value in (text.partition("=") for text in texts)}


def _is_folder_of_files(path: Path) -> bool:
    return path.is_dir() and not (path / "metadata.yaml").exists()


def _descriptions(options: argparse.Namespace) -> list[FileDescription]:
    """With the file of each. Raises InputError."""
    recordings = [Path(name) for name in options.recording]
    own = FileDescription(csv=CsvOptions(options.delimiter), time_column=options.time_column, time_unit=options.time_unit,
                          rate=options.rate or 0.0, start=options.start, where=_pairs(options.where))  # fmt: skip
    if options.format:
        own.streams = [StreamDescription(options.channel, options.format, _pairs(options.column), topic=options.topic or "")]
        files = [own]
    else:
        path = preset_file(options.preset) if options.preset else options.map
        folder = path.parent
        if len(recordings) == 1 and _is_folder_of_files(recordings[0]):
            folder = recordings.pop()
        files = read_description(read_section(path), Defaults(folder, options.urdf, options.flange or "", own))
    unnamed = [file for file in files if file.file is None]
    if len(unnamed) != len(recordings):
        raise InputError(f"{len(recordings)} recordings on the command line; allowed: {len(unnamed)}, one for each file that "
                         "the description does not name", WRONG_CONFIGURATION)  # fmt: skip
    for file, recording in zip(unnamed, recordings):
        file.file = recording
    return files


def _signal(recordings: list[Recording], text: str, file: Path) -> tuple[Channel, Signal]:
    """Of "CHANNEL.quantity". Raises InputError."""
    name, _, quantity = text.partition(".")
    for recording in recordings:
        for channel in recording.channels:
            if channel.name == name:
                return channel, Signal(channel.utimes * 1e-6, values_of(channel, quantity))
    names = [channel.name for recording in recordings for channel in recording.channels]
    raise InputError(f"{file}: clock: '{text}'; allowed: CHANNEL.QUANTITY of {', '.join(names)}", WRONG_CONFIGURATION)


def _fit_clock(fit: ClockFit, index: int, files: list[FileDescription], recordings: list[Recording]) -> Offset:
    """Moves the times of a recording. Raises InputError."""
    path = Path(recordings[index].path)
    _, moved = _signal([recordings[index]], fit.quantity, path)
    channel, reference = _signal([one for k, one in enumerate(recordings) if k != index], fit.follows, path)
    if files[channel.file].clock is not None and channel.file > index:
        raise InputError(
            f"{path}: clock: follows {fit.follows}, whose own clock is fitted later; allowed: a file above it",
            WRONG_CONFIGURATION,
        )
    unobservable = f"{path}: the offset of its clock is not observable from {fit.quantity} and {fit.follows}"
    try:
        found = fit_offset(moved, reference, fit.within)
    except NotObservable as error:
        raise InputError(f"{unobservable}: {error}; remedy: other quantities, a part with more motion, another `within`, or the key start") from error  # fmt: skip
    if not found.deviation <= fit.deviation:
        raise InputError(f"{unobservable}: {found.seconds:.4f} s with standard deviation {found.deviation:.4f} s; allowed: up to {fit.deviation:g} s (key deviation)")  # fmt: skip
    shift = int(round(found.seconds * 1e6))
    for own in recordings[index].channels:
        own.utimes = own.utimes + shift
        if own.utimes[0] < 0:
            raise InputError(f"{path}: its first time is {own.utimes[0] * 1e-6:g} s with the fitted offset; allowed: 0 or later; "
                             "remedy: the key start of both files")  # fmt: skip
    return found


def _warn_apart(recordings: list[Recording]) -> None:
    spans = [(min(int(c.utimes[0]) for c in one.channels), max(int(c.utimes[-1]) for c in one.channels)) for one in recordings]
    for i, (first, last) in enumerate(spans[1:], 1):
        if first > spans[0][1] or last < spans[0][0]:
            print(f"palpate-import: warning: {recordings[0].path} and {recordings[i].path} have no time in common: "
                  f"{spans[0][0] * 1e-6:.3f} to {spans[0][1] * 1e-6:.3f} s and {first * 1e-6:.3f} to {last * 1e-6:.3f} s; "
                  "remedy: the keys start or clock", file=sys.stderr)  # fmt: skip


def _report(
    options: argparse.Namespace, session: int, recordings: list[Recording], offsets: dict[int, Offset]
) -> dict[str, Any]:
    channels = [channel for recording in recordings for channel in recording.channels]
    return {
        "input": recordings[0].path if len(recordings) == 1 else [recording.path for recording in recordings],
        "output": str(options.output) if options.output else None,
        "session": session,
        "rows": sum(recording.rows for recording in recordings),
        "first_utime": min(int(channel.utimes[0]) for channel in channels),
        "last_utime": max(int(channel.utimes[-1]) for channel in channels),
        "messages": {channel.name: len(channel.utimes) for channel in channels},
        "channels": {channel.name: summary.document(channel) for channel in channels},
        "clocks": {recordings[i].path: {"offset": found.seconds, "deviation": found.deviation, "correlation": found.correlation}
                   for i, found in offsets.items()},
    }  # fmt: skip


def run(options: argparse.Namespace) -> int:
    """Raises InputError and OSError."""
    files = _descriptions(options)
    recordings: list[Recording] = []
    taken: dict[str, str] = {}
    kept: list[FileDescription] = []
    say = sys.stderr if options.json == "-" else sys.stdout
    for file in files:
        assert file.file is not None
        if file.optional and not file.file.exists():
            continue
        recordings.append(read_recording(file.file, file, len(kept), taken))
        kept.append(file)
        print(f"{recordings[-1].path}: {recordings[-1].rows} rows", file=say, flush=True)
        for channel, columns in recordings[-1].absent.items():
            print(f"  without {channel}: no {', '.join(columns[:3])}{', ...' if len(columns) > 3 else ''}", file=say)
    offsets = {i: _fit_clock(file.clock, i, kept, recordings) for i, file in enumerate(kept) if file.clock is not None}
    for i, found in offsets.items():
        print(f"{recordings[i].path}: {found.seconds:+.6f} s to its times, standard deviation {found.deviation:.6f} s, "
              f"correlation {found.correlation:.3f}", file=say)  # fmt: skip
    _warn_apart(recordings)
    channels = [channel for recording in recordings for channel in recording.channels]
    print(summary.table(channels), file=say)
    if options.preview:
        from palpate_import.picture import draw

        draw(channels, options.preview)
        print(f"{options.preview}: picture", file=say, flush=True)
    session = options.session if options.session is not None else int.from_bytes(os.urandom(8), "big", signed=False) >> 1
    if options.output:
        write_log(options.output, channels, session)
        print(f"{options.output}: {sum(len(channel.utimes) for channel in channels)} messages", file=say)
    if options.json:
        write_json(_report(options, session, recordings, offsets), options.json)
    return 0
