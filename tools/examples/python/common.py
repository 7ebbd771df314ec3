"""Common parts of the examples: options that locate the daemon."""

from __future__ import annotations

import argparse

import palpate


def parser_for(text: str) -> argparse.ArgumentParser:
    """A parser with the options that locate a daemon, described by `text`."""
    parser = argparse.ArgumentParser(
        description=text, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--url", default=palpate.CONTROL_URL,
                        help="control URL (default: %(default)s)")  # fmt: skip
    parser.add_argument("--housekeeping", default=palpate.HOUSEKEEPING_URL,
                        help="housekeeping URL (default: %(default)s)")  # fmt: skip
    parser.add_argument("--key", help="file of the key that the daemon has")
    parser.add_argument("--timeout", type=float, default=10,
                        help="s, to wait for an answer (default: %(default)s)")  # fmt: skip
    return parser


def daemon_of(options: argparse.Namespace) -> palpate.Daemon:
    """The daemon given by the options."""
    return palpate.Daemon(options.url, options.housekeeping, options.key, options.timeout)
