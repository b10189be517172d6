"""The magnetometer board: the sensor's reading as frames."""

from typing import Final

from fsw.wire.frame import Frame
from fsw.wire.messages import MagBoot, MagField, MagHeartbeat
from hil_stub.node import Node

_NT_PER_T: Final = 1e9
_LOW_NT: Final = -65536.0
_HIGH_NT: Final = 65534.0
"""Range of the signals ``b_x``, ``b_y``, ``b_z``."""


class Magnetometer:
    """A three-axis magnetometer on the bus.

    Args:
        tick_hz: ticks a second.
    """

    def __init__(self, tick_hz: int) -> None:
        self._node = Node(MagBoot, MagHeartbeat, tick_hz)
        self._fields = 0

    def begin_tick(self, tick: int, b_body_t: tuple[float, float, float], valid: bool) -> list[Frame]:
        """Enter ``tick``: ``MAG_BOOT`` at the first, ``MAG_FIELD``, ``MAG_HEARTBEAT`` every 60 s.

        An axis that is out of range or not a number makes the sample invalid. A tick that does not advance is
        ignored.

        Args:
            tick: number of the tick that begins.
            b_body_t: field in body axes [T].
            valid: False when the sensor has failed its self-test.
        """
        if self._node.advance(tick) is None:
            return []
        x, y, z = b_body_t
        x, y, z = x * _NT_PER_T, y * _NT_PER_T, z * _NT_PER_T
        valid = valid and _in_range(x) and _in_range(y) and _in_range(z)
        sample = MagField(int(valid), x, y, z, counter=self._fields)
        self._fields += 1
        return [*self._node.boot(), sample.encode(), *self._node.heartbeat()]


def _in_range(axis_nt: float) -> bool:
    return _LOW_NT <= axis_nt <= _HIGH_NT
