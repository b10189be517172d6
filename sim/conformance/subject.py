"""A coil driver board under test: what the checks do to it again and again, and demand of it each time."""

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil

from fsw.wire.frame import Frame
from fsw.wire.messages import CoilFire, CoilRefusedReason, CoilStatus
from sim.conformance.session import BrokenError, Heard, Session

LATE_TICKS = 3
"""Ticks by which a request that may be accepted again may be later than the earliest."""
SLACK_S, DRIFT = 0.02, 1e-4
"""What is allowed to the way to the board, and to its clock."""


@dataclass(frozen=True, slots=True)
class Limits:
    """What the board is set to."""

    pulse_ms: int = 3000
    backoff_ms: int = 100_000
    shared: bool = True
    deadman_s: float = 5.0


class Subject:
    """The board under test, with what the checks do to it again and again."""

    def __init__(self, session: Session, limits: Limits) -> None:
        self.session = session
        self.limits = limits
        self.tick_ms = 1000.0 / session.tick_hz
        self._seq = 0
        self._sent = 0
        self.accepted_seq = 0

    def fire(self, **changes: int) -> CoilFire:
        """A good request that answers this tick, but for ``changes``."""
        self._seq = self._seq + 1 & 0xFF
        self._sent += 1
        asked = CoilFire(
            level=-2,
            coil=1,
            seq=self._seq,
            tick=self.session.tick & 0xFF,
            duration_ms=self.limits.pulse_ms,
            counter=self._sent,
        )
        return asked._replace(**changes)

    def ask(self, asked: CoilFire) -> Heard:
        """A tick with one request in it."""
        return self.session.step(asked.encode())

    def refuse(self, asked: CoilFire, reason: CoilRefusedReason, frame: Frame | None = None) -> Heard:
        """A request (as ``frame``, if that is given) that must be refused for that reason and no other."""
        heard = self.session.step(asked.encode() if frame is None else frame)
        told = [(refused.reason, refused.seq, refused.coil, refused.tick) for refused in heard.refused]
        expected = (int(reason), asked.seq, asked.coil, self.session.tick - 1 & 0xFF)
        if told != [expected]:
            raise BrokenError(
                f"a request to be refused as {reason.name.lower()} in tick {heard.tick - 1}: "
                f"COIL_REFUSED told {reasons(heard)}, (reason, seq, coil, tick) {told} and not {expected}"
            )
        return heard

    def off(self, heard: Heard) -> CoilStatus:
        """The status of a tick in which nothing may have been driven."""
        status = heard.status
        if status.level or status.remaining_ms:
            raise BrokenError(f"driven in tick {heard.tick} ({status})")
        if status.coil != heard.tick % 3:
            raise BrokenError(f"coil {status.coil} in tick {heard.tick} while all are off, not tick modulo 3")
        return status

    def locked_out(self, heard: Heard, since_ticks: int = 0) -> None:
        """A full lockout, told in the tick that is so many ticks after its beginning."""
        told_ms = self.off(heard).lockout_ms
        least_ms = self.limits.backoff_ms - (since_ticks + 0.5) * self.tick_ms
        if not least_ms <= told_ms <= self.limits.backoff_ms + self.tick_ms:
            raise BrokenError(
                f"lockout_ms is {told_ms} in tick {heard.tick}: not the full {self.limits.backoff_ms}"
            )

    def free(self) -> None:
        """Ticks without requests until no coil is locked out."""
        most = self.limits.pulse_ms + self.limits.backoff_ms
        free = 0
        for _ in range(ceil(most / self.tick_ms) + 2 * LATE_TICKS):
            status = self.session.step().status
            free = free + 1 if status.lockout_ms == status.level == 0 else 0
            if free == 3:
                return
        raise BrokenError(f"still locked out after {most / 1000.0:g} s without a request")

    def accept(self, **changes: int) -> tuple[CoilFire, Heard]:
        """A request that must be accepted: what was asked, and the first tick of it."""
        asked = self.fire(**changes)
        heard = self.ask(asked)
        if heard.refused or heard.status.level == 0:
            raise BrokenError(f"a good request in tick {heard.tick - 1} was refused: {reasons(heard)}")
        self.accepted_seq = asked.seq
        return asked, heard

    def pulse(self, asked: CoilFire, heard: Heard, meanwhile: Callable[[], Heard] | None = None) -> None:
        """Follow an accepted request to its end: coil, level, seq, remaining time, current, length."""
        ticks = ceil(asked.duration_ms / self.tick_ms)
        currents: list[int] = []
        for number in range(1, ticks + 3):
            status = heard.status
            left_ms = asked.duration_ms - number * self.tick_ms
            if number <= ticks and (status.coil, status.level, status.seq) != (
                asked.coil,
                asked.level,
                asked.seq,
            ):
                raise BrokenError(f"{asked} asked for, and in tick {heard.tick}: {status}")
            if status.remaining_ms > max(0.0, ceil(left_ms)):
                raise BrokenError(f"remaining_ms is {status.remaining_ms} in tick {heard.tick}: too long")
            if status.remaining_ms < min(left_ms - self.tick_ms, asked.duration_ms):
                raise BrokenError(f"remaining_ms is {status.remaining_ms} in tick {heard.tick}: too short")
            if status.remaining_ms:
                currents.append(status.current_ma)
            heard = meanwhile() if meanwhile and number == 1 else self.session.step()
        if heard.status.level:
            raise BrokenError(f"a pulse of {asked.duration_ms} ms is told for more than {ticks} ticks")
        sign = 1 if asked.level > 0 else -1
        if not all(current * sign > 0 for current in currents):
            raise BrokenError(f"current_ma was {currents} in a pulse at level {asked.level}")
        if currents and abs(heard.status.current_ma) * 5 > max(map(abs, currents)):
            raise BrokenError(f"current_ma is {heard.status.current_ma} after the end of the pulse")

    def wait_for_next(self, since_s: float) -> None:
        """Ask on and on; accepted no sooner than a back-off after ``since_s``, and soon after that.

        The pulse that comes of it is followed to its end.
        """
        end_s = since_s + self.limits.backoff_ms / 1000.0
        period_s = self.session.period_s
        while True:
            left_s = end_s - self.session.due_s()
            near = left_s < 6 * period_s
            asked = self.fire(coil=1)
            heard = self.ask(asked)
            if not heard.refused:
                break
            if heard.refused[0].reason != CoilRefusedReason.LOCKOUT:
                raise BrokenError(f"refused as {reasons(heard)} in a back-off")
            if left_s < -(LATE_TICKS + 1) * period_s:
                raise BrokenError(f"refused as lockout {-left_s:.1f} s after the end of the back-off")
            for _ in range(0 if near else int(left_s / period_s / 4.0)):
                self.off(self.session.step())
        self.accepted_seq = asked.seq
        early_s = end_s - heard.at_s
        if early_s > SLACK_S + DRIFT * (end_s - since_s):
            raise BrokenError(f"accepted {early_s:.3f} s before the end of the back-off")
        if heard.status.level == 0:
            raise BrokenError("a request is neither driven nor refused")
        self.pulse(asked, heard)


def reasons(heard: Heard) -> str:
    """The reasons of the refusals that were heard, for people."""
    names = {int(reason): reason.name.lower() for reason in CoilRefusedReason}
    return ", ".join(names.get(refused.reason, str(refused.reason)) for refused in heard.refused) or "nothing"
