"""Recordings from LCM logs: ROBOT_STATE, FT_WRENCH and, where present, IMU."""

from __future__ import annotations

from typing import Sequence

import numpy as np

from palpate_calibrate.recording import Recording, Stream
from palpate_common.input_error import InputError
from palpate_common.rotations import Array, from_wxyz


def channel_of(name: str, arm: int) -> str:
    """Channels of the second arm have the suffix _1."""
    return name if arm == 0 else f"{name}_{arm}"


def read_logs(paths: Sequence[str], arm: int, clock: str, gravity: Array) -> Recording:
    """`clock`: "received", that of the recording computer, or "sent", those of the senders. Raises InputError."""
    try:
        import palpate
    except ImportError as error:
        raise InputError(f"LCM logs need the Python package palpate: {error}; remedy: apt-get install python3-palpate") from error
    try:
        log = palpate.read_log(*paths, clock=clock)
    except (OSError, ValueError) as error:
        raise InputError(f"{', '.join(map(str, paths))}: {error}") from error
    named = ", ".join(map(str, paths))
    for name in ("ROBOT_STATE", "FT_WRENCH"):
        if channel_of(name, arm) not in log:
            raise InputError(f"{named}: no {channel_of(name, arm)}; the log has: {', '.join(log.channels) or 'nothing'}; "
                             "record with palpate-record while the arm moves")  # fmt: skip
    robot, wrench = log[channel_of("ROBOT_STATE", arm)], log[channel_of("FT_WRENCH", arm)]
    norms = np.linalg.norm(robot.quaternion, axis=1)
    wrong = np.flatnonzero(np.abs(norms - 1) > 1e-3)
    if wrong.size:
        raise InputError(f"{named}: ROBOT_STATE.quaternion: length {norms[wrong[0]]:.6g} at {robot.time[wrong[0]]:.3f} s; "
                         "allowed: 1")  # fmt: skip
    rotations = from_wxyz(robot.quaternion).reshape(-1, 9)
    recording = Recording(named, Stream("ROBOT_STATE", robot.time, np.hstack([robot.position, rotations])),
                          Stream("FT_WRENCH", wrench.time, wrench.wrench), gravity=gravity)  # fmt: skip
    if channel_of("IMU", arm) in log:
        imu = log[channel_of("IMU", arm)]
        recording.acceleration = Stream("IMU", imu.time, imu.acceleration)
        recording.angular_velocity = Stream("IMU", imu.time, imu.angular_velocity)
    return recording
