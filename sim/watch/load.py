"""The load of the bus, by the time at which its frames came."""

from collections import deque
from dataclasses import dataclass, field

from fsw.wire.frame import Frame
from sim.bench.bus_load import BITRATE

WINDOW_S = 2.0
"""Time over which frames are counted."""


def most_bits(length: int) -> int:
    """Bits of a classic frame with an 11-bit identifier and so many data bytes, with the most stuff bits.

    8 n + 47 + floor((34 + 8 n - 1) / 4). Source: Davis, Burns, Bril, Lukkien 2007, Controller Area Network
    schedulability analysis (Real-Time Systems 35), eq. 1.
    """
    return 8 * length + 47 + (33 + 8 * length) // 4


@dataclass(slots=True)
class Load:
    """Frames and bits of the last seconds."""

    _recent: deque[tuple[float, int]] = field(default_factory=deque)
    _bits: int = 0

    def take(self, frame: Frame, now_s: float) -> None:
        """Count one frame; where time goes back, as from one flight to the next in a log, from it on."""
        if self._recent and now_s < self._recent[-1][0] - WINDOW_S:
            self._recent.clear()
            self._bits = 0
        bits = most_bits(len(frame.data))
        self._recent.append((now_s, bits))
        self._bits += bits
        self.pass_time(now_s)

    def pass_time(self, now_s: float) -> None:
        """Forget what is older than the window."""
        while self._recent and self._recent[0][0] < now_s - WINDOW_S:
            self._bits -= self._recent.popleft()[1]

    @property
    def frames_per_s(self) -> float:
        """Over the last seconds."""
        return len(self._recent) / WINDOW_S

    @property
    def part(self) -> float:
        """At most so much of ``BITRATE``; above 1 where frames came faster than such a bus carries them."""
        return self._bits / WINDOW_S / BITRATE
