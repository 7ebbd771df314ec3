"""Steers a point of the object, and waits until the daemon believes it to be there.

usage: steer_a_point.py [--to X Y Z] [--within MM] [--for S] [--url URL] ...
e.g.   palpate-sim sim/scenes/bar_long_soft_control.yaml &
       palpated --config rt/config/examples/bar_long_soft.yaml &
       steer_a_point.py --to 0.25 0.03 0.08

Starts nothing but the control: simulator (or robot) and daemon run already, with a feature of kind
point. Exit codes: 0 it is there, 1 it is not, or something went wrong.
"""

from __future__ import annotations

import sys
import time

import numpy as np
from common import daemon_of, parser_for

import palpate


def main() -> int:
    parser = parser_for(__doc__ or "")
    parser.add_argument("--to", type=float, nargs=3, default=[0.25, 0.03, 0.08],
                        metavar=("X", "Y", "Z"), help="m, in O (default: %(default)s)")  # fmt: skip
    parser.add_argument("--rest", type=float, nargs=3, default=[0.25, 0.03, 0.06],
                        metavar=("X", "Y", "Z"),
                        help="the point at rest, as configured, m (default: %(default)s)")  # fmt: skip
    parser.add_argument("--within", type=float, default=2, help="mm (default: %(default)s)")
    parser.add_argument("--for", type=float, default=20, dest="patience",
                        help="s, at most (default: %(default)s)")  # fmt: skip
    options = parser.parse_args()
    try:
        with daemon_of(options) as daemon:
            features = daemon.control.subscribe("FEATURE", queue=1)
            daemon.start()
            daemon.target("point", options.to, [options.rest])
            begin = time.monotonic()
            next_report = 0.0
            while (elapsed := time.monotonic() - begin) < options.patience:
                feature = features.latest(options.timeout)
                distance = float(np.linalg.norm(feature.error[: feature.error_count]))
                arrived = feature.revision >= 0 and 1e3 * distance <= options.within
                if elapsed >= next_report or arrived:
                    print(f"{elapsed:5.1f} s: {1e3 * distance:6.2f} mm to go")
                    next_report = elapsed + 1
                if arrived:
                    daemon.stop()
                    return 0
            daemon.stop()
            print(f"not within {options.within} mm after {options.patience} s", file=sys.stderr)
    except (OSError, ValueError, palpate.Refused) as error:
        print(f"error: {error}", file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main())
