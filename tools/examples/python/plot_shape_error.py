"""Scores a recording of palpated and palpate-sim, prints the errors and plots them.

usage: plot_shape_error.py LOG [LOG...] [--sent] [--picture error.png] [--json scores.json]
e.g.   plot_shape_error.py control.log housekeeping.log --picture error.png

Of the plots one shows the error of the nodes over time, the other the estimated and the true shape at
the end. Exit codes: 0 done, 1 the logs lack something.
"""

from __future__ import annotations

import argparse
import json
import sys
from typing import Any

import palpate


def scores(log: palpate.Log) -> dict[str, Any]:
    """All errors of the log, in mm and s."""
    error = palpate.shape_error(log)
    result: dict[str, Any] = {
        "shapes": len(error.time),
        "mean_mm": 1e3 * error.whole.mean,
        "rms_mm": 1e3 * error.whole.rms,
        "maximum_mm": 1e3 * error.whole.maximum,
        "mean_percent_of_displacement": 100 * error.whole.mean / error.displacement.max(),
    }
    if "SHAPE_TARGET" in log and log["SHAPE_TARGET"].messages[-1].point_count > 0:
        feature = palpate.feature_error(log)
        result["feature"] = {
            "at_rest_mm": 1e3 * feature.at_rest,
            "within_5mm_s": feature.settle_time(5e-3),
            "within_2mm_s": feature.settle_time(2e-3),
            "overshoot": feature.overshoot,
        }
    try:
        result["within_95_percent_interval"] = palpate.shape_coverage(log)
    except ValueError:
        pass  # the estimator reports no standard deviations
    return result


def plot(log: palpate.Log, path: str) -> None:
    import matplotlib

    matplotlib.use("Agg")  # to a file: no display is needed
    from matplotlib import pyplot

    from palpate import plot as draw

    figure = pyplot.figure(figsize=(11, 4), layout="constrained")
    draw.shape_error(palpate.shape_error(log), figure.add_subplot(1, 2, 1))
    shapes = figure.add_subplot(1, 2, 2, projection="3d")
    draw.mesh(log.mesh, log["SHAPE"].of_mesh(log.mesh.hash).positions[-1], shapes, color="tab:blue")
    # The plant's finer surface has too many edges.
    truth = log["TRUTH_SHAPE"].positions[-1]
    draw.mesh(log.truth_mesh, truth, shapes, color="tab:orange", edgecolor="none")
    draw.save(shapes, path)


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("logs", nargs="+", help="LCM logs of the control and housekeeping URLs")
    parser.add_argument("--sent", action="store_true", help="by the senders' clocks (lock-step)")
    parser.add_argument("--picture", help="file for the plots (needs matplotlib)")
    parser.add_argument("--json", help="file for the scores")
    options = parser.parse_args()
    try:
        log = palpate.read_log(*options.logs, clock="sent" if options.sent else "received")
        result = scores(log)
        print(json.dumps(result, indent=2))
        if options.json:
            with open(options.json, "w") as file:
                json.dump(result, file)
        if options.picture:
            plot(log, options.picture)
    except (OSError, KeyError, ValueError, ImportError) as error:
        print(f"error: {error.args[0] if isinstance(error, KeyError) else error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
