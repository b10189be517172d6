"""Schedulers as users might write them, with one fault each.

``tools/planted.py`` measures on them, and on correct ones, what ``sim.testing`` finds.
"""

from collections.abc import Sequence
from math import ceil

import numpy as np
from correct_schedulers import Timers

from sim.testing import Fire, Heard, Limits
from sim.value_types import Vec3


class _EveryNth(Timers):
    n: int

    def pulse_ticks(self, coil: int) -> int:
        return self.pulse + (self.fired % self.n == 0)


class EveryThird(_EveryNth):
    """every 3rd pulse a tick too long"""

    n = 3


class EveryNinth(_EveryNth):
    """every 9th pulse a tick too long"""

    n = 9


class EveryFiveHundredth(_EveryNth):
    """every 500th pulse a tick too long"""

    n = 500


class TwoOnEqual(Timers):
    """two coils on demands of equal size"""

    def fires(self, coil: int, demand: Vec3) -> list[int]:
        return [one for one in range(3) if abs(demand[one]) == abs(demand[coil])]


class TwoOnEqualValues(Timers):
    """two coils on demands of equal value"""

    def fires(self, coil: int, demand: Vec3) -> list[int]:
        return [one for one in range(3) if demand[one] == demand[coil]]


class BelowCoilZero(Timers):
    """coil -1 where two demands are equal in size"""

    def fires(self, coil: int, demand: Vec3) -> list[int]:
        return [coil if sum(abs(m) == abs(demand[coil]) for m in demand) == 1 else -1]


class AboveCoilTwo(Timers):
    """coil 3 where all demands are equal in size"""

    def fires(self, coil: int, demand: Vec3) -> list[int]:
        return [coil if len({abs(m) for m in demand}) > 1 else 3]


class LevelFour(Timers):
    """level 4 for a demand beyond full scale"""

    def level(self, m_am2: float) -> int:
        level = min(4, ceil(abs(m_am2) / 8.0 * 3))
        return level if m_am2 > 0.0 else -level


class LevelZero(Timers):
    """level 0 on a small demand"""

    def level(self, m_am2: float) -> int:
        return max(-3, min(3, round(m_am2 / 8.0 * 3)))


class ShortAfterNegative(Timers):
    """back-off a tick short after a negative pulse"""

    def backoff_ticks(self, level: int) -> int:
        return self.backoff - (level < 0)


class FromTheStart(Timers):
    """back-off counted from the start of the pulse"""

    def backoff_ticks(self, level: int) -> int:
        return self.backoff - self.pulse


class ShortAfterLost(Timers):
    """no back-off after a pulse that no status shows"""

    last_request_tick: int | None = None

    def step(self, heard: Heard) -> Sequence[Fire]:
        status = heard.status
        if self.last_request_tick == heard.tick - 1 and not (status is not None and status.level):
            self.ready, self.busy_until = [heard.tick] * 3, heard.tick
        requests = super().step(heard)
        if requests:
            self.last_request_tick = heard.tick
        return requests


class ShortAfterTwoLost(Timers):
    """half a back-off once two requests in a row were lost"""

    last_request_tick: int | None = None
    lost = 0

    def step(self, heard: Heard) -> Sequence[Fire]:
        if self.last_request_tick == heard.tick - 1 and heard.status is not None:
            self.lost = 0 if heard.status.level else self.lost + 1
        requests = super().step(heard)
        if requests:
            self.last_request_tick = heard.tick
        return requests

    def backoff_ticks(self, level: int) -> int:
        return self.backoff // 2 if self.lost >= 2 else self.backoff


class ForgetsAtReboot(Timers):
    """fires at once after a boot of its own"""

    def boot_ticks(self) -> int:
        return 0


class ForgetsThePulse(Timers):
    """forgets at a boot that a pulse may be under way"""

    def boot_ticks(self) -> int:
        return self.backoff


class DeafToBoots(Timers):
    """ignores that the board has booted"""

    def step(self, heard: Heard) -> Sequence[Fire]:
        return super().step(heard._replace(booted=False))


class PerCoil(Timers):
    """back-off per coil where it is shared"""

    def locks(self, fired: int, coil: int) -> bool:
        return coil == fired


class PulseRoundedUp(Timers):
    """a pulse that is no whole number of ticks rounded up"""

    def __init__(self, limits: Limits) -> None:
        super().__init__(limits)
        self.pulse = ceil(limits.pulse_ms * limits.tick_hz / 1000)


class BackoffRoundedDown(Timers):
    """a back-off that is no whole number of ticks rounded down"""

    def __init__(self, limits: Limits) -> None:
        super().__init__(limits)
        self.backoff = limits.backoff_ms * limits.tick_hz // 1000


class WholeMilliseconds(Timers):
    """counts in ticks of whole milliseconds"""

    def __init__(self, limits: Limits) -> None:
        super().__init__(limits)
        self.backoff = ceil(limits.backoff_ms / ceil(1000 / limits.tick_hz))


class SixteenBits(Timers):
    """counts ticks in 16 bits, which overflow"""

    def step(self, heard: Heard) -> Sequence[Fire]:
        return super().step(heard._replace(tick=heard.tick & 0xFFFF))

    def free(self, coil: int, heard: Heard) -> bool:
        return heard.tick >= max(self.ready[coil], self.busy_until) & 0xFFFF


class ShortFloats(Timers):
    """keeps times in floats of 32 bits"""

    def free(self, coil: int, heard: Heard) -> bool:
        return bool(np.float32(heard.tick) >= np.float32(max(self.ready[coil], self.busy_until)))


class CountsInAByte(Timers):
    """counts pulses in a byte, without a back-off where the count is zero"""

    def backoff_ticks(self, level: int) -> int:
        return self.backoff if self.fired & 0xFF else 0


class SendsAgain(Timers):
    """sends a request again where the status after it is lost"""

    last: Sequence[Fire] = ()

    def step(self, heard: Heard) -> Sequence[Fire]:
        if heard.status is None and self.last:
            again, self.last = self.last, ()
            return again
        self.last = super().step(heard)
        return self.last


class SeesOneCoil(Timers):
    """ignores that another coil is on where the back-off is per coil"""

    def free(self, coil: int, heard: Heard) -> bool:
        return heard.tick >= self.ready[coil]


class Credit(Timers):
    """no back-off after a pulse that came after a long pause"""

    fired_at = 0

    def step(self, heard: Heard) -> Sequence[Fire]:
        requests = super().step(heard)
        if requests:
            if self.fired > 1 and heard.tick - self.fired_at > 3 * (self.pulse + self.backoff):
                self.ready = [self.busy_until] * 3
            self.fired_at = heard.tick
        return requests


class DurationRoundedUp(Timers):
    """a duration rounded up to whole milliseconds, and so past the tick it ends with"""

    def duration_ms(self, coil: int) -> int:
        return ceil(self.pulse * 1000 / self.limits.tick_hz)


class TickZero(Timers):
    """ignores a boot in tick 0"""

    def step(self, heard: Heard) -> Sequence[Fire]:
        if not self.ready and heard.tick == 0:
            self.ready, self.busy_until = [0] * 3, 0
            heard = heard._replace(booted=False)
        return super().step(heard)


class HearsBootsLate(Timers):
    """takes a boot of the board a tick late"""

    booted = False

    def step(self, heard: Heard) -> Sequence[Fire]:
        before, self.booted = self.booted, heard.booted
        return super().step(heard._replace(booted=before))


class NoNumber(Timers):
    """level 0 for a demand that is not a number"""

    def level(self, m_am2: float) -> int:
        return (m_am2 > 0.0) * 3 - (m_am2 < 0.0) * 3


PLANTED = (
    EveryThird,
    EveryNinth,
    EveryFiveHundredth,
    TwoOnEqual,
    TwoOnEqualValues,
    BelowCoilZero,
    AboveCoilTwo,
    LevelFour,
    LevelZero,
    ShortAfterNegative,
    FromTheStart,
    ShortAfterLost,
    ShortAfterTwoLost,
    ForgetsAtReboot,
    ForgetsThePulse,
    DeafToBoots,
    PerCoil,
    PulseRoundedUp,
    BackoffRoundedDown,
    WholeMilliseconds,
    SixteenBits,
    ShortFloats,
    CountsInAByte,
    SendsAgain,
    SeesOneCoil,
    Credit,
    DurationRoundedUp,
    TickZero,
    HearsBootsLate,
    NoNumber,
)
UNSOUND = frozenset({"NoNumber"})
"""Tested with demands that are not finite too."""
