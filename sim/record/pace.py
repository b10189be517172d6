"""The pace of a run: lockstep, or a multiple of real time."""

from dataclasses import dataclass

from sim.errors import HarnessError


@dataclass(frozen=True, slots=True)
class Pace:
    """``factor`` None: lockstep, as fast as possible; otherwise the multiple of real time."""

    factor: float | None = None


LOCKSTEP = Pace()
FASTEST = 1e6
"""No factor is as large."""


def parse_pace(text: str) -> Pace:
    """``lockstep`` or ``realtime[:FACTOR]``.

    Raises:
        HarnessError: anything else, or a factor that is not between these.
    """
    kind, colon, factor = text.partition(":")
    if kind == "lockstep" and not colon:
        return Pace()
    if kind == "realtime":
        try:
            value = float(factor) if colon else 1.0
        except ValueError:
            value = 0.0
        if 0.0 < value < FASTEST:
            return Pace(value)
    raise HarnessError(
        f"--pace {text}: write lockstep, realtime or realtime:FACTOR with a factor above 0 "
        f"and below {FASTEST:.0f}"
    )
