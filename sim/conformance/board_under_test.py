"""A coil driver board under test: the steps and expectations that the checks share."""

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil

from fsw.wire.frame import Frame
from fsw.wire.messages import CoilFire, CoilRefusedReason, CoilStatus
from sim.conformance.board_link import BoardLink, NonconformanceError, TickReply

LATE_TICKS = 3
"""Ticks after the end of a back-off within which a request must be accepted."""
SLACK_S, DRIFT = 0.02, 1e-4
"""Tolerances: for the way to the board [s], and for the drift of its clock (relative)."""


@dataclass(frozen=True, slots=True)
class BoardLimits:
    """The limits that the board is set to."""

    pulse_ms: int = 3000
    backoff_ms: int = 100_000
    shared: bool = True
    deadman_s: float = 5.0


class BoardUnderTest:
    """The board under test, with the steps and expectations that the checks share."""

    def __init__(self, link: BoardLink, limits: BoardLimits) -> None:
        self.link = link
        self.limits = limits
        self.tick_ms = 1000.0 / link.tick_hz
        self._seq = 0
        self._sent = 0
        self.accepted_seq = 0
        self._accepted: tuple[CoilFire, TickReply] | None = None

    def request(self, **changes: int) -> CoilFire:
        """A proper request that answers this tick, except for ``changes``."""
        self._seq = self._seq + 1 & 0xFF
        self._sent += 1
        proper = {
            "level": -2,
            "coil": 1,
            "seq": self._seq,
            "tick": self.link.tick & 0xFF,
            "duration_ms": self.limits.pulse_ms,
            "counter": self._sent,
        }
        return CoilFire(**proper | changes)

    def send(self, request: CoilFire) -> TickReply:
        """A tick with one request in it."""
        return self.link.step(request.encode())

    def expect_refusal(
        self, request: CoilFire, reason: CoilRefusedReason, frame: Frame | None = None
    ) -> TickReply:
        """Send a request (as ``frame``, if given) that must be refused for that reason and no other."""
        reply = self.link.step(request.encode() if frame is None else frame)
        reported = [(refused.reason, refused.seq, refused.coil, refused.tick) for refused in reply.refused]
        expected = (int(reason), request.seq, request.coil, self.link.tick - 1 & 0xFF)
        if reported != [expected]:
            raise NonconformanceError(
                f"a request to be refused as {reason.name.lower()} in tick {reply.tick - 1}: "
                f"COIL_REFUSED reports {reasons(reply)}, "
                f"(reason, seq, coil, tick) {reported} and not {expected}"
            )
        return reply

    def expect_locked_out(self, since_s: float, **changes: int) -> None:
        """A request is refused, if it comes before the end of a back-off that began at ``since_s``."""
        if self.link.due_s() < since_s + self.limits.backoff_ms / 1000.0 - SLACK_S:
            self.expect_off(self.expect_refusal(self.request(**changes), CoilRefusedReason.LOCKOUT))

    def expect_off(self, reply: TickReply) -> CoilStatus:
        """The status of a tick in which nothing may have been driven."""
        status = reply.status
        if status.level or status.remaining_ms:
            raise NonconformanceError(f"driven in tick {reply.tick} ({status})")
        if status.coil != reply.tick % 3:
            raise NonconformanceError(
                f"coil {status.coil} in tick {reply.tick} while all are off, not tick modulo 3"
            )
        return status

    def expect_lockout(self, reply: TickReply, since_ticks: int = 0) -> None:
        """A full lockout that began ``since_ticks`` before this tick."""
        lockout_ms = self.expect_off(reply).lockout_ms
        least_ms = self.limits.backoff_ms - (since_ticks + 0.5) * self.tick_ms
        if not least_ms <= lockout_ms <= self.limits.backoff_ms + self.tick_ms:
            raise NonconformanceError(
                f"lockout_ms is {lockout_ms} in tick {reply.tick}: not the full {self.limits.backoff_ms}"
            )

    def wait_until_free(self) -> None:
        """Ticks without requests until no coil is locked out."""
        most = self.limits.pulse_ms + self.limits.backoff_ms
        free = 0
        for _ in range(ceil(most / self.tick_ms) + 2 * LATE_TICKS):
            status = self.link.step().status
            free = free + 1 if status.lockout_ms == status.level == 0 else 0
            if free == 3:
                return
        raise NonconformanceError(f"still locked out after {most / 1000.0:g} s without a request")

    def expect_accepted(self, **changes: int) -> tuple[CoilFire, TickReply]:
        """Send a request that must be accepted: the request, and the reply in the first tick of its pulse."""
        request = self.request(**changes)
        reply = self.send(request)
        if reply.refused or reply.status.level == 0:
            raise NonconformanceError(
                f"a proper request in tick {reply.tick - 1} was refused: {reasons(reply)}"
            )
        self._accept(request, reply)
        return request, reply

    def begin_pulse(self) -> tuple[CoilFire, TickReply]:
        """The pulse that began in the last tick, or one that begins once no coil is locked out.

        A back-off is long: a check goes on with the pulse that the one before it has left.
        """
        if self._accepted is None or self._accepted[1] is not self.link.replies[-1]:
            self.wait_until_free()
            return self.expect_accepted()
        return self._accepted

    def _accept(self, request: CoilFire, reply: TickReply) -> None:
        self.accepted_seq = request.seq
        self._accepted = request, reply

    def follow_pulse(
        self, request: CoilFire, reply: TickReply, meanwhile: Callable[[], TickReply] | None = None
    ) -> None:
        """Follow an accepted request to its end: coil, level, seq, remaining time, current, length."""
        ticks = ceil(request.duration_ms / self.tick_ms)
        from_s = reply.at_s
        currents: list[int] = []
        for number in range(1, ticks + 3):
            status = reply.status
            left_ms = request.duration_ms - number * self.tick_ms
            if number <= ticks:
                _expect_as_requested(request, reply)
            if status.remaining_ms > max(0.0, ceil(left_ms)):
                raise NonconformanceError(
                    f"remaining_ms is {status.remaining_ms} in tick {reply.tick}: too long"
                )
            least_ms = request.duration_ms - 1000.0 * (reply.at_s - from_s) - 2.0 * self.tick_ms
            if status.remaining_ms < least_ms:
                raise NonconformanceError(
                    f"remaining_ms is {status.remaining_ms} in tick {reply.tick}: too short"
                )
            if status.remaining_ms:
                currents.append(status.current_ma)
            reply = meanwhile() if meanwhile and number == 1 else self.link.step()
        if reply.status.level:
            raise NonconformanceError(
                f"a pulse of {request.duration_ms} ms is reported for more than {ticks} ticks"
            )
        sign = 1 if request.level > 0 else -1
        if not all(current * sign > 0 for current in currents):
            raise NonconformanceError(f"current_ma was {currents} in a pulse at level {request.level}")
        if currents and abs(reply.status.current_ma) * 5 > max(map(abs, currents)):
            raise NonconformanceError(f"current_ma is {reply.status.current_ma} after the end of the pulse")

    def request_until_accepted(self, since_s: float, **changes: int) -> None:
        """Send requests until one is accepted, and leave its pulse running.

        That must be no sooner than a back-off after ``since_s``, and soon after that; ticks that were put off
        may have put off its end, as a board may count ticks where they are the slower ones.
        """
        end_s, put_off_s = since_s + self.limits.backoff_ms / 1000.0, self.link.put_off_s
        period_s = self.link.period_s
        while True:
            left_s = end_s - self.link.due_s()
            near = left_s < 6 * period_s
            reported_free = self._is_reported_free(int(changes.get("coil", 1)))
            request = self.request(**changes)
            reply = self.send(request)
            if not reply.refused:
                break
            if reported_free:
                raise NonconformanceError(f"refused in tick {reply.tick - 1}, of which lockout_ms was 0")
            if reply.refused[0].reason != CoilRefusedReason.LOCKOUT:
                raise NonconformanceError(f"refused as {reasons(reply)} in a back-off")
            if left_s + self.link.put_off_s - put_off_s < -(LATE_TICKS + 1) * period_s:
                raise NonconformanceError(f"refused as lockout {-left_s:.1f} s after the end of the back-off")
            for _ in range(0 if near else int(left_s / period_s / 4.0)):
                self.expect_off(self.link.step())
        self._accept(request, reply)
        early_s = end_s - reply.at_s
        if early_s > SLACK_S + DRIFT * (end_s - since_s):
            raise NonconformanceError(f"accepted {early_s:.3f} s before the end of the back-off")
        if reply.status.level == 0:
            raise NonconformanceError("a request is neither driven nor refused")
        _expect_as_requested(request, reply)

    def _is_reported_free(self, coil: int) -> bool:
        """Whether the status of this tick says that no back-off runs for the coil."""
        last = self.link.replies[-1]
        return any(
            isinstance(message, CoilStatus)
            and message.level == message.lockout_ms == 0
            and (self.limits.shared or message.coil == coil)
            for message in last.messages
            if last.tick == self.link.tick
        )

    def longest_hold_s(self) -> float:
        """For how long a tick may be held: so long, and a tick, is short of the dead-man."""
        deadman_s, period_s = self.limits.deadman_s, self.link.period_s
        return max(deadman_s - 2.5 * period_s, (deadman_s - period_s) / 2.0)


def _expect_as_requested(request: CoilFire, reply: TickReply) -> None:
    status = reply.status
    if (status.coil, status.level, status.seq) != (request.coil, request.level, request.seq):
        raise NonconformanceError(f"{request} was accepted, and in tick {reply.tick}: {status}")


def reasons(reply: TickReply) -> str:
    """The reasons of the refusals in a reply, as text."""
    names = {int(reason): reason.name.lower() for reason in CoilRefusedReason}
    return ", ".join(names.get(refused.reason, str(refused.reason)) for refused in reply.refused) or "nothing"
