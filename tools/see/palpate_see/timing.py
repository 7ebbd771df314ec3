"""Time stamps of exposures: which clouds are in order and recent."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Optional

from palpate_common.section import Section

AHEAD_US = 100_000  # us that a stamp may be ahead of this computer's clock


@dataclass(frozen=True)
class Timing:
    """clock: `sender`, stamps are the camera's, or `received`, they are taken at the reception.

    delay_us: from the exposure to the stamp. most_age_us: of an exposure at its reception, by this computer's clock.
    """

    clock: str = "sender"
    delay_us: int = 0
    most_age_us: int = 500_000


class ExposureOrder:
    """Accepts clouds whose exposures follow each other."""

    def __init__(self, timing: Timing) -> None:
        self._timing = timing
        self._last: Optional[int] = None

    def exposure(self, stamp: int, received: Optional[int]) -> int:
        """us: of a cloud with this stamp that was received then; None: it was never sent."""
        use_reception = self._timing.clock == "received" and received is not None
        return (received if use_reception else stamp) - self._timing.delay_us  # type: ignore[operator]

    def refusal(self, exposure: int, received: Optional[int]) -> Optional[str]:
        """Why a cloud is left out: `out_of_order` (also one that is repeated), `old` or `ahead`; None if it is accepted. Its
        exposure, us, is then the latest."""
        if received is not None and received - exposure > self._timing.most_age_us:
            return "old"
        if received is not None and exposure - received > AHEAD_US:
            return "ahead"
        if self._last is not None and exposure <= self._last:
            return "out_of_order"
        self._last = exposure
        return None


def read_timing(section: Section) -> Timing:
    """Of section `timing`. Raises InputError."""
    made = Timing(
        section.choice("clock", ["sender", "received"], "sender"),
        round(1000 * section.number("delay_ms", -1000, 10000, 0)),
        round(1000 * section.number("most_age_ms", 1, 100000, 500)),
    )
    section.check_unused()
    return made
