"""Every rule: what keeps it, what breaks it, and the words for that."""

from collections import Counter

import pytest

from fsw.wire.frame import Frame
from fsw.wire.messages import CoilFire, CoilRefusedReason
from sim.judge.answers import AnswerRecord, CoilRequest, OutOfTurn
from sim.judge.driven import DrivenLimits
from sim.judge.invariants import RULES, JudgedFlightRecord, judge_invariants
from sim.judge.profile import Profile
from sim.judge.valid_estimates import WrongAttitude, WrongRate
from sim.report.requirements.judge import Outcome
from sim.scenario.schema import load, parse_settings

TICKS = 400


def record(pace="lockstep", settings=(), profile=Profile.ACTUATOR, failures=None, said="", **answers):
    sound = {"ticks": TICKS, "boots": [-1], "answered_in": list(range(TICKS)), "estimates": TICKS}
    sound |= {"requests": [request(100)]}
    pulses = answers.pop("pulses", sum(not one.refused for one in (sound | answers)["requests"]))
    faulty = answers.pop("faulty", False)
    wrong, driven = answers.pop("wrong", None), answers.pop("driven", None)
    return JudgedFlightRecord(
        load("microsat", parse_settings(settings)),
        profile,
        {"pace": pace} | answers.pop("run", {}),
        {"failures": failures or {}, "pulses": {"total": pulses}},
        AnswerRecord(**sound | answers),
        said,
        faulty,
        wrong,
        driven,
    )


def told(rule, **options):
    """Outcome and text of a rule; every other rule is kept or not judged."""
    found = {one.name: one for one in judge_invariants(record(**options))}
    assert all(one.outcome is not Outcome.FAILED for name, one in found.items() if name != rule)
    return found[rule].outcome, found[rule].text


def broken(rule, **options):
    outcome, text = told(rule, **options)
    assert outcome is Outcome.FAILED
    return text


def request(at, refused=0, stuck=False, **values):
    proper = {"level": 3, "coil": 1, "seq": at & 0xFF, "tick": at & 0xFF, "duration_ms": 3000}
    return CoilRequest(at, CoilFire(**proper | values), stuck, int(refused))


def test_a_sound_one_breaks_none():
    found = judge_invariants(record(requests=[request(100), request(203)]))
    assert [one.name for one in found] == list(RULES)
    assert not [one for one in found if one.outcome is Outcome.FAILED]


@pytest.mark.parametrize(
    ("answers", "words"),
    [
        ({"requests": [], "ticks": 400}, "it asked the coils for nothing in 400 s"),
        ({"requests": [request(100)], "pulses": 0}, "1 request, none refused, and no pulse"),
        ({"requests": [request(100, duration_ms=3)]}, "its longest pulse lasts 3 ms of 3000: is it in ms"),
    ],
)
def test_one_that_moves_nothing_is_told(answers, words):
    assert words in broken("drives the coils", **answers)


def test_what_cannot_be_asked_of_it_is_not():
    short = {"ticks": 390, "answered_in": list(range(390)), "requests": []}
    assert told("drives the coils", **short)[0] is Outcome.NOT_JUDGED
    assert told("drives the coils", requests=[], faulty=True)[0] is Outcome.NOT_JUDGED
    silent = record(dipoles=0, requests=[])._replace(scenario=load("detumble3u"))
    assert {one.name: one for one in judge_invariants(silent)}["drives the coils"].outcome is Outcome.FAILED


def test_of_no_tick_nothing_is_kept():
    found = judge_invariants(
        record(ticks=0, answered_in=[], requests=[], failures={"complete": "not booted"})
    )
    assert {one.name for one in found} == set(RULES)
    assert [one.name for one in found if one.outcome is Outcome.FAILED] == ["flies to its end"]
    assert not [one for one in found if one.outcome is Outcome.MET]


def test_every_rule_says_what_it_demands():
    assert all((rule.__doc__ or "").strip().endswith(".") for rule in RULES.values())


def test_one_that_ends_is_told_with_its_last_words():
    failures = {"complete": "the run is not complete: it ended with exit code 1"}
    text = broken("flies to its end", failures=failures, said="KeyError: 5")
    assert text.endswith("it ended with exit code 1, the last that it printed is: KeyError: 5")


def test_what_came_in_place_of_an_answer_is_told_with_the_end():
    unheard = {"tick": 1, "frames": [{"id": 0x280, "data": "0200000000000000"}]}
    flight = record(failures={"complete": "no answer to tick 1"})
    (end, *_) = judge_invariants(flight._replace(run={**flight.run, "unheard": unheard}))
    assert end.text == "no answer to tick 1: TICK_DONE names tick 2 in the answer to tick 1: the one after it"


def test_a_tick_without_an_answer_is_told():
    answered = [*range(10), -1, -1, *range(12, TICKS)]
    assert broken("answers each tick", answered_in=answered) == (
        f"no TICK_DONE to tick 10, and 2 of {TICKS} unanswered"
    )


def test_the_bytes_of_tick_done_the_other_way_round_are_told():
    text = broken("answers each tick", odd_done=[(1, 1 << 24)], answered_in=[0, -1], ticks=2, estimates=2)
    assert text == (
        "TICK_DONE names tick 16777216 in the answer to tick 1: the byte order is wrong, it is that tick "
        "with its bytes the other way round"
    )


def test_another_tick_is_told_as_it_is():
    assert broken("answers each tick", odd_done=[(5, 9)]) == "TICK_DONE names tick 9 in the answer to tick 5"


@pytest.mark.parametrize(
    ("late", "words"),
    [
        ({150: 160, **{tick: 160 for tick in range(151, 160)}}, "it hung for 10 to 11 s at tick 150"),
        ({tick: -1 for tick in range(150, 160)}, "it hung for 10 to 11 s at tick 150: tick 150 never was"),
        ({150: 151}, "it hung for 1 to 2 s at tick 150: tick 150 was answered in tick 151, and 1 tick of"),
    ],
)
def test_a_hang_is_told_where_time_counts(late, words):
    answered = [late.get(tick, tick) for tick in range(TICKS)]
    assert broken("answers each tick", pace="realtime", answered_in=answered).startswith(words)


def test_in_lockstep_a_repetition_is_no_fault():
    outcome, text = told("answers each tick", repeats=Counter({7: 3}))
    assert outcome is Outcome.MET
    assert "that of 7 after 3 repetitions of SYNC" in text


def test_a_boot_in_tick_0_was_asked_for_and_a_later_one_is_a_restart():
    assert told("does not restart", boots=[-1, 0])[0] is Outcome.MET
    assert broken("does not restart", boots=[-1, 50, 90]).endswith(
        "FSW_BOOT in tick 50, after 50 s, and 1 more"
    )


def test_broken_frames_and_counters_are_told():
    frame = Frame(0x80, bytes.fromhex("E5010764B80B00"))
    text = broken("sends whole frames", broken=Counter(COIL_FIRE=3), first_broken={"COIL_FIRE": (9, frame)})
    assert text == "3 frames of COIL_FIRE not whole, first 080#E5010764B80B00 in tick 9"
    text = broken("sends whole frames", counters=Counter(NAV_RATE=2))
    assert text == "the counter of NAV_RATE does not rise by one, 2 times"


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (
            request(100, CoilRefusedReason.BAD_DURATION, duration_ms=3100),
            "a pulse of 3.1 s, the longest pulse is 3 s",
        ),
        (request(100, CoilRefusedReason.BAD_DURATION, duration_ms=0xB80B), "it is 3000 ms with its bytes"),
        (request(100, CoilRefusedReason.WRONG_TICK, tick=99), "it names tick 99 and not 100 (wrong_tick)"),
        (request(100, CoilRefusedReason.REPEATED_SEQ, seq=4), "seq 4 is that of the last accepted one"),
        (request(100, CoilRefusedReason.BAD_COIL, coil=3), "there is no coil 3"),
        (request(100, CoilRefusedReason.BAD_LEVEL, level=-4), "there is no level -4"),
        (request(100, CoilRefusedReason.COIL_ON), "a coil is on"),
    ],
)
def test_what_must_not_be_asked_is_told(wrong, words):
    text = broken("asks within limits", requests=[wrong, request(203)])
    assert text.startswith("1 request of 2 against the limits, first in tick 100")
    assert words in text


def test_a_back_off_that_is_not_waited_out_is_told_with_its_length():
    early = [request(100), request(202, CoilRefusedReason.LOCKOUT)]
    text = broken("waits out the back-off", requests=early)
    assert text == (
        "1 request of 2 in the back-off, first in tick 202, "
        "99 s after the end of a pulse: the back-off is 100 s"
    )
    text = broken("waits out the back-off", requests=[request(60, CoilRefusedReason.LOCKOUT)])
    assert "60 s after the board's boot" in text


def test_with_a_back_off_per_coil_the_same_coil_counts():
    early = [request(100, coil=1), request(110, coil=2), request(190, CoilRefusedReason.LOCKOUT, coil=1)]
    text = broken("waits out the back-off", requests=early, settings=("coils.backoff=per_coil",))
    assert "87 s after the end of a pulse" in text


def test_requests_with_a_stuck_coil_are_told_after_a_second():
    late = [
        request(100, CoilRefusedReason.COIL_ON, stuck=True),
        request(203, CoilRefusedReason.COIL_ON, stuck=True),
    ]
    assert told("heeds a stuck coil", requests=late[:1], stuck_at=99)[0] is Outcome.MET
    assert "1 request came after it, first in tick 203" in broken(
        "heeds a stuck coil", requests=late, stuck_at=99
    )


def test_what_comes_of_a_fault_is_not_its_own():
    fault = 'fault=[{kind="loss", at_s=10.0}]'
    refused = [request(100, CoilRefusedReason.WRONG_TICK, tick=99), request(110, CoilRefusedReason.LOCKOUT)]
    options = {"settings": (fault,), "faulty": True, "counters": Counter(NAV_RATE=2), "odd_done": [(5, 9)]}
    assert told("asks within limits", requests=refused, **options)[0] is Outcome.MET
    garbled = [request(100, CoilRefusedReason.BAD_COIL), request(203, CoilRefusedReason.BAD_DURATION)]
    assert told("asks within limits", requests=garbled, **options)[0] is Outcome.MET


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"duration_ms": 3100}, "a pulse of 3.1 s"),
        ({"coil": 3}, "there is no coil 3"),
        ({"level": 4}, "there is no level 4"),
    ],
)
def test_under_faults_a_request_is_judged_as_it_was_sent_whatever_the_board_received(values, words):
    fault = ('fault=[{kind="corruption", at_s=10.0}]',)
    told_of = broken("asks within limits", requests=[request(100, **values)], settings=fault, faulty=True)
    assert words in told_of


def test_a_stuck_coil_is_not_believed_where_a_fault_alters_what_the_board_reports():
    late = [request(203, CoilRefusedReason.COIL_ON, stuck=True)]
    outcome, _ = told("heeds a stuck coil", requests=late, stuck_at=99, faulty=True, driven=DrivenLimits())
    assert outcome is Outcome.NOT_JUDGED


def test_limits_are_those_of_the_audit_or_of_what_flowed():
    failures = {"limits": "the limits are broken once"}
    assert broken("limits kept", failures=failures) == "the limits are broken once"
    assert told("limits kept", failures=failures, driven=DrivenLimits())[0] is Outcome.MET
    too_long = DrivenLimits("driven for 5 s")
    assert broken("limits kept", driven=too_long) == "by the currents that flowed: driven for 5 s"
    unknown = DrivenLimits(unjudged="the fault drives a coil")
    assert told("limits kept", failures=failures, driven=unknown)[0] is Outcome.NOT_JUDGED


def test_a_second_sender_is_told_unless_the_scenario_forges():
    sender = [{"message": "SYNC", "id": "180", "tick": 7, "frames": 1}]
    text = broken("alone on the bus", run={"second_senders": sender})
    assert text == "a second sender is on the bus: SYNC (180) at tick 7"
    forged = ('fault=[{kind="second_sender", at_s=10.0}]',)
    outcome, _ = told("alone on the bus", run={"second_senders": sender}, settings=forged)
    assert outcome is Outcome.NOT_JUDGED


STARTED = {"flight_software": {"command": "./firmware", "profile": "actuator"}}
RUNS_ALREADY = {"flight_software": {"command": None, "profile": "actuator"}}
FIRES = {"second_senders": [{"message": "COIL_FIRE", "id": "080", "tick": 7, "frames": 1}]}


@pytest.mark.parametrize(
    ("out_of_turn", "words"),
    [
        (OutOfTurn(7, "COIL_FIRE", True), "a late request in tick 7: COIL_FIRE comes after TICK_DONE(7)"),
        (OutOfTurn(7, "COIL_FIRE", False), "two requests in tick 7: COIL_FIRE comes twice in its answer"),
        (OutOfTurn(7, "NAV_RATE", True), "late in tick 7: NAV_RATE comes after TICK_DONE(7)"),
        (OutOfTurn(7, "NAV_RATE", False), "twice in the answer to tick 7: NAV_RATE"),
    ],
)
@pytest.mark.parametrize("run", [STARTED, RUNS_ALREADY])
def test_what_comes_out_of_turn_is_named_and_no_second_sender(out_of_turn, words, run):
    senders = FIRES if out_of_turn.name == "COIL_FIRE" else {}
    assert broken("sends in its turn", run=run | senders, out_of_turn=[out_of_turn]) == words
    assert broken("sends in its turn", run=run, out_of_turn=[out_of_turn] * 3) == f"{words}, and 2 more"


def test_where_others_may_be_on_the_bus_and_the_counter_does_not_go_on_it_is_a_second_sender():
    late = {"out_of_turn": [OutOfTurn(7, "COIL_FIRE", True)], "counters": Counter(COIL_FIRE=2)}
    found = {one.name: one for one in judge_invariants(record(run=RUNS_ALREADY | FIRES, **late))}
    assert found["alone on the bus"].text == "a second sender is on the bus: COIL_FIRE (080) at tick 7"
    assert found["sends in its turn"].outcome is Outcome.MET


def test_an_estimate_is_asked_of_the_profile_that_promises_it():
    assert told("tells its estimate", estimates=0)[0] is Outcome.NOT_JUDGED
    text = broken("tells its estimate", estimates=7, profile=Profile.ATTITUDE)
    assert text == f"NAV_ATTITUDE in 7 of {TICKS} answers"


def test_a_wrong_attitude_is_told_when_it_lasts():
    sound, wrong = WrongAttitude(100.0, 9.0), WrongAttitude(200.0, 31.0)
    assert told("is honest", profile=Profile.ATTITUDE, wrong=sound)[0] is Outcome.MET
    assert "for 200 s on end and up to 31 deg" in broken("is honest", profile=Profile.ATTITUDE, wrong=wrong)
    assert told("is honest")[0] is Outcome.NOT_JUDGED


def test_the_mistake_of_an_attitude_is_told_with_it():
    wrong = WrongAttitude(200.0, 31.0, mistake="it is the conjugate")
    assert broken("is honest", profile=Profile.ATTITUDE, wrong=wrong).endswith(" deg: it is the conjugate")


def test_a_wrong_rate_is_told_when_it_lasts():
    def verdict(rate):
        flight = record(profile=Profile.ATTITUDE)._replace(wrong_rate=rate)
        return {one.name: one for one in judge_invariants(flight)}["its rate is true"]

    assert verdict(None).outcome is Outcome.NOT_JUDGED
    assert verdict(WrongRate(100.0, 0.2)).outcome is Outcome.MET
    wrong = verdict(WrongRate(200.0, 0.2, "its sign is wrong"))
    assert wrong.outcome is Outcome.FAILED
    assert wrong.text.endswith("for 200 s on end and up to 0.2 deg/s: its sign is wrong")


def test_a_continuous_driver_has_no_back_off():
    names = {one.name: one for one in judge_invariants(record()._replace(scenario=load("detumble3u")))}
    assert names["waits out the back-off"].outcome is Outcome.NOT_JUDGED
    fired = record(requests=[request(5)])._replace(scenario=load("detumble3u"))
    names = {one.name: one for one in judge_invariants(fired)}
    assert names["asks within limits"].outcome is Outcome.FAILED
