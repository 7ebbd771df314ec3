"""What arrives on an LCM URL: rates, ages, and whether the numbers can be what their units say."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import Any, Callable, Optional

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
FARTHEST = 5.0  # m, of a flange from the base of its arm
FASTEST = 20.0  # m/s or rad/s, of a flange
STRONGEST = (5000.0, 1000.0)  # N, N m
GRAVITY = 9.81  # m/s^2
FREE = 3.0  # m/s^2, by which the length of an acceleration at rest may differ from gravity's
LATE, OLDEST = 0.5, 5.0  # s, of a message by its sender's clock: worth a remark; a fault
FROZEN = 500  # equal readings in a row, as palpated's inputs.frozen_after_ms


@dataclass
class Heard:
    """Messages of one channel."""

    channel: str
    times: list[float] = field(default_factory=list)  # s, of reception
    ages: list[float] = field(default_factory=list)  # s, by the sender's clock
    messages: list[Any] = field(default_factory=list)
    undecodable: int = 0
    faults: list[str] = field(default_factory=list)

    @property
    def rate(self) -> float:
        """Hz, between the first and the last."""
        if len(self.times) < 2 or self.times[-1] <= self.times[0]:
            return 0.0
        return (len(self.times) - 1) / (self.times[-1] - self.times[0])

    @property
    def age(self) -> float:
        """s, median."""
        return float(np.median(self.ages)) if self.ages else float("nan")

    def column(self, name: str) -> Floats:
        """A field of all messages, (n, width)."""
        return np.array([getattr(message, name) for message in self.messages], float)


@dataclass(frozen=True)
class Expected:
    """A channel that palpated receives. least: rate, Hz."""

    channel: str
    least: float
    is_required: bool
    check: Callable[[Heard], Optional[str]]


def listen(url: str, seconds: float, check: Callable[[], None]) -> tuple[dict[str, Heard], int]:
    """Messages by channel, and the number of datagrams that were no LCM messages. check: called all the time; raises to stop.
    Raises ValueError or OSError."""
    from palpate.channels import decode
    from palpate.udpm import Transport

    heard: dict[str, Heard] = {}
    transport = Transport(url)
    try:
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            packet = transport.receive(min(left, 0.1))
            check()
            if packet is None:
                continue
            now = time.time()
            one = heard.setdefault(packet.channel, Heard(packet.channel))
            try:
                message = decode(packet.channel, packet.data)
            except ValueError:
                one.undecodable += 1
                continue
            one.times.append(now)
            one.ages.append(now - 1e-6 * message.utime)
            one.messages.append(message)
    finally:
        malformed = transport.malformed
        transport.close()
    return heard, malformed


def _finite(*values: Floats) -> bool:
    return all(np.isfinite(value).all() for value in values)


def robot_fault(heard: Heard) -> Optional[str]:
    """Of ROBOT_STATE."""
    position, quaternion, twist = heard.column("position"), heard.column("quaternion"), heard.column("twist")
    if not _finite(position, quaternion, twist):
        return "numbers that are not finite"
    length = np.linalg.norm(quaternion, axis=1)
    if np.abs(length - 1).max() > 1e-3:
        return f"quaternion of length {length[np.abs(length - 1).argmax()]:.4g}; allowed: 1, w first"
    farthest = float(np.linalg.norm(position, axis=1).max())
    if farthest > FARTHEST:
        return f"flange {farthest:.4g} m from the base; allowed: up to {FARTHEST:g} m (is the position in mm?)"
    if np.abs(twist).max() > FASTEST:
        return f"twist of {np.abs(twist).max():.4g}; allowed: up to {FASTEST:g} m/s and rad/s (mm/s or degrees?)"
    count = {message.joint_count for message in heard.messages}
    if len(count) != 1 or not 0 <= count.copy().pop() <= 16:
        return f"joint_count {sorted(count)}; allowed: one number from 0 to 16"
    return _twist_fault(heard, position, twist)


def _twist_fault(heard: Heard, position: Floats, twist: Floats) -> Optional[str]:
    """Compares the way of the flange with the integral of its velocity, where it moves by 5 mm or more."""
    stamps = 1e-6 * np.array([message.utime for message in heard.messages])
    way = position[-1] - position[0]
    if np.linalg.norm(way) < 0.005 or stamps[-1] <= stamps[0]:
        return None
    integral = np.trapezoid(twist[:, :3], stamps, axis=0) if hasattr(np, "trapezoid") else np.trapz(twist[:, :3], stamps, axis=0)
    if np.linalg.norm(integral - way) > 0.3 * np.linalg.norm(way) + 0.002:
        return (f"the flange moved by {np.round(1e3 * way, 1).tolist()} mm while its twist says {np.round(1e3 * integral, 1).tolist()} mm; "
                "the twist is that of the origin of E, in W, m/s, linear first")  # fmt: skip
    return None


def wrench_fault(heard: Heard) -> Optional[str]:
    """Of FT_WRENCH."""
    wrench = heard.column("wrench")
    if not _finite(wrench):
        return "numbers that are not finite"
    for part, name, unit, limit in ((wrench[:, :3], "force", "N", STRONGEST[0]), (wrench[:, 3:], "torque", "N m", STRONGEST[1])):
        if np.abs(part).max() > limit:
            return f"{name} of {np.abs(part).max():.4g} {unit}; allowed: up to {limit:g} {unit}"
    return _frozen(wrench)


def imu_fault(heard: Heard) -> Optional[str]:
    """Of IMU."""
    acceleration, rate = heard.column("acceleration"), heard.column("angular_velocity")
    if not _finite(acceleration, rate):
        return "numbers that are not finite"
    length = float(np.linalg.norm(acceleration.mean(axis=0)))
    if abs(length - GRAVITY) > FREE and np.abs(rate).max() < 0.2:
        hint = "in g?" if abs(length - 1) < 0.3 else "without gravity?" if length < 1 else "in another unit?"
        return f"acceleration at rest of {length:.3g} m/s^2; allowed: {GRAVITY - FREE:.3g} to {GRAVITY + FREE:.3g} ({hint})"
    return _frozen(np.hstack([acceleration, rate]))


def nothing_wrong(heard: Heard) -> Optional[str]:
    """Of a channel whose numbers are not checked."""
    return None


def _frozen(values: Floats) -> Optional[str]:
    changes = np.flatnonzero((np.diff(values, axis=0) != 0).any(axis=1))
    runs = np.diff(np.concatenate([[-1], changes, [len(values) - 1]]))
    return f"{int(runs.max())} equal readings in a row" if runs.max() > FROZEN else None


CHANNELS = (
    Expected("ROBOT_STATE", 100, True, robot_fault),
    Expected("FT_WRENCH", 200, True, wrench_fault),
    Expected("IMU", 100, False, imu_fault),
    Expected("HAND_STATE", 20, False, nothing_wrong),
    Expected("SHAPE_OBSERVATION", 1, False, nothing_wrong),
)


def judge(heard: dict[str, Heard], is_simulated: bool) -> tuple[list[str], list[str]]:
    """Lines of a table, and what is wrong with the channels: absent, slow, old, of another type, or implausible. A simulator
    may be slow and late: that is remarked only."""
    lines, faults = [f"{'channel':<20}{'rate, Hz':>10}{'age, ms':>10}"], []
    for expected in CHANNELS:
        one = heard.get(expected.channel)
        if one is None or not one.messages:
            if one is not None:
                faults.append(f"{expected.channel}: {one.undecodable} messages of another type than palpate's")
            elif expected.is_required:
                faults.append(f"{expected.channel}: no message; required")
            else:
                lines.append(f"{expected.channel:<20}{'absent':>10}  (optional)")
            continue
        lines.append(f"{expected.channel:<20}{one.rate:>10.0f}{1e3 * one.age:>10.1f}")
        if LATE <= abs(one.age) < OLDEST:
            lines.append(f"    its clock differs from this machine's by {one.age:.2g} s: synchronise them, or the sender is late")
        slow = lines if is_simulated else faults
        if one.rate < expected.least:
            slow.append(f"{expected.channel}: {one.rate:.0f} Hz; allowed: {expected.least:g} Hz or more")
        if not -OLDEST < one.age < OLDEST:
            slow.append(f"{expected.channel}: utime is {one.age:.3g} s behind this machine's clock; allowed: {OLDEST:g} s "
                          "(microseconds since 1970; are the clocks synchronised?)")  # fmt: skip
        sessions = {message.session for message in one.messages}
        if len(sessions) > 1:
            faults.append(f"{expected.channel}: {len(sessions)} senders; allowed: one")
        fault = expected.check(one)
        if fault:
            faults.append(f"{expected.channel}: {fault}")
    known = {expected.channel for expected in CHANNELS}
    others = [f"{name} ({len(one.times) + one.undecodable})" for name, one in sorted(heard.items()) if name not in known]
    if others:
        lines.append(f"also heard (messages): {', '.join(others)}")
    return lines, faults
