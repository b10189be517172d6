"""Whether another node sends in fsw's place.

fsw does not receive its own frames. An intact frame under one of its own identifiers, and the refusal of a
request that it never made, are signs of a second sender. One alone may be a frame of an earlier boot that was
still on its way, or noise with the right CRC: several in quick succession reveal one.
"""

from dataclasses import dataclass
from typing import Final, final

from fsw.core.gate.measurements import Measurements, Refusal
from fsw.wire.messages import CoilDipole, CoilFire, CoilRefusedReason

SIGNS: Final = 3
"""Ticks with a sign that make a second sender detected."""

REQUESTS = frozenset({CoilFire.ID, CoilDipole.ID})


@dataclass(frozen=True, slots=True)
class SecondSenderConfig:
    """How far apart a sign and the one before may be to count together.

    ``request_ticks`` for requests, of which there may be one per back-off; ``other_ticks`` for whatever else
    fsw sends, some of it in each tick. Without a sign for ``request_ticks`` the second sender is gone.
    """

    request_ticks: int
    other_ticks: int


@final
@dataclass(slots=True)
class SecondSenderWatch:
    """Ticks with a sign, ``SIGNS`` at most; the last of them, and the identifier of the frame."""

    signs: int = 0
    tick: int = -1
    can_id: int = 0

    @property
    def detected(self) -> bool:
        """Whether there are enough signs."""
        return self.signs >= SIGNS


def watch_senders(
    watch: SecondSenderWatch,
    measurements: Measurements,
    seq: int,
    pulsed: bool,
    tick: int,
    config: SecondSenderConfig,
) -> None:
    """Note a sign of this tick; without one for long enough, forget those before.

    Args:
        watch: signs before this tick.
        measurements: of this tick.
        seq: number of the request that the coil driver accepted last; fsw's own has this or the next.
        pulsed: whether the coil driver is pulsed: its refusals then carry request numbers.
        tick: this one.
        config: the limits.
    """
    can_id, elapsed = measurements.under_own_id, tick - watch.tick
    if not can_id and pulsed and any([_of_another(refused, seq) for refused in measurements.refused]):
        can_id = CoilFire.ID
    if can_id:
        apart = config.request_ticks if can_id in REQUESTS or watch.detected else config.other_ticks
        watch.signs = min(watch.signs + 1, SIGNS) if elapsed <= apart else 1
        watch.tick, watch.can_id = tick, can_id
    elif watch.signs and elapsed > config.request_ticks:
        watch.signs, watch.tick, watch.can_id = 0, -1, 0


def _of_another(refused: Refusal, seq: int) -> bool:
    """Whether the refused request is not fsw's; a malformed one may carry any number."""
    return refused.reason != CoilRefusedReason.MALFORMED and (refused.seq - seq) & 0xFF > 1
