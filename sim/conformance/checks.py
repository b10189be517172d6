"""The checks of a board, one function each; its docstring says what is demanded."""

from collections.abc import Callable
from itertools import pairwise

from fsw.wire.frame import EXTENDED_FLAG, REMOTE_FLAG, Frame
from fsw.wire.messages import AnyMessage, CoilEvent, CoilRefusedReason, CoilStatus, Sync
from sim.conformance.session import BrokenError, Heard, Kind
from sim.conformance.subject import Subject, reasons

DEAD_MAN = 2
"""``event`` of COIL_EVENT: written down here anew, as everything that is judged by."""
HEARTBEAT_S = 60


def boot(subject: Subject) -> None:
    """PLANT_BOOT restarts it: boot message, off, a full lockout on every coil, no fault of the self-test."""
    session = subject.session
    session.restart()
    for _ in range(2):
        session.step()
    first = session.restart()
    if len(first.only(session.kind.boot)) != 1 or not isinstance(first.messages[0], session.kind.boot):
        raise BrokenError(f"PLANT_BOOT: one boot message first, not {names(first.messages)}")
    if session.kind.sample is not CoilStatus:
        return
    subject.locked_out(first)
    for number in range(1, 4):
        heard = session.step()
        subject.locked_out(heard, number)
        if heard.only(CoilEvent):
            raise BrokenError(f"a fault is told after boot: {heard.only(CoilEvent)}")


def noise(subject: Subject) -> None:
    """Unknown, remote, extended and broken frames, and a strange SYNC alone, move nothing."""
    session = subject.session
    sample = Sync(session.tick + 7, 0).encode()
    strange = [
        Frame(0x7FF, b"\xff" * 8),
        Frame(0x123 | EXTENDED_FLAG, b"\x00"),
        Frame(sample.can_id | REMOTE_FLAG, bytes(8)),
        Frame(sample.can_id, sample.data[:7]),
        sample,
    ]
    heard = session.step(*strange)
    if heard.only(session.kind.boot):
        raise BrokenError("it restarted because of noise")
    if session.kind.sample is CoilStatus:
        subject.off(heard)


def boot_lockout(subject: Subject) -> None:
    """After boot nothing is accepted for a full back-off, and then it is; the pulse is as asked for."""
    subject.wait_for_next(subject.session.restart().at_s)


def refusals(subject: Subject) -> None:
    """Each improper request is refused for its own reason, in lockout and when free, and changes nothing."""
    for when in ("locked out", "free"):
        if when == "free":
            subject.free()
        for changes, reason in _improper(subject):
            subject.off(subject.refuse(subject.fire(**changes()), reason))
        for damage in (_flip, _shorten, _lengthen):
            asked = subject.fire()
            frame = damage(asked.encode())
            subject.off(subject.refuse(asked, CoilRefusedReason.MALFORMED, frame))
        for flag in (EXTENDED_FLAG, REMOTE_FLAG):
            good = subject.fire().encode()
            heard = subject.session.step(Frame(good.can_id | flag, good.data))
            subject.off(heard)
            if heard.refused:
                raise BrokenError(f"a frame that is no request was refused as {reasons(heard)}")


def _improper(subject: Subject) -> list[tuple[Callable[[], dict[str, int]], CoilRefusedReason]]:
    reason, too_long = CoilRefusedReason, subject.limits.pulse_ms + 1
    return [
        (lambda: {"tick": subject.session.tick - 1 & 0xFF}, reason.WRONG_TICK),
        (lambda: {"tick": subject.session.tick + 1 & 0xFF}, reason.WRONG_TICK),
        (lambda: {"seq": subject.accepted_seq}, reason.REPEATED_SEQ),
        (lambda: {"coil": 3}, reason.BAD_COIL),
        (lambda: {"level": 0}, reason.BAD_LEVEL),
        (lambda: {"level": 4}, reason.BAD_LEVEL),
        (lambda: {"level": -4}, reason.BAD_LEVEL),
        (lambda: {"level": -8}, reason.BAD_LEVEL),
        (lambda: {"duration_ms": 0}, reason.BAD_DURATION),
        (lambda: {"duration_ms": too_long}, reason.BAD_DURATION),
        (lambda: {"duration_ms": 65_535}, reason.BAD_DURATION),
        (lambda: {"coil": 3, "level": 0, "tick": subject.session.tick - 1 & 0xFF}, reason.WRONG_TICK),
        (lambda: {"coil": 3, "level": 0, "duration_ms": 0}, reason.BAD_COIL),
        (lambda: {"level": 0, "duration_ms": 0}, reason.BAD_LEVEL),
    ]


def _flip(frame: Frame) -> Frame:
    return Frame(frame.can_id, bytes((frame.data[0] ^ 0x20, *frame.data[1:])))


def _shorten(frame: Frame) -> Frame:
    return Frame(frame.can_id, frame.data[:6])


def _lengthen(frame: Frame) -> Frame:
    return Frame(frame.can_id, frame.data + b"\x00")


def back_off(subject: Subject) -> None:
    """One coil at a time; from the end of a pulse to the next start a full back-off, and not much more."""
    subject.free()
    duration_ms = max(1, round(0.75 * subject.limits.pulse_ms))
    asked, heard = subject.accept(duration_ms=duration_ms, level=3)
    end_s = heard.at_s + duration_ms / 1000.0

    def another() -> Heard:
        reason = CoilRefusedReason.COIL_ON
        return subject.refuse(subject.fire(coil=2), reason) if heard.status.remaining_ms else session.step()

    session = subject.session
    subject.pulse(asked, heard, another)
    if subject.limits.shared:
        subject.off(subject.refuse(subject.fire(coil=0), CoilRefusedReason.LOCKOUT))
    else:
        other, began = subject.accept(coil=0, duration_ms=max(1, duration_ms // 2))
        subject.pulse(other, began)
    subject.wait_for_next(end_s)


def dead_man(subject: Subject) -> None:
    """No SYNC: off, COIL_EVENT, and a full lockout that begins when SYNC is back."""
    subject.session.step()
    subject.off(subject.session.step())
    _fall_silent(subject)


def dead_man_in_a_pulse(subject: Subject) -> None:
    """The same while a coil is on."""
    subject.free()
    subject.accept()
    _fall_silent(subject)
    subject.off(subject.refuse(subject.fire(), CoilRefusedReason.LOCKOUT))


def _fall_silent(subject: Subject) -> None:
    during = subject.session.silence(1.5 * subject.limits.deadman_s + subject.session.period_s)
    if during.messages:
        raise BrokenError(f"it speaks without being spoken to: {names(during.messages)}")
    silenced(subject, "no SYNC")


def silenced(subject: Subject, why: str) -> None:
    """The dead-man is told in the next tick, with a full lockout.

    Raises:
        BrokenError: it is not.
    """
    heard = subject.session.step()
    events = [message.event for message in heard.messages if isinstance(message, CoilEvent)]
    if events != [DEAD_MAN]:
        raise BrokenError(
            f"{why} for {1.5 * subject.limits.deadman_s:g} s: events {events}, not the dead-man"
        )
    subject.locked_out(heard, 1)


def restart_in_a_pulse(subject: Subject) -> None:
    """A restart while a coil is on: off at once, and a full lockout."""
    subject.free()
    subject.accept()
    subject.locked_out(subject.session.restart())
    subject.off(subject.refuse(subject.fire(), CoilRefusedReason.LOCKOUT))


def all_along(subject: Subject) -> None:
    """Exactly one sample in each tick, counters that rise by one, no broken frame, heartbeats in time."""
    session = subject.session
    kind = session.kind
    for heard in session.record:
        if heard.broken:
            raise BrokenError(f"a frame that is not intact in tick {heard.tick}: {heard.broken[0]}")
        if len(heard.only(kind.sample)) != 1 and (heard.due or heard.messages):
            said = names(heard.messages)
            raise BrokenError(f"not one {kind.sample.__name__} in tick {heard.tick}: {said}")
    _counted([message for heard in session.record for message in heard.messages], kind)
    _beats(session.record, kind, session.tick_hz)


def _counted(messages: list[AnyMessage], kind: Kind) -> None:
    """Counters rise by one, from 0 after boot."""
    following: dict[type[AnyMessage], int] = {}
    booted = False
    for message in messages:
        if isinstance(message, kind.boot):
            following, booted = {}, True
        told = message[-1]
        due = following.get(type(message), 0 if booted else told)
        if told != due:
            raise BrokenError(f"counter of {type(message).__name__} is {told}, not {due}")
        following[type(message)] = (due + 1) % 16


def _beats(record: list[Heard], kind: Kind, tick_hz: int) -> None:
    """Heartbeats every 60 s of ticks after boot."""
    boots = [n for n, heard in enumerate(record) if heard.only(kind.boot)]
    for first, last in pairwise([*boots, len(record)]):
        life = record[first:last]
        period, born = HEARTBEAT_S * tick_hz, life[0].tick
        due = [h for h in life if h.due and h.tick > born and (h.tick - born) % period == 0]
        missing = [h.tick for h in due if not h.only(kind.heartbeat)]
        if missing:
            raise BrokenError(
                f"no heartbeat in tick {missing[0]}, {HEARTBEAT_S} s after boot or the last one"
            )


def names(messages: list[AnyMessage]) -> str:
    """The names of messages, for people."""
    return ", ".join(type(message).__name__ for message in messages) or "nothing"
