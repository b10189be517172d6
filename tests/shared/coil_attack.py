"""An attacker on the bus of a coil board, and a judge who sees nothing but its pins and the true time.

The attacker knows the specification: it follows which tick the board is in, and aims its requests at the very
millisecond in which a back-off ends. It holds, repeats, rushes, forges and loses SYNC and TICK_DONE, lets two
masters pace the bus at once, restarts the board, and leaves the bus alone, in any order.
"""

from collections import Counter
from dataclasses import dataclass, field
from random import Random
from typing import NamedTuple, Protocol

from fsw.wire.frame import Frame
from fsw.wire.messages import CoilFire, PlantBoot, PlantEnd, Sync, TickDone


class Setup(NamedTuple):
    """What the board under attack is set to."""

    tick_hz: int
    pulse_ms: int
    backoff_ms: int
    shared: bool
    deadman_ms: int

    @property
    def period_ms(self):
        return 1000 // self.tick_hz


class Target(Protocol):
    """The board under attack."""

    def now_ms(self) -> int:
        """The true time."""

    def send(self, frame: Frame) -> None:
        """A frame on its bus."""

    def wait(self, milliseconds: int) -> None:
        """Time passes."""

    def restart(self) -> None:
        """Its power goes off and on."""

    def off_at_ms(self) -> int | None:
        """When the pin that was on last went off, or will; None: none has been on."""


@dataclass
class Judge:
    """Invariant I, by the current over true time.

    It is shown the pins at some instants that rise, and says only what these prove: a pulse was on at the
    first and last instant at which it was seen, and everything between two sights may be to its favour.
    """

    setup: Setup
    violations: list[str] = field(default_factory=list)
    pulses: int = 0
    longest_ms: int = 0
    least_gap_ms: int | None = None
    _on: tuple[int, int] | None = None
    _since_ms: int = 0
    seen_ms: int = 0  # last sight of the pulse that is on
    _ended_ms: dict[int, int] = field(default_factory=dict)

    def see(self, now_ms: int, on: tuple[int, int] | None) -> None:
        """``on``: the coil whose pin is on at this instant, and its level."""
        if self._on is not None:
            if on == self._on:
                self.seen_ms = now_ms
                self.longest_ms = max(self.longest_ms, now_ms - self._since_ms + 1)
                if now_ms - self._since_ms >= self.setup.pulse_ms:
                    self._tell(now_ms, f"coil {on[0]} is on for more than {self.setup.pulse_ms} ms")
                return
            self._ended_ms[self._on[0]] = min(self.seen_ms + 1, now_ms)
        if on is not None and on != self._on:
            self._begin(now_ms, *on)
        self._on = on

    def _begin(self, now_ms: int, coil: int, level: int) -> None:
        self.pulses += 1
        self._since_ms = self.seen_ms = now_ms
        if coil not in range(3) or abs(level) not in range(1, 4):
            self._tell(now_ms, f"level {level} on coil {coil}")
        before = [end for other, end in self._ended_ms.items() if self.setup.shared or other == coil]
        if before:
            gap_ms = now_ms - max(before)
            self.least_gap_ms = gap_ms if self.least_gap_ms is None else min(gap_ms, self.least_gap_ms)
            if gap_ms < self.setup.backoff_ms:
                self._tell(now_ms, f"coil {coil} goes on {gap_ms} ms after the end of a pulse")

    def _tell(self, now_ms: int, what: str) -> None:
        self.violations.append(f"at {now_ms} ms: {what}")


class Attacker:
    """Does one random thing after another to a board."""

    def __init__(self, target: Target, setup: Setup, random: Random) -> None:
        self.target = target
        self.setup = setup
        self.random = random
        self.requests = 0
        self.done = Counter()
        self.tick = 0  # that the board is in, as far as can be known
        self._strange: int | None = None
        self._seq = 0
        self._moves = (
            self.orderly,
            self.orderly,
            self.hold,
            self.hold_and_rush,
            self.rush,
            self.backwards,
            self.lose,
            self.forge,
            self.reboot,
            self.two_masters,
            self.aim,
            self.aim,
            self.aim,
            self.aim_in_a_held_tick,
            self.no_bus,
        )

    def move(self) -> None:
        """One of them, by chance."""
        chosen = self.random.choice(self._moves)
        self.done[chosen.__name__] += 1
        chosen()

    def sync(self, tick: int) -> None:
        strange, self._strange = self._strange, None
        if tick in (self.tick, self.tick + 1) or (strange is not None and tick in (strange, strange + 1)):
            self.tick = tick
        else:
            self._strange = tick
        self.target.send(Sync(tick & 0xFFFF_FFFF, 0).encode())

    def answer(self, tick: int) -> None:
        """TICK_DONE."""
        self.tick += tick == self.tick
        self.target.send(TickDone(tick & 0xFFFF_FFFF, self.random.getrandbits(32)).encode())

    def fire(self) -> None:
        """A request: most are good."""
        random, limit_ms = self.random, self.setup.pulse_ms
        self._seq = self._seq + 1 & 0xFF
        self.requests += 1
        asked = CoilFire(
            random.choice((-3, -2, -1, 1, 2, 3)),
            random.randrange(3),
            self._seq,
            self.tick & 0xFF,
            random.choice((limit_ms, limit_ms, 1, random.randint(1, limit_ms))),
        )
        if random.random() < 0.1:
            asked = random.choice(
                (
                    asked.replace(level=random.choice((0, 4, -4, -8, 7))),
                    asked.replace(coil=3),
                    asked.replace(duration_ms=random.choice((0, limit_ms + 1, 65_535))),
                    asked.replace(tick=asked.tick + random.choice((-1, 1, 7)) & 0xFF),
                    asked.replace(seq=asked.seq - 1 & 0xFF),
                )
            )
        self.target.send(asked.encode())

    def maybe_fire(self, part: float = 0.4) -> None:
        while self.random.random() < part:
            self.fire()

    def orderly(self) -> None:
        """Ticks in time, with some jitter."""
        period = self.setup.period_ms
        for _ in range(self.random.randint(1, 20)):
            self.sync(self.tick)
            self.maybe_fire()
            self.answer(self.tick)
            self.target.wait(self.random.randint(period // 2, period + period // 2))

    def hold(self) -> None:
        """One SYNC again and again."""
        left_ms = self.random.randint(1, 2 * self.setup.deadman_ms)
        while left_ms > 0:
            self.sync(self.tick)
            self.maybe_fire()
            step_ms = self.random.randint(1, max(1, self.setup.deadman_ms // 2))
            self.target.wait(step_ms)
            left_ms -= step_ms

    def rush(self) -> None:
        """As many ticks as a back-off has, in no time."""
        cycle = (self.setup.pulse_ms + self.setup.backoff_ms) // self.setup.period_ms + 3
        for _ in range(self.random.choice((3, cycle, cycle))):
            if self.random.random() < 0.8:
                self.sync(self.tick)
            self.answer(self.tick)
            self.maybe_fire(0.02)
            self.target.wait(self.random.random() < 0.05)
        self.fire()

    def hold_and_rush(self) -> None:
        """A request just before the dead-man of a held tick wakes, then ticks in a rush."""
        self.sync(self.tick)
        self.answer(self.tick)
        self.sync(self.tick)
        self.target.wait(self.setup.deadman_ms - self.random.randint(0, 3))
        self.fire()
        self.rush()

    def backwards(self) -> None:
        """Ticks that fall, one alone, several that lead nowhere, or two that are believed."""
        first = self.random.randint(0, max(0, self.tick - 2))
        for off in self.random.choice(((0,), (0, 7, 3), (0, 0), (0, 1), (1, 0))):
            self.sync(first + off)
            self.maybe_fire()

    def lose(self) -> None:
        """SYNC lost: answers alone."""
        for _ in range(self.random.randint(1, 10)):
            self.answer(self.tick)
            self.maybe_fire()
            self.target.wait(self.random.randint(0, self.setup.period_ms))

    def forge(self) -> None:
        """A SYNC out of nothing, or two; an answer that fsw never gave; an end of the run."""
        tick = self.random.choice((self.random.getrandbits(32), self.tick + 50, 10**9))
        for off in self.random.choice(((0,), (0, 0), (0, 1), (0, 2))):
            self.sync(min(tick + off, 2**32 - 1))
            self.maybe_fire()
        self.answer(self.tick + self.random.choice((0, 0, 1, 100)))
        self.target.send(PlantEnd(self.random.choice((self.tick, self.random.getrandbits(24)))).encode())

    def reboot(self) -> None:
        """By power, or by the plant's boot message; at once again, sometimes."""
        for _ in range(self.random.choice((1, 1, 3))):
            if self.random.random() < 0.5:
                self.target.restart()
                self.tick, self._strange = 0, None
            else:
                if self.tick > 0:
                    self.tick, self._strange = 0, None
                self.target.send(PlantBoot(0, 1, 0).encode())
            self.maybe_fire()

    def two_masters(self) -> None:
        """Two that pace the bus, each with its own count."""
        other = self.random.getrandbits(31)
        for _ in range(self.random.randint(2, 12)):
            self.sync(self.tick)
            self.maybe_fire(0.2)
            self.sync(other)
            self.maybe_fire(0.2)
            self.answer(self.random.choice((self.tick, other)))
            other += 1
            self.target.wait(self.random.randint(0, self.setup.period_ms))

    def aim(self) -> None:
        """Good ticks in time until a back-off ends; requests all around that instant."""
        self._wait_for_the_end(self.setup.period_ms)
        for _ in range(self.random.randint(1, 4)):
            self.fire()
            self.target.wait(1)

    def aim_in_a_held_tick(self) -> None:
        """The same, but ticks come too fast, and the last of them is held when the back-off ends."""
        self._wait_for_the_end(max(1, self.setup.period_ms // 3))
        for _ in range(self.random.randint(1, 4)):
            self.fire()
            self.target.wait(1)

    def _wait_for_the_end(self, period_ms: int) -> None:
        """Until a few ms before a back-off is over: since the end of a pulse, or since now if it was none."""
        off_ms, now_ms = self.target.off_at_ms(), self.target.now_ms()
        end_ms = (now_ms if off_ms is None else off_ms) + self.setup.backoff_ms - self.random.randint(0, 2)
        if end_ms <= now_ms:  # a restart or the dead-man has begun another back-off, which is not seen
            end_ms = now_ms + self.setup.backoff_ms
        while (left_ms := end_ms - self.target.now_ms()) > 0:
            self.sync(self.tick)
            self.maybe_fire(0.02)
            self.answer(self.tick)
            self.sync(self.tick)
            self.target.wait(min(left_ms, period_ms))

    def no_bus(self) -> None:
        """Nothing, for long."""
        longest_ms = self.random.choice((self.setup.pulse_ms, self.setup.deadman_ms, self.setup.backoff_ms))
        self.target.wait(self.random.randint(1, 2 * longest_ms))
        self.maybe_fire()


class SimulatedTarget:
    """A bench in simulated time. The judge looks at its pin at each event and around the ends of pulses."""

    def __init__(self, setup, judge, bench):
        self._setup, self._judge, self._bench = setup, judge, bench
        self._now_ms = 0
        self._on_ms = self._off_ms = None
        self._last = None
        self.restart()

    def now_ms(self):
        return self._now_ms

    def off_at_ms(self):
        return self._off_ms

    def send(self, frame):
        self._bench.receive(frame, self._now_ms)
        self._look()

    def restart(self):
        self._bench.switch_on(now_ms=self._now_ms)
        self._look()

    def wait(self, milliseconds):
        end_ms = self._now_ms + milliseconds
        while self._now_ms < end_ms:
            self._now_ms = min([end_ms, *(at for at in self._sights_ms() if at > self._now_ms)])
            self._bench.watch(self._now_ms)
            self._look()

    def _sights_ms(self):
        """When a pin that is on is worth a look: when its timer ends it, and when it must be off."""
        pin = self._bench.pin
        if pin is None:
            return ()
        over_ms = self._on_ms + self._setup.pulse_ms
        timer_ms = () if pin.until_ms is None else (pin.until_ms - 1, pin.until_ms)
        return (*timer_ms, over_ms - 1, over_ms)

    def _look(self):
        pin = self._bench.pin
        on = None if pin is None else (pin.coil, pin.level)
        if on is not None and self._last is None:
            self._on_ms = self._now_ms
        if on is not None:
            self._off_ms = pin.until_ms
        elif self._last is not None:
            self._off_ms = self._now_ms
        self._last = on
        self._judge.see(self._now_ms, on)


def attack(setup, bench, requests, seed, enough=lambda judge: False):
    """Attack a bench in simulated time until so many requests have been made: attacker and judge."""
    judge = Judge(setup)
    attacker = Attacker(SimulatedTarget(setup, judge, bench), setup, Random(f"{seed}/{tuple(setup)}"))
    while attacker.requests < requests and not enough(judge):
        attacker.move()
    return attacker, judge


SETUPS = {
    "as it flies": Setup(1, 3000, 100_000, True, 5000),
    "per coil": Setup(1, 3000, 100_000, False, 5000),
    "fast": Setup(10, 300, 2000, True, 500),
    "fast, per coil": Setup(10, 300, 2000, False, 500),
    "pulses that are no whole ticks": Setup(8, 437, 1999, True, 700),
    "ticks longer than a pulse": Setup(2, 333, 1111, False, 1700),
    "no dead-man to speak of": Setup(4, 1000, 3000, True, 3_600_000),
    "a dead-man quicker than a pulse": Setup(20, 900, 1500, True, 300),
}
