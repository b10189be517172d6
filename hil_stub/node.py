"""What all boards share: the count of ticks, the boot message and the heartbeat."""

from typing import Final

from fsw.wire.frame import Frame
from fsw.wire.messages import (
    CoilBoot,
    CoilHeartbeat,
    MagBoot,
    MagHeartbeat,
    SunBoot,
    SunHeartbeat,
    WheelBoot,
    WheelHeartbeat,
)

CONTRACT_VERSION: Final = 1
"""Version of the bus contract, as in the first line of the DBC."""

HEARTBEAT_S: Final = 60
_MOST: Final = 0xFFFF

BootMessage = type[CoilBoot] | type[MagBoot] | type[SunBoot] | type[WheelBoot]
HeartbeatMessage = type[CoilHeartbeat] | type[MagHeartbeat] | type[SunHeartbeat] | type[WheelHeartbeat]


class Node:
    """Tick, boot message and heartbeat of one board.

    Ticks only advance: one that does not is ignored. Ticks that were skipped are counted as slips.

    Args:
        boot: message sent once after boot.
        heartbeat: message sent every 60 s after boot.
        tick_hz: ticks a second.
        table_crc: CRC-32 of the board's table.

    Raises:
        ValueError: tick_hz is not a positive integer.
    """

    def __init__(
        self, boot: BootMessage, heartbeat: HeartbeatMessage, tick_hz: int, table_crc: int = 0
    ) -> None:
        if type(tick_hz) is not int or tick_hz < 1:
            raise ValueError(f"tick_hz must be a positive integer, not {tick_hz!r}")
        self._boot = boot
        self._heartbeat = heartbeat
        self._period = HEARTBEAT_S * tick_hz
        self._table_crc = table_crc
        self._since_boot = 0
        self._periods = 0
        self._beats = 0
        self._slips = 0
        self.tick: int | None = None
        """The tick that the board is in; None before the first."""

    def advance(self, tick: int) -> int | None:
        """Go on to ``tick``: ticks since the last one (0 at the first), None when it does not advance."""
        if self.tick is None:
            self.tick = tick
            return 0
        elapsed = tick - self.tick
        if elapsed < 1:
            return None
        self.tick = tick
        self._since_boot += elapsed
        self._slips += elapsed - 1
        return elapsed

    def boot(self) -> list[Frame]:
        """The boot message, in the first tick only."""
        if self.tick is None or self._since_boot:
            return []
        return [self._boot(reason=0, version=CONTRACT_VERSION, table_crc=self._table_crc).encode()]

    def heartbeat(self, state: int = 0, rejects: int = 0) -> list[Frame]:
        """The heartbeat, when it is due: every 60 s of ticks after boot, late if ticks were skipped.

        Args:
            state: state of the node, four bits.
            rejects: frames rejected since boot.
        """
        if self.tick is None:
            return []
        periods = self._since_boot // self._period
        if periods == self._periods:
            return []
        self._periods = periods
        beat = self._heartbeat(
            state=state,
            rejects=min(rejects, _MOST),
            slips=min(self._slips, _MOST),
            tick=self.tick,
            counter=self._beats,
        )
        self._beats += 1
        return [beat.encode()]
