"""The checks of a board, one function each; its docstring states the demand."""

from collections.abc import Callable, Sequence
from itertools import pairwise

from fsw.wire.frame import EXTENDED_FLAG, REMOTE_FLAG, Frame
from fsw.wire.messages import (
    AnyMessage,
    CoilEvent,
    CoilHeartbeat,
    CoilRefusedReason,
    CoilStatus,
    MagHeartbeat,
    SunHeartbeat,
    Sync,
)
from sim.conformance.board_link import BoardKind, BoardLink, NonconformanceError, TickReply
from sim.conformance.board_under_test import BoardUnderTest, reasons
from sim.errors import HarnessError

DEAD_MAN = 2
"""``event`` of COIL_EVENT; restated here, so that the checks do not depend on the board's code."""
CONTRACT_VERSION = 1
HEARTBEAT_S = 60
READY, ON, LOCKED_OUT = 0, 1, 2
"""``state`` of COIL_HEARTBEAT."""
MOST_REFUSALS = 64
FLOOD_S = 0.2
"""What a flood of requests and its answers may take on a slow bus, beside the tick."""
DEAD_MAN_SLACK_S, DEAD_MAN_PART = 0.1, 0.02
"""How far a dead-man may be from what the bench says [s], and by which part of it."""
SILENCES = 10
"""Attempts at a silence in which this computer is not held up."""


def boot(board: BoardUnderTest) -> None:
    """PLANT_BOOT restarts it: boot message, off, a full lockout on every coil, no fault of the self-test.

    In tick 0 it has no effect.
    """
    link = board.link
    link.restart()
    if link.restart().messages:
        raise NonconformanceError("PLANT_BOOT in tick 0 made it answer")
    for _ in range(2):
        link.step()
    first = link.restart()
    if len(first.only(link.kind.boot)) != 1 or not isinstance(first.messages[0], link.kind.boot):
        raise NonconformanceError(f"PLANT_BOOT: one boot message first, not {names(first.messages)}")
    version = first.messages[0].version
    if version != CONTRACT_VERSION:
        raise NonconformanceError(f"it is of version {version} of the bus contract, not {CONTRACT_VERSION}")
    if link.kind.sample is not CoilStatus:
        return
    board.expect_lockout(first)
    for number in range(1, 4):
        reply = link.step()
        board.expect_lockout(reply, number)
        if reply.only(CoilEvent):
            raise NonconformanceError(f"a fault is reported after boot: {reply.only(CoilEvent)}")


def noise(board: BoardUnderTest) -> None:
    """Unknown, remote, extended and broken frames, and a strange SYNC alone, move nothing."""
    link = board.link
    sample = Sync(link.tick + 7, 0).encode()
    strange = [
        Frame(0x7FF, b"\xff" * 8),
        Frame(0x123 | EXTENDED_FLAG, b"\x00"),
        Frame(sample.can_id | REMOTE_FLAG, bytes(8)),
        Frame(sample.can_id, sample.data[:7]),
        sample,
    ]
    reply = link.step(*strange)
    if reply.only(link.kind.boot):
        raise NonconformanceError("it restarted because of noise")
    if link.kind.sample is CoilStatus:
        board.expect_off(reply)


def boot_lockout(board: BoardUnderTest) -> None:
    """After boot nothing is accepted for a full back-off, and then it is.

    A tick is held meanwhile: the back-off is over when the ticks say so, too.
    """
    link, held_s = board.link, board.longest_hold_s()
    since_s = link.restart().at_s
    link.step(late_s=held_s)
    board.request_until_accepted(since_s + held_s)


def refusals(board: BoardUnderTest) -> None:
    """Each improper request is refused for its own reason, in lockout and when free, and changes nothing."""
    for when in ("locked out", "free"):
        if when == "free":
            board.wait_until_free()
        for changes, reason in _improper(board):
            board.expect_off(board.expect_refusal(board.request(**changes()), reason))
        for damage in (_flip, _shorten, _cut_to_its_name, _lengthen):
            request = board.request()
            frame = damage(request.encode())
            board.expect_off(board.expect_refusal(request, CoilRefusedReason.MALFORMED, frame))
        proper = board.request().encode()
        for nameless in (
            Frame(proper.can_id | EXTENDED_FLAG, proper.data),
            Frame(proper.can_id | REMOTE_FLAG, proper.data),
            Frame(proper.can_id, proper.data[:2]),
        ):
            reply = board.link.step(nameless)
            board.expect_off(reply)
            if reply.refused:
                raise NonconformanceError(f"a frame that is no request was refused as {reasons(reply)}")


def _improper(board: BoardUnderTest) -> list[tuple[Callable[[], dict[str, int]], CoilRefusedReason]]:
    reason, too_long = CoilRefusedReason, board.limits.pulse_ms + 1
    return [
        (lambda: {"tick": board.link.tick - 1 & 0xFF}, reason.WRONG_TICK),
        (lambda: {"tick": board.link.tick + 1 & 0xFF}, reason.WRONG_TICK),
        (lambda: {"seq": board.accepted_seq}, reason.REPEATED_SEQ),
        (lambda: {"coil": 3}, reason.BAD_COIL),
        (lambda: {"level": 0}, reason.BAD_LEVEL),
        (lambda: {"level": 4}, reason.BAD_LEVEL),
        (lambda: {"level": -4}, reason.BAD_LEVEL),
        (lambda: {"level": -8}, reason.BAD_LEVEL),
        (lambda: {"duration_ms": 0}, reason.BAD_DURATION),
        (lambda: {"duration_ms": too_long}, reason.BAD_DURATION),
        (lambda: {"duration_ms": 65_535}, reason.BAD_DURATION),
        (lambda: {"coil": 3, "level": 0, "tick": board.link.tick - 1 & 0xFF}, reason.WRONG_TICK),
        (lambda: {"coil": 3, "level": 0, "duration_ms": 0}, reason.BAD_COIL),
        (lambda: {"level": 0, "duration_ms": 0}, reason.BAD_LEVEL),
    ]


def _flip(frame: Frame) -> Frame:
    return Frame(frame.can_id, bytes((frame.data[0] ^ 0x20, *frame.data[1:])))


def _shorten(frame: Frame) -> Frame:
    return Frame(frame.can_id, frame.data[:6])


def _cut_to_its_name(frame: Frame) -> Frame:
    return Frame(frame.can_id, frame.data[:3])


def _lengthen(frame: Frame) -> Frame:
    return Frame(frame.can_id, frame.data + b"\x00")


def flood(board: BoardUnderTest) -> None:
    """Of the refusals of a tick the first 64 are reported."""
    requests = [board.request(tick=board.link.tick - 1 & 0xFF) for _ in range(MOST_REFUSALS + 6)]
    late_s = min(FLOOD_S, board.limits.deadman_s / 4.0)
    reply = board.link.step(*(request.encode() for request in requests), late_s=late_s)
    board.expect_off(reply)
    reported = [refused.seq for refused in reply.refused]
    if reported != [request.seq for request in requests[:MOST_REFUSALS]]:
        raise NonconformanceError(
            f"of {len(requests)} requests in a tick it refuses {len(reported)}, "
            f"not the first {MOST_REFUSALS} in their order"
        )


def back_off(board: BoardUnderTest) -> None:
    """A pulse is as requested, one coil at a time; from its end to the next start a full back-off.

    And not much more.
    """
    request, reply = board.begin_pulse()
    end_s = reply.at_s + request.duration_ms / 1000.0

    def another() -> TickReply:
        reason = CoilRefusedReason.COIL_ON
        return (
            board.expect_refusal(board.request(coil=2), reason) if reply.status.remaining_ms else link.step()
        )

    link = board.link
    board.follow_pulse(request, reply, another)
    if board.limits.shared:
        board.expect_locked_out(end_s, coil=0)
    else:
        other_request, first_reply = board.expect_accepted(
            coil=0, duration_ms=max(1, request.duration_ms // 2)
        )
        board.follow_pulse(other_request, first_reply)
    board.request_until_accepted(end_s, level=3, duration_ms=max(1, round(0.75 * board.limits.pulse_ms)))


def dead_man(board: BoardUnderTest) -> None:
    """No SYNC: off, COIL_EVENT, and a full lockout that begins when SYNC is back; not before its time."""
    link, deadman_s = board.link, board.limits.deadman_s
    slack_s = DEAD_MAN_SLACK_S + DEAD_MAN_PART * deadman_s
    board.expect_off(link.step())
    for _ in range(SILENCES):
        since_s = link.clock()
        link.step(early_s=0.0)
        _silence(board, deadman_s - slack_s - (link.clock() - since_s))
        silent_s = link.clock() - since_s
        events = _events(link.step())
        if silent_s < deadman_s - slack_s / 2.0:
            break
    else:
        raise HarnessError(
            f"this computer was held up in each of {SILENCES} silences: the dead-man is not judged"
        )
    if events:
        raise NonconformanceError(f"no SYNC for {silent_s:.3f} s, less than the dead-man: events {events}")
    link.step(early_s=0.0)
    _silence(board, deadman_s + slack_s)
    expect_dead_man(board, f"no SYNC for {deadman_s + slack_s:g} s")


def dead_man_in_a_pulse(board: BoardUnderTest) -> None:
    """No SYNC while a coil is on: off, one COIL_EVENT, a full lockout; the last seq is still remembered."""
    board.begin_pulse()
    board.expect_locked_out(wake_dead_man(board).at_s)
    repeated = board.request(seq=board.accepted_seq)
    reply = board.expect_refusal(repeated, CoilRefusedReason.REPEATED_SEQ)
    board.expect_off(reply)
    if events := _events(reply):
        raise NonconformanceError(f"the dead-man was reported, and a tick later there are events {events}")


def wake_dead_man(board: BoardUnderTest) -> TickReply:
    """Send nothing until the dead-man has woken: the reply in the next tick."""
    silent_s = 1.5 * board.limits.deadman_s + board.link.period_s
    _silence(board, silent_s)
    return expect_dead_man(board, f"no SYNC for {silent_s:g} s")


def _silence(board: BoardUnderTest, seconds: float) -> None:
    during = board.link.silence(max(0.0, seconds))
    if during.messages:
        raise NonconformanceError(f"it sends without a SYNC: {names(during.messages)}")


def expect_dead_man(board: BoardUnderTest, why: str) -> TickReply:
    """The reply in the next tick, which must report the dead-man, with a full lockout.

    Raises:
        NonconformanceError: it is not.
    """
    reply = board.link.step()
    events = _events(reply)
    if events != [DEAD_MAN]:
        raise NonconformanceError(f"{why}: events {events}, not the dead-man")
    board.expect_lockout(reply, 1)
    return reply


def _events(reply: TickReply) -> list[int]:
    return [message.event for message in reply.messages if isinstance(message, CoilEvent)]


def restart_in_a_pulse(board: BoardUnderTest) -> None:
    """A restart while a coil is on: off at once, and a full lockout; no seq is a repeated one."""
    board.begin_pulse()
    restarted = board.link.restart()
    board.expect_lockout(restarted)
    for seq in (board.accepted_seq, 0):
        board.expect_locked_out(restarted.at_s, seq=seq)


def heartbeats(board: BoardUnderTest) -> None:
    """A heartbeat every 60 s of ticks after boot, none before, and a true one; if need be it waits for it."""
    link = board.link
    if not _heartbeats_due(link):
        link.restart()
        for _ in range(HEARTBEAT_S * link.tick_hz):
            link.step()
    due = _heartbeats_due(link)
    if not due:
        raise NonconformanceError("no boot message after PLANT_BOOT from which heartbeats could be counted")
    missing = [reply.tick for reply in due if not reply.only(link.kind.heartbeat)]
    if missing:
        raise NonconformanceError(
            f"no heartbeat in tick {missing[0]}, {HEARTBEAT_S} s after boot or the last one"
        )
    for life in _lives(link):
        beats = [reply.tick - life[0].tick for reply in life for _ in reply.only(link.kind.heartbeat)]
        for number, ticks in enumerate(beats, 1):
            if ticks < number * HEARTBEAT_S * link.tick_hz:
                raise NonconformanceError(
                    f"heartbeat {number} after boot comes {ticks} ticks after it, "
                    f"{ticks / link.tick_hz:g} s and not {number * HEARTBEAT_S}"
                )
        _check_content(life, board.limits.shared)


def _check_content(life: list[TickReply], shared: bool) -> None:
    """Each heartbeat of a life: its tick, and of a coil driver its state and the least of its rejects."""
    malformed = 0
    for reply in life:
        malformed += sum(refused.reason == CoilRefusedReason.MALFORMED for refused in reply.refused)
        where = f"the heartbeat in tick {reply.tick}"
        for beat in reply.messages:
            if not isinstance(beat, CoilHeartbeat | MagHeartbeat | SunHeartbeat):
                continue
            if beat.tick != reply.tick & 0xFFFF:
                raise NonconformanceError(f"{where} names tick {beat.tick}")
            if not isinstance(beat, CoilHeartbeat):
                continue
            if beat.rejects < malformed:
                raise NonconformanceError(
                    f"{where} has rejects {beat.rejects}, after {malformed} broken requests"
                )
            state = _state(reply.status, shared)
            if state is not None and beat.state != state:
                raise NonconformanceError(f"{where} is of state {beat.state}, not {state} ({reply.status})")


def _state(status: CoilStatus, shared: bool) -> int | None:
    """The state of a board with that status; None: another coil's back-off may run."""
    if status.remaining_ms:
        return ON
    if status.lockout_ms:
        return LOCKED_OUT
    return READY if shared else None


def _lives(link: BoardLink) -> list[list[TickReply]]:
    """The replies so far from each boot to the next."""
    boots = [n for n, reply in enumerate(link.replies) if reply.only(link.kind.boot)]
    return [link.replies[first:last] for first, last in pairwise([*boots, len(link.replies)])]


def _heartbeats_due(link: BoardLink) -> list[TickReply]:
    """The replies so far that had to have a heartbeat."""
    period = HEARTBEAT_S * link.tick_hz
    return [
        reply
        for life in _lives(link)
        for reply in life
        if reply.due and reply.tick > life[0].tick and (reply.tick - life[0].tick) % period == 0
    ]


def all_along(board: BoardUnderTest) -> None:
    """Exactly one sample in each tick, counters that rise by one, no broken frame."""
    check_replies(board.link.replies, board.link.kind)


def check_replies(replies: Sequence[TickReply], kind: BoardKind) -> None:
    """Exactly one sample in each tick, counters that rise by one, no broken frame.

    Raises:
        NonconformanceError: the first that is not so.
    """
    for reply in replies:
        if reply.broken:
            raise NonconformanceError(f"a frame that is not intact in tick {reply.tick}: {reply.broken[0]}")
        if len(reply.only(kind.sample)) != 1 and (reply.due or reply.messages):
            received = names(reply.messages)
            raise NonconformanceError(f"not one {kind.sample.__name__} in tick {reply.tick}: {received}")
    _check_counters([message for reply in replies for message in reply.messages], kind)


def _check_counters(messages: list[AnyMessage], kind: BoardKind) -> None:
    """Counters rise by one, from 0 after boot."""
    following: dict[type[AnyMessage], int] = {}
    booted = False
    for message in messages:
        if isinstance(message, kind.boot):
            following, booted = {}, True
        counter = message.values()[-1]
        due = following.get(type(message), 0 if booted else counter)
        if counter != due:
            raise NonconformanceError(f"counter of {type(message).__name__} is {counter}, not {due}")
        following[type(message)] = (due + 1) % 16


def names(messages: list[AnyMessage]) -> str:
    """The names of messages, as text."""
    return ", ".join(type(message).__name__ for message in messages) or "nothing"
