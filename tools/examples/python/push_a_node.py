"""Pushes a node of the object by hand (thesis Fig 4.4) and prints how far it moves.

usage: push_a_node.py [--node N | --point X Y Z] [--force FX FY FZ] [--seconds S] [--url URL] ...
e.g.   palpated --config tools/examples/python/bar_pushed.yaml &
       push_a_node.py --point 0.25 0.03 0.06 --force 0 0 -0.2

The daemon needs a sensor `component: manual` and an estimator that loads the mesh with contacts, as in
bar_pushed.yaml; no robot. Exit codes: 0 done, 1 something went wrong.
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
from common import daemon_of, parser_for

import palpate


def main() -> int:
    parser = parser_for(__doc__ or "")
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--node", type=int, help="number of the node")
    where.add_argument("--point", type=float, nargs=3, metavar=("X", "Y", "Z"),
                       help="the node nearest to this point at rest, m in O")  # fmt: skip
    parser.add_argument("--force", type=float, nargs=3, default=[0, 0, -0.2],
                        metavar=("FX", "FY", "FZ"), help="N, in O (default: %(default)s)")  # fmt: skip
    parser.add_argument("--seconds", type=float, default=1.5,
                        help="how long (default: %(default)s)")  # fmt: skip
    options = parser.parse_args()
    try:
        with daemon_of(options) as daemon:
            daemon.start()
            mesh = daemon.mesh()
            node = options.node
            if node is None:
                point = options.point or mesh.nodes.mean(axis=0)
                node = int(np.argmin(np.linalg.norm(mesh.nodes - point, axis=1)))
            if not 0 <= node < len(mesh.nodes):
                raise ValueError(f"--node {node}: the mesh has nodes 0 to {len(mesh.nodes) - 1}")

            def place() -> Any:
                return np.reshape(daemon.shape().xyz, (-1, 3))[node]

            daemon.push(mesh.nodes[node], [0, 0, 0], 0.3)  # so that it settles under its weight
            before = place()
            daemon.push(mesh.nodes[node], options.force, options.seconds)
            pushed = place()
            daemon.push(mesh.nodes[node], [0, 0, 0])  # releases the node
            health = daemon.health()
            if palpate.STATES[health.state] not in ("active", "degraded"):
                raise palpate.Refused(f"the daemon is {palpate.STATES[health.state]}: "
                                      + palpate.text_of(health.reason))  # fmt: skip
            moved = 1e3 * (pushed - before)
            print(f"node {node} at {np.round(mesh.nodes[node], 4)} m, {options.force} N: "
                  f"{moved[0]:.3f} {moved[1]:.3f} {moved[2]:.3f} mm")  # fmt: skip
        return 0
    except (OSError, ValueError, palpate.Refused) as error:
        print(f"error: {error}", file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main())
