"""What every flight software must keep, whatever it is for: each rule a function that says so in words."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import groupby
from typing import NamedTuple

from fsw.wire.candump_line import frame_text
from fsw.wire.messages import CoilFire, CoilRefusedReason
from hil_stub.coils.interlock import COILS, MAX_LEVEL, CoilLimits
from sim.console import counted
from sim.fault_table.wrong_estimates import WRONG_S
from sim.faults.section import forge_answers, forge_sync
from sim.flight.second_senders import describe_senders
from sim.judge.answers import AnswerRecord, CoilRequest, crc_as_sent, tick_as_named
from sim.judge.driven import DrivenLimits
from sim.judge.profile import Profile
from sim.judge.unheard import tell_unheard
from sim.judge.valid_estimates import WrongAttitude, WrongRate
from sim.record.run_record import RunRecord
from sim.report.requirements.judge import Outcome
from sim.report.verdict import Verdict
from sim.scenario.assemble import coil_limits
from sim.scenario.schema import Scenario
from sim.value_types import Json


class JudgedFlightRecord(NamedTuple):
    """What a flight is judged by.

    Attributes:
        scenario: that was flown.
        profile: of the flight software.
        run: its run.json.
        summary: its summary.json.
        answers: what the flight software sent.
        said: the last line that its command printed.
        faulty: the scenario injects faults, by which requests may come to be refused and answers be lost.
        wrong: attitudes that were called valid and were wrong; None: none is judged.
        driven: what the currents that flowed show of the limits, where a fault alters what the board
            reports; None: the audit of the log counts.
        wrong_rate: rates that were sent and were wrong; None: none is judged.
    """

    scenario: Scenario
    profile: Profile
    run: RunRecord
    summary: Json
    answers: AnswerRecord
    said: str = ""
    faulty: bool = False
    wrong: WrongAttitude | None = None
    driven: DrivenLimits | None = None
    wrong_rate: WrongRate | None = None

    @property
    def tick_hz(self) -> int:
        """Ticks a second."""
        return self.scenario.time.tick_hz

    @property
    def paced(self) -> bool:
        """Flown in real time."""
        return self.run["pace"] == "realtime"


class InvariantVerdict(NamedTuple):
    """The verdict of a rule: its name, the outcome, and a sentence without its full stop."""

    name: str
    outcome: Outcome
    text: str


Found = tuple[Outcome, str]
LEAST_S = 300.0
"""Time after the back-off of boot in which a law that acts asks for something."""
SLIGHT = 0.01
"""Part of the longest pulse that moves no body."""


def _kept(text: str) -> Found:
    return Outcome.MET, text


def _broken(text: str) -> Found:
    return Outcome.FAILED, text


def _unjudged(text: str) -> Found:
    return Outcome.NOT_JUDGED, text


def _flies_to_its_end(flight: JudgedFlightRecord) -> Found:
    """It boots, answers to the last tick and does not end before."""
    why = flight.summary.get("failures", {}).get(Verdict.COMPLETE.value)
    if why is None:
        return _kept(f"all {counted(flight.answers.ticks, 'tick')} flown")
    came = tell_unheard(flight.run.get("unheard"))
    heard = f": {came}" if came else ""
    said = f", the last that it printed is: {flight.said}" if flight.said else ""
    return _broken(f"{why}{heard}{said}")


def _answers(flight: JudgedFlightRecord) -> Found:
    """Every tick is answered, and in real time in its own time."""
    record = flight.answers
    if record.odd_done and not flight.faulty:
        more = f", and {len(record.odd_done) - 1} more" if len(record.odd_done) > 1 else ""
        return _broken(f"{tick_as_named(*record.odd_done[0])}{more}")
    if hang := _longest_hang(record):
        first, ticks = hang
        least_s, most_s = ticks / flight.tick_hz, (ticks + 1) / flight.tick_hz
        late = sum(done != tick for tick, done in enumerate(record.answered_in))
        if flight.paced:
            ends = record.answered_in[first]
            when = f"tick {first} was answered in tick {ends}" if ends >= 0 else f"tick {first} never was"
            return _broken(
                f"it hung for {least_s:.3g} to {most_s:.3g} s at tick {first}: {when}, and "
                f"{counted(late, 'tick')} of {record.ticks} had no answer in time"
            )
    missing = [tick for tick, done in enumerate(record.answered_in) if done < 0]
    if missing:
        return _broken(f"no TICK_DONE to tick {missing[0]}, and {len(missing)} of {record.ticks} unanswered")
    if record.repeats and not flight.faulty:
        tick, times = record.repeats.most_common(1)[0]
        return _kept(
            f"each tick is answered, that of {tick} after {counted(times, 'repetition')} of SYNC, every 2 s: "
            "in lockstep time is not judged, --paced judges it"
        )
    return _kept(f"each of {counted(record.ticks, 'tick')} is answered")


def _longest_hang(record: AnswerRecord) -> tuple[int, int] | None:
    """First tick and number of ticks of the longest time without an answer in time; None: there is none."""
    slips = [
        (tick, done - tick if done >= 0 else 0)
        for tick, done in enumerate(record.answered_in)
        if done != tick
    ]
    runs = []
    for _, run in groupby(enumerate(slips), key=lambda one: one[1][0] - one[0]):
        ticks = [slip for _, slip in run]
        runs.append((ticks[0][0], max(len(ticks), ticks[0][1])))
    return max(runs, key=lambda run: run[1], default=None)


def _stays_up(flight: JudgedFlightRecord) -> Found:
    """It does not restart in flight."""
    again = [tick for tick in flight.answers.boots[1:] if tick > 0]  # in tick 0 it may be asked twice
    if not again:
        return _kept("one FSW_BOOT, before the flight")
    more = f", and {len(again) - 1} more" if len(again) > 1 else ""
    at_s = again[0] / flight.tick_hz
    return _broken(f"it restarted in flight: FSW_BOOT in tick {again[0]}, after {at_s:.0f} s{more}")


def _speaks_whole(flight: JudgedFlightRecord) -> Found:
    """Each of its frames has the length, CRC and counter of the contract."""
    record = flight.answers
    if record.broken:
        name, number = record.broken.most_common(1)[0]
        tick, frame = record.first_broken[name]
        how = crc_as_sent(frame)
        why = f": {how}" if how else ""
        first = frame_text(frame)
        return _broken(f"{counted(number, 'frame')} of {name} not whole, first {first} in tick {tick}{why}")
    if record.counters and not flight.faulty:
        name, number = record.counters.most_common(1)[0]
        return _broken(f"the counter of {name} does not rise by one, {counted(number, 'time')}")
    return _kept("length, CRC and counter of each frame are right")


def _asks_properly(flight: JudgedFlightRecord) -> Found:
    """No request breaks a limit: what a board refuses must not be asked for."""
    if flight.scenario.coils.driver == "continuous":
        refused = flight.answers.refused_dipoles + len(flight.answers.requests)
        if refused and not flight.faulty:
            return _broken(f"{counted(refused, 'request')} refused by the continuous driver")
        return _kept(f"{counted(flight.answers.dipoles, 'COIL_DIPOLE')}, none refused")
    requests = flight.answers.requests
    if flight.faulty:  # what the board received, and its refusals, may be others than what was sent
        limits = coil_limits(flight.scenario.coils, flight.tick_hz)
        wrong = [
            replace(one, refused=reason) for one in requests if (reason := _wrong_by_itself(limits, one.fire))
        ]
    else:
        allowed = (0, CoilRefusedReason.LOCKOUT)
        wrong = [one for one in requests if one.refused not in allowed and not one.stuck]
    if not wrong:
        return _kept(f"{counted(len(requests), 'request')}, each within the limits")
    why = _why_improper(flight, wrong[0])
    return _broken(f"{counted(len(wrong), 'request')} of {len(requests)} against the limits, first {why}")


def _wrong_by_itself(limits: CoilLimits, fire: CoilFire) -> CoilRefusedReason | None:
    """Why no board may accept a request as it was sent, in whatever state it is; None: one may."""
    reasons = {
        CoilRefusedReason.BAD_COIL: not 0 <= fire.coil < COILS,
        CoilRefusedReason.BAD_LEVEL: not 1 <= abs(fire.level) <= MAX_LEVEL,
        CoilRefusedReason.BAD_DURATION: not 1 <= fire.duration_ms <= limits.pulse_ms,
    }
    return next((reason for reason, holds in reasons.items() if holds), None)


def _why_improper(flight: JudgedFlightRecord, request: CoilRequest) -> str:
    limits, fire = coil_limits(flight.scenario.coils, flight.tick_hz), request.fire
    at, name = f"in tick {request.tick}", CoilRefusedReason(request.refused).name.lower()
    if request.refused == CoilRefusedReason.BAD_DURATION:
        swapped = _swapped(fire.duration_ms, 2)
        order = (
            f": the byte order is wrong, it is {swapped} ms with its bytes the other way round"
            if 0 < swapped <= limits.pulse_ms and fire.duration_ms > 10 * limits.pulse_ms
            else ""
        )
        longest = f"the longest pulse is {limits.pulse_ms / 1000.0:g} s"
        return f"{at} a pulse of {fire.duration_ms / 1000.0:g} s, {longest}{order}"
    values = {
        CoilRefusedReason.WRONG_TICK: f"it names tick {fire.tick} and not {request.tick & 0xFF}",
        CoilRefusedReason.REPEATED_SEQ: f"seq {fire.seq} is that of the last accepted one",
        CoilRefusedReason.BAD_COIL: f"there is no coil {fire.coil}",
        CoilRefusedReason.BAD_LEVEL: f"there is no level {fire.level}",
        CoilRefusedReason.COIL_ON: "a coil is on",
    }
    reason = values.get(CoilRefusedReason(request.refused), name)
    return f"{at}: {reason} ({name})"


def _waits(flight: JudgedFlightRecord) -> Found:
    """It waits out the back-off, from boot and after each pulse."""
    if flight.scenario.coils.driver == "continuous":
        return _unjudged("a continuous driver has no back-off")
    requests = flight.answers.requests
    early = [place for place, one in enumerate(requests) if one.refused == CoilRefusedReason.LOCKOUT]
    if not early or flight.faulty:
        return _kept("no request comes in a back-off" if not early else f"{len(early)} refused under faults")
    limits, first = coil_limits(flight.scenario.coils, flight.tick_hz), requests[early[0]]
    wanted = f"the back-off is {limits.backoff_ms / 1000.0:g} s"
    fired = [one for one in requests[: early[0]] if not one.refused]
    if not limits.shared:
        fired = [one for one in fired if one.fire.coil == first.fire.coil]
    at_s = first.tick / flight.tick_hz
    if fired:
        gap_s = at_s - fired[-1].tick / flight.tick_hz - fired[-1].fire.duration_ms / 1000.0
        since = f"{gap_s:g} s after the end of a pulse"
    else:
        since = f"{at_s:g} s after the board's boot"
    return _broken(
        f"{counted(len(early), 'request')} of {len(requests)} in the back-off, first in tick {first.tick}, "
        f"{since}: {wanted}"
    )


def _acts(flight: JudgedFlightRecord) -> Found:
    """It asks the coils for something that moves a body, once they may be driven."""
    record, pulsed = flight.answers, flight.scenario.coils.driver == "pulsed"
    if flight.faulty:
        return _unjudged("faults act on what it senses or drives")
    flown_s, asked = record.ticks / flight.tick_hz, len(record.requests) if pulsed else record.dipoles
    if not asked:
        boot_s = flight.scenario.coils.backoff_s if pulsed else 0.0
        if flown_s < boot_s + LEAST_S:
            return _unjudged(f"in {flown_s:.0f} s it need not have asked for anything")
        return _broken(f"it asked the coils for nothing in {flown_s:.0f} s")
    return _pulses(flight) if pulsed else _kept(f"{counted(asked, 'dipole')} asked for")


def _pulses(flight: JudgedFlightRecord) -> Found:
    accepted = [one for one in flight.answers.requests if not one.refused]
    if not accepted:
        return _unjudged("each of its requests was refused")
    if not flight.summary["pulses"]["total"]:
        return _broken(
            f"{counted(len(accepted), 'request')}, none refused, and no pulse: does it ask in time?"
        )
    longest_ms = max(one.fire.duration_ms for one in accepted)
    allowed_ms = coil_limits(flight.scenario.coils, flight.tick_hz).pulse_ms
    if longest_ms < SLIGHT * allowed_ms:
        return _broken(f"its longest pulse lasts {longest_ms} ms of {allowed_ms}: is it in ms, not in s?")
    return _kept(f"{counted(flight.summary['pulses']['total'], 'pulse')} driven")


def _limits(flight: JudgedFlightRecord) -> Found:
    """The coils kept their limits, by the audit of the log."""
    if flight.driven is not None:
        return _limits_by_currents(flight.driven)
    why = flight.summary.get("failures", {}).get(Verdict.LIMITS.value)
    return _kept("pulses and back-off kept by the board") if why is None else _broken(why)


def _limits_by_currents(driven: DrivenLimits) -> Found:
    if driven.unjudged:
        return _unjudged(f"the fault alters what the board reports, and {driven.unjudged}")
    if driven.broken:
        return _broken(f"by the currents that flowed: {driven.broken}")
    return _kept("by the currents that flowed, as the fault alters what the board reports")


def _heeds_the_board(flight: JudgedFlightRecord) -> Found:
    """It asks for nothing while the board reports a current that it does not drive."""
    record = flight.answers
    if record.stuck_at < 0:
        return _unjudged("no coil was stuck")
    if flight.driven is not None:
        return _unjudged("the fault alters what the board reports, so that none need have been stuck")
    grace = record.stuck_at + flight.tick_hz
    late = [one for one in record.requests if one.stuck and one.tick > grace]
    if not late:
        return _kept(f"no request after the board reported a stuck coil in tick {record.stuck_at}")
    return _broken(
        f"it goes on firing with a stuck coil: the board reported a current while all coils are off in tick "
        f"{record.stuck_at}, and {counted(len(late), 'request')} came after it, first in tick {late[0].tick}"
    )


def _in_its_turn(flight: JudgedFlightRecord) -> Found:
    """It sends before TICK_DONE, and one request and one of each estimate in an answer."""
    faults = flight.scenario.fault
    if forge_answers(faults) or forge_sync(faults):
        return _unjudged("the scenario forges frames")
    own = [one for one in flight.answers.out_of_turn if _is_its_own(flight, one.name)]
    if not own:
        return _kept("nothing comes after TICK_DONE, and nothing twice in an answer")
    (tick, name, late), request = own[0], own[0].name in _REQUESTS
    where = {
        (True, True): f"a late request in tick {tick}: {name} comes after TICK_DONE({tick})",
        (True, False): f"two requests in tick {tick}: {name} comes twice in its answer",
        (False, True): f"late in tick {tick}: {name} comes after TICK_DONE({tick})",
        (False, False): f"twice in the answer to tick {tick}: {name}",
    }[request, late]
    more = f", and {len(own) - 1} more" if len(own) > 1 else ""
    return _broken(f"{where}{more}")


_REQUESTS = frozenset(("COIL_FIRE", "COIL_DIPOLE", "WHEEL_TORQUE"))


def _is_its_own(flight: JudgedFlightRecord, name: str) -> bool:
    """Whether frames are sure to be the flight software's: it alone is on the bus, or its counter goes on."""
    alone = flight.run.get("flight_software", {}).get("command") is not None
    return alone or (name not in flight.answers.counters and name != "TICK_DONE")


def _alone(flight: JudgedFlightRecord) -> Found:
    """No other node sends in its place, or it in another's."""
    faults = flight.scenario.fault
    if forge_answers(faults) or forge_sync(faults):
        return _unjudged("the scenario forges frames")
    record = flight.answers
    sent = {one.name for one in record.out_of_turn} | ({"TICK_DONE"} if record.odd_done else set())
    explained = {name for name in sent if _is_its_own(flight, name)}
    others = [one for one in flight.run.get("second_senders", []) if one["message"] not in explained]
    if others:
        return _broken(describe_senders(others))
    return _kept("nobody else sends its frames, or it those of others")


def _tells_its_estimate(flight: JudgedFlightRecord) -> Found:
    """Of the profile attitude: NAV_ATTITUDE in every answer."""
    if flight.profile is not Profile.ATTITUDE:
        return _unjudged(f"not asked of the profile {flight.profile.value}")
    record = flight.answers
    if record.estimates >= record.ticks - len(record.repeats) or flight.faulty:
        return _kept("NAV_ATTITUDE in every answer")
    return _broken(f"NAV_ATTITUDE in {record.estimates} of {record.ticks} answers")


def _is_honest(flight: JudgedFlightRecord) -> Found:
    """Of the profile attitude: none is called valid for long that is wrong."""
    wrong = flight.wrong
    if wrong is None:
        return _unjudged(f"not asked of the profile {flight.profile.value}, or of this fault")
    worst = f"at most {wrong.worst_deg:.2g} deg wrong when called valid"
    if wrong.longest_s <= WRONG_S:
        return _kept(worst)
    why = f": {wrong.mistake}" if wrong.mistake else ""
    return _broken(
        f"an attitude is called valid that is more than {wrong.limit_deg:g} deg wrong, for "
        f"{wrong.longest_s:.0f} s on end and up to {wrong.worst_deg:.3g} deg{why}"
    )


def _tells_its_rate(flight: JudgedFlightRecord) -> Found:
    """Of the profile attitude: NAV_RATE beside a valid attitude is the rate relative to the orbital frame."""
    rate = flight.wrong_rate
    if rate is None:
        return _unjudged(
            f"not asked of the profile {flight.profile.value}, or of this fault, or none is sent"
        )
    if rate.longest_s <= WRONG_S:
        return _kept(f"NAV_RATE at most {rate.worst_degps:.2g} deg/s wrong beside a valid attitude")
    why = f": {rate.mistake}" if rate.mistake else ""
    return _broken(
        "NAV_RATE is wrong by more than half the orbital rate and a tenth of itself, for "
        f"{rate.longest_s:.0f} s on end and up to {rate.worst_degps:.3g} deg/s{why}"
    )


Rule = Callable[[JudgedFlightRecord], Found]
RULES: dict[str, Rule] = {
    "flies to its end": _flies_to_its_end,
    "answers each tick": _answers,
    "does not restart": _stays_up,
    "sends whole frames": _speaks_whole,
    "asks within limits": _asks_properly,
    "waits out the back-off": _waits,
    "drives the coils": _acts,
    "limits kept": _limits,
    "heeds a stuck coil": _heeds_the_board,
    "sends in its turn": _in_its_turn,
    "alone on the bus": _alone,
    "tells its estimate": _tells_its_estimate,
    "is honest": _is_honest,
    "its rate is true": _tells_its_rate,
}


OF_NOTHING = ("flies to its end", "sends whole frames")
"""Rules that a flight without a tick may break; it keeps none."""


def judge_invariants(flight: JudgedFlightRecord) -> Sequence[InvariantVerdict]:
    """Every rule, in the order of the table."""
    if flight.answers.ticks:
        return [InvariantVerdict(name, *rule(flight)) for name, rule in RULES.items()]
    found = [InvariantVerdict(name, *RULES[name](flight)) for name in OF_NOTHING]
    broken = [one for one in found if one.outcome is Outcome.FAILED]
    judged = {one.name for one in broken}
    return broken + [
        InvariantVerdict(name, *_unjudged("no tick was flown")) for name in RULES if name not in judged
    ]


def _swapped(value: int, size: int) -> int:
    """The number with its bytes the other way round."""
    return int.from_bytes(value.to_bytes(size, "little"), "big")
