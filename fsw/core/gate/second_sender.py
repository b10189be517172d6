"""Whether another node sends in fsw's place.

fsw does not receive its own frames. An intact frame under one of its own identifiers, and the refusal of a
request that it never made, are signs of a second sender. One alone may be a frame of an earlier boot that was
still on its way, or noise with the right CRC: several in quick succession reveal one.
"""

from typing import NamedTuple

from fsw.core.gate.measurements import Measurements, Refusal
from fsw.wire.messages import CoilDipole, CoilFire, CoilRefusedReason

SIGNS = 3
"""Ticks with a sign that make a second sender detected."""

REQUESTS = frozenset({CoilFire.ID, CoilDipole.ID})


class SecondSenderConfig(NamedTuple):
    """How far apart a sign and the one before may be to count together.

    ``request_ticks`` for requests, of which there may be one per back-off; ``other_ticks`` for whatever else
    fsw sends, some of it in each tick. Without a sign for ``request_ticks`` the second sender is gone.
    """

    request_ticks: int
    other_ticks: int


class SecondSenderWatch(NamedTuple):
    """Ticks with a sign, ``SIGNS`` at most; the last of them, and the identifier of the frame."""

    signs: int = 0
    tick: int = -1
    can_id: int = 0

    @property
    def detected(self) -> bool:
        """Whether there are enough signs."""
        return self.signs >= SIGNS


NO_SIGNS = SecondSenderWatch()


def watch(
    before: SecondSenderWatch,
    measurements: Measurements,
    seq: int,
    pulsed: bool,
    tick: int,
    config: SecondSenderConfig,
) -> SecondSenderWatch:
    """The watch after this tick.

    Args:
        before: the watch before it.
        measurements: of this tick.
        seq: number of the request that the coil driver accepted last; fsw's own has this or the next.
        pulsed: whether the coil driver is pulsed: its refusals then carry request numbers.
        tick: this one.
        config: the limits.
    """
    can_id = measurements.under_own_id
    if not can_id and measurements.refused is not None and pulsed and _of_another(measurements.refused, seq):
        can_id = CoilFire.ID
    if not can_id:
        return NO_SIGNS if before.signs and tick - before.tick > config.request_ticks else before
    apart = config.request_ticks if can_id in REQUESTS or before.detected else config.other_ticks
    signs = before.signs if before.signs and tick - before.tick <= apart else 0
    return SecondSenderWatch(min(signs + 1, SIGNS), tick, can_id)


def _of_another(refused: Refusal, seq: int) -> bool:
    """Whether the refused request is not fsw's; a malformed one may carry any number."""
    return refused.reason != CoilRefusedReason.MALFORMED and (refused.seq - seq) & 0xFF > 1
