#!/usr/bin/env python3
"""Prints how far the feature is from its target at the end of an LCM log of palpated's.

usage: feature_error.py FOLDER-OF-PYTHON-TYPES LOG [LARGEST-MM]
Exit codes: 0 the error is known and at most LARGEST-MM, 1 not.
"""
import math
import pathlib
import struct
import sys

SYNC = 0xEDA1DA01


def events(data):
    """(channel, bytes) of an LCM log."""
    at = 0
    while at + 28 <= len(data):
        sync, _, _, channel_size, size = struct.unpack_from(">IqqiI", data, at)
        if sync != SYNC:
            raise ValueError(f"byte {at}: no event of an LCM log")
        at += 28
        yield data[at:at + channel_size].decode(), data[at + channel_size:at + channel_size + size]
        at += channel_size + size


def main():
    if len(sys.argv) not in (3, 4):
        print(__doc__, file=sys.stderr)
        return 1
    sys.path.insert(0, sys.argv[1])
    from palpate import feature_t
    last = None
    for channel, data in events(pathlib.Path(sys.argv[2]).read_bytes()):
        if channel == "FEATURE":
            last = feature_t.decode(data)
    if last is None:
        print("error: no FEATURE in the log", file=sys.stderr)
        return 1
    error = 1e3 * math.sqrt(sum(e * e for e in last.error[:3]))
    print(f"target revision {last.revision}, the feature is {error:.2f} mm from it")
    return 0 if last.revision >= 0 and (len(sys.argv) < 4 or error <= float(sys.argv[3])) else 1


if __name__ == "__main__":
    sys.exit(main())
