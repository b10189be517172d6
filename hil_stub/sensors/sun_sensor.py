"""The Sun sensor board: the sensor's reading as frames."""

from typing import Final

from fsw.wire.frame import Frame
from fsw.wire.messages import SunBoot, SunHeartbeat, SunVector
from hil_stub.node import Node

_LOW: Final = -2.0
_HIGH: Final = 2.0 - 2.0**-14
"""Range of the signals ``s_x``, ``s_y``, ``s_z``."""

_DARK: tuple[float, float, float] = (0.0, 0.0, 0.0)


class SunSensor:
    """A Sun sensor on the bus.

    Args:
        tick_hz: ticks a second.
    """

    def __init__(self, tick_hz: int) -> None:
        self._node = Node(SunBoot, SunHeartbeat, tick_hz)
        self._vectors = 0

    def begin_tick(self, tick: int, sun_body: tuple[float, float, float], valid: bool) -> list[Frame]:
        """Enter ``tick``: ``SUN_BOOT`` at the first, ``SUN_VECTOR``, ``SUN_HEARTBEAT`` every 60 s.

        An invalid sample has no direction: its components are zero. A component out
        of range or not a number makes the sample invalid. A tick that does not advance is ignored.

        Args:
            tick: number of the tick that begins.
            sun_body: unit vector to the Sun in body axes.
            valid: False in eclipse, or when the Sun is out of view.
        """
        if self._node.advance(tick) is None:
            return []
        x, y, z = sun_body
        visible = valid and _in_range(x) and _in_range(y) and _in_range(z)
        if not visible:
            x, y, z = _DARK
        sample = SunVector(int(visible), x, y, z, counter=self._vectors)
        self._vectors += 1
        return [*self._node.boot(), sample.encode(), *self._node.heartbeat()]


def _in_range(component: float) -> bool:
    return _LOW <= component <= _HIGH
