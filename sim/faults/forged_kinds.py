"""Strangers who forge what steers a flight: the plant's SYNC and PLANT_END, and TICK_DONE of fsw."""

from fsw.wire.frame import Frame
from fsw.wire.messages import PlantEnd, Sync, TickDone
from sim.faults.fault import Fault

MOST_TICKS = 2**24
LAST_TICK = 2**32 - 1


class SyncForged(Fault):
    """Before SYNC come ``count`` forged ones, in each tick with probability ``part``.

    The first is ``ticks`` from the true one, or any where ``ticks`` is 0; each further one ``step`` later.
    """

    def strangers(self, tick: int) -> list[Frame]:
        """SYNCs of nobody's."""
        rng, parameters = self.rng, self.parameters
        if rng.random() >= parameters["part"]:
            return []
        off, step = round(parameters["ticks"]), round(parameters["step"])
        first = max(0, tick + off) if off else rng.randrange(LAST_TICK - 10)
        return [Sync(first + step * i, first & 0xFFFF).encode() for i in range(round(parameters["count"]))]


class EndForged(Fault):
    """A PLANT_END of any count but those that may be true, in each tick."""

    def strangers(self, tick: int) -> list[Frame]:
        """An end that is none."""
        ticks = (tick + self.rng.randrange(100, MOST_TICKS - 100)) % MOST_TICKS
        return [PlantEnd(ticks, counter=tick & 0xF).encode()]


class DoneForged(Fault):
    """TICK_DONE of this tick under the identifier of fsw, in each tick with probability ``part``."""

    def strangers(self, tick: int) -> list[Frame]:
        """An answer that fsw has not given."""
        if self.rng.random() >= self.parameters["part"]:
            return []
        return [TickDone(tick, self.rng.getrandbits(32)).encode()]
