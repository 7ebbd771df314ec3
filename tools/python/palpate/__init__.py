"""palpate from Python: read logs, subscribe, command, evaluate.

    log = palpate.read_log("control.log", "housekeeping.log")
    log["SHAPE"].positions                      # (m, nodes, 3), m, in O
    palpate.shape_error(log).whole              # mean, RMS and maximum, m

    with palpate.Bus(palpate.HOUSEKEEPING_URL) as bus:
        for shape in bus.subscribe("SHAPE"): ...

    with palpate.Daemon() as daemon:
        daemon.start()
        daemon.target("point", [0.25, 0.03, 0.08])

All in SI units and radians, times of messages in us (utime) or s since the log's start (time). The
messages are palpate.messages; lcmtypes/*.lcm says what their fields are.
"""

from palpate.authentication import read_key_file, seal, verify
from palpate.bus import CONTROL_URL, HOUSEKEEPING_URL, PICTURES_URL, Bus, Subscription
from palpate.channels import DecodeError, channel_names, decode, text_of, type_of
from palpate.daemon import STATES, Answer, Daemon, NoAnswer, Refused, health_inputs
from palpate.evaluate import (
    FeatureError,
    ShapeError,
    Summary,
    coverage,
    feature_error,
    settle_time,
    shape_coverage,
    shape_error,
)
from palpate.event_log import Event, EventLog, EventLogWriter
from palpate.log import Log, Series, read_log
from palpate.mesh import Mesh, MeshBuilder, PointsInMesh, assemble
from palpate.recorder import Recorder
from palpate.touch import Touch
from palpate.version import __version__

__all__ = [
    "CONTROL_URL",
    "HOUSEKEEPING_URL",
    "PICTURES_URL",
    "STATES",
    "Answer",
    "Bus",
    "Daemon",
    "DecodeError",
    "Event",
    "EventLog",
    "EventLogWriter",
    "FeatureError",
    "Log",
    "Mesh",
    "MeshBuilder",
    "NoAnswer",
    "PointsInMesh",
    "Recorder",
    "Refused",
    "Series",
    "ShapeError",
    "Subscription",
    "Summary",
    "Touch",
    "__version__",
    "assemble",
    "channel_names",
    "coverage",
    "decode",
    "feature_error",
    "health_inputs",
    "read_key_file",
    "read_log",
    "seal",
    "settle_time",
    "shape_coverage",
    "shape_error",
    "text_of",
    "type_of",
    "verify",
]
