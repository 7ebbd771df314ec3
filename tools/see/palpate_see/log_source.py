"""Clouds and joint states of LCM logs."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Iterator, Optional

from palpate_common import palpate_package
from palpate_common.input_error import InputError
from palpate_see.cloud import Cloud
from palpate_see.point_cloud_message import MalformedCloud, decode_point_cloud
from palpate_see.robot_body import RobotBody


def read_log(path: Path, channel: str) -> Iterator[tuple[Optional[Cloud], int]]:
    """Each cloud of the channel and when it was received, us; None in place of a malformed one. Raises InputError, also for
    a log without that channel."""
    seen: set[str] = set()
    for event in _events(path):
        seen.add(event.channel)
        if event.channel == channel:
            try:
                yield decode_point_cloud(event.data), event.utime
            except MalformedCloud:
                yield None, event.utime
    if channel not in seen:
        raise InputError(f"{path}: has no {channel}; allowed as channel of the configuration: {', '.join(sorted(seen))}")


def read_joints(path: Path, body: RobotBody, own_names: dict[str, str]) -> int:
    """Adds all states of arm and hand in a log. own_names: as in Settings. Returns how many of them
    cannot be used. Raises InputError."""
    decode = palpate_package.load().decode
    return sum(not take_state(body, own_names.get(event.channel, event.channel), event.data, decode) for event in _events(path))


def take_state(body: RobotBody, channel: str, data: bytes, decode: Any, latest: Optional[int] = None) -> bool:
    """Adds a message if it is a state of the arm or the hand. False if it is one that cannot be decoded or used, or one with a
    stamp after `latest`, us."""
    if channel not in ("ROBOT_STATE", "HAND_STATE"):
        return True
    try:
        message = decode(channel, data)
    except ValueError:
        return False
    if latest is not None and message.utime > latest:
        return False
    add = body.add_arm if channel == "ROBOT_STATE" else body.add_hand
    return add(message.utime, list(message.q)[: max(message.joint_count, 0)])


def _events(path: Path) -> Iterator[Any]:
    try:
        yield from palpate_package.load().EventLog(path)
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from error
    except ValueError as error:
        raise InputError(str(error)) from error
