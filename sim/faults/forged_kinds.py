"""Forged messages that control a flight: the plant's SYNC and PLANT_END, and TICK_DONE of fsw."""

from fsw.wire.frame import Frame
from fsw.wire.messages import PlantEnd, Sync, TickDone
from sim.faults.fault import Fault

MOST_TICKS = 2**24
LAST_TICK = 2**32 - 1
NEAR_TICKS = 10_000
"""Counts nearer to the true one than this may fit ticks that were lost."""


class ForgedSync(Fault):
    """``count`` forged SYNCs precede the true one, in each tick with probability ``part``.

    The first is ``ticks`` from the true one, or random if ``ticks`` is 0; each further one is ``step`` later.
    """

    def strangers(self, tick: int) -> list[Frame]:
        """The forged SYNCs."""
        rng, parameters = self.rng, self.parameters
        if rng.random() >= parameters["part"]:
            return []
        off, step = round(parameters["ticks"]), round(parameters["step"])
        first = max(0, tick + off) if off else rng.randrange(LAST_TICK - 10)
        return [Sync(first + step * i, first & 0xFFFF).encode() for i in range(round(parameters["count"]))]


class ForgedEnd(Fault):
    """A PLANT_END in each tick, with any count except those that may be true."""

    def strangers(self, tick: int) -> list[Frame]:
        """The forged PLANT_END."""
        ticks = (tick + self.rng.randrange(NEAR_TICKS, MOST_TICKS - NEAR_TICKS)) % MOST_TICKS
        return [PlantEnd(ticks, counter=tick & 0xF).encode()]


class ForgedTickDone(Fault):
    """TICK_DONE of this tick under the identifier of fsw, in each tick with probability ``part``."""

    def strangers(self, tick: int) -> list[Frame]:
        """The forged TICK_DONE."""
        if self.rng.random() >= self.parameters["part"]:
            return []
        return [TickDone(tick, self.rng.getrandbits(32)).encode()]
