"""A sound firmware passes, and planted mistakes are told, each in words and by the rule it breaks."""

import dataclasses
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from sim.judge.flight import LEAST_BRAKING, fly_and_judge
from sim.judge.profile import Profile
from sim.judge.render import failed_text, verdict_json, verdict_page, verdict_text
from sim.report.requirements.judge import Outcome
from sim.scenario.schema import load

pytestmark = pytest.mark.long

FIRMWARE = Path(__file__).with_name("firmware.py")
TUMBLER = str(Path(__file__).with_name("tumbler.toml"))
STUCK = {"fault": [{"kind": "coil_stuck_on", "at_s": 1500.0, "parameters": {"axis": 1.0, "ampere": 0.4}}]}


def broken(flight):
    return {one.name: one.text for one in flight.invariants if one.outcome is Outcome.FAILED}


def missed(flight):
    return [one["id"] for one in flight.requirements if one["verdict"] == "failed"]


@pytest.mark.parametrize("mistake", ["", "modelled"])
@pytest.mark.slow
def test_a_sound_one_passes(flown, mistake):
    flight = flown(mistake)
    assert flight.ok
    assert broken(flight) == {}
    assert [one["verdict"] for one in flight.requirements] == ["met"]
    assert flight.reasons == []
    assert flight.law.brakes > 0.6
    assert failed_text(flight) == ""


@pytest.mark.slow
def test_a_sign_error_is_named(flown):
    flight = flown("sign")
    assert missed(flight) == ["RATE"]
    assert list(broken(flight)) == ["brakes the body"]
    assert flight.law.work_j > 0.0
    (why,) = flight.reasons
    assert why.startswith("a sign error: its dipoles speed the body up instead of braking it")
    assert why in failed_text(flight)
    assert why in verdict_text(flight)
    assert f"A{why[1:]}." in verdict_page(flight)
    assert verdict_json(flight)["reasons"] == [why]


@pytest.mark.slow
def test_swapped_axes_are_named(flown):
    flight = flown("axes")
    assert missed(flight) == ["RATE"]
    (why,) = flight.reasons
    assert why.startswith("the axes x and y are swapped: ")


@pytest.mark.slow
def test_a_wrong_epoch_of_its_field_model_is_named(flown):
    flight = flown("epoch")
    assert missed(flight) == ["RATE"]
    (why,) = flight.reasons
    assert why.startswith("a wrong epoch: its field is the one of about 1834 s later")  # it was 1800


def test_a_pulse_of_3_1_s_is_told(flown):
    flight = flown("long", orbits=0.1)
    text = broken(flight)["asks within limits"]
    assert text.endswith("a pulse of 3.1 s, the longest pulse is 3 s")
    assert list(broken(flight)) == ["asks within limits"]


def test_a_back_off_of_99_s_is_told(flown):
    flight = flown("early", orbits=0.3)
    assert list(broken(flight)) == ["waits out the back-off"]
    assert "99 s after the board's boot: the back-off is 100 s" in broken(flight)["waits out the back-off"]


def test_a_wrong_byte_order_is_told(flown):
    flight = flown("order", orbits=0.1)
    text = broken(flight)["asks within limits"]
    assert "the byte order is wrong, it is 3000 ms with its bytes the other way round" in text


@pytest.mark.slow
def test_a_field_that_is_read_in_the_wrong_byte_order_is_named(flown):
    flight = flown("bytes")
    assert missed(flight) == ["RATE"]
    (why,) = flight.reasons
    assert why.startswith("the byte order of MAG_FIELD is wrong: it is read the other way round: ")


@pytest.mark.slow
def test_a_field_that_is_read_as_unsigned_is_named(flown):
    flight = flown("unsigned")
    assert list(broken(flight)) == ["brakes the body"]
    (why,) = flight.reasons
    assert why.startswith("MAG_FIELD is read as unsigned: ")


@pytest.mark.slow
def test_a_law_that_hardly_brakes_is_told_with_the_least_figure(flown):
    flight = flown("axes", orbits=0.5)
    assert 0.0 < flight.law.brakes < LEAST_BRAKING
    assert "a law that brakes has 0.4 at least" in broken(flight)["brakes the body"]


@pytest.mark.slow
def test_a_stuck_coil_that_goes_on_being_fired_is_told(flown):
    flight = flown("stuck", orbits=0.5, settings=STUCK)
    assert list(broken(flight)) == ["heeds a stuck coil"]
    assert "it goes on firing with a stuck coil" in broken(flight)["heeds a stuck coil"]


@pytest.mark.slow
def test_one_that_heeds_it_is_not_blamed(flown):
    flight = flown("", orbits=0.5, settings=STUCK)
    assert broken(flight) == {}
    heeds = next(one for one in flight.invariants if one.name == "heeds a stuck coil")
    assert heeds.outcome is Outcome.MET


@pytest.mark.paced
@pytest.mark.parametrize(
    ("mistake", "words"),
    [
        ("boot-crc", "510#00010000000005, with a wrong CRC, expected 510#00010000000004"),
        ("boot-short", "510#000100000000, of 6 bytes and not of 7, as in 510#00010000000004"),
        ("boot-extended", "00000510#00010000000004: bit 31 of its identifier makes it an"),
    ],
)
def test_a_boot_that_is_not_heard_is_told_with_what_is_wrong(flown, mistake, words):
    flight = flown(mistake, orbits=0.05, boot_s=1.5)
    assert list(broken(flight)) == ["flies to its end"]
    end = broken(flight)["flies to its end"]
    assert "the flight software has not booted within 2 s" in end
    assert words in end


@pytest.mark.parametrize(
    ("mistake", "words"),
    [
        ("done-next", "TICK_DONE names tick 1 in the answer to tick 0: the one after it"),
        ("done-order", "TICK_DONE names tick 16777216 in the answer to tick 1: the byte order is wrong"),
    ],
)
def test_a_tick_done_of_another_tick_is_told(flown, mistake, words):
    flight = flown(mistake, orbits=0.05, answer_s=1.0)
    assert words in broken(flight)["flies to its end"]
    assert words in failed_text(flight)


@pytest.mark.parametrize(
    ("mistake", "words"),
    [
        ("done-next", "TICK_DONE names tick 1 in the answer to tick 0: the one after it"),
        ("boot-gives-up", "510#00010000000005, with a wrong CRC, expected 510#00010000000004"),
    ],
)
def test_one_that_gives_up_before_the_plant_does_is_told_what_it_sent(flown, mistake, words):
    flight = flown(mistake, orbits=0.05, answer_s=30.0, boot_s=30.0, patience_s="0.6")
    end = broken(flight)["flies to its end"]
    assert "the flight software ended with exit code 1 at tick 0" in end
    assert words in end
    assert end.endswith("the last that it printed is: the plant does not go on")


@pytest.mark.parametrize(
    ("mistake", "words"),
    [
        ("late", "a late request in tick {0}: COIL_FIRE comes after TICK_DONE({0})"),
        ("twice", "two requests in tick {0}: COIL_FIRE comes twice in its answer"),
    ],
)
def test_a_request_out_of_turn_is_told_and_is_no_second_sender(flown, mistake, words):
    flight = flown(mistake, orbits=0.06)
    told = broken(flight)
    first = flight.record.answers.out_of_turn[0].tick
    assert told["sends in its turn"].startswith(words.format(first))
    assert "alone on the bus" not in told


@pytest.mark.slow
def test_a_hang_of_10_s_is_told_where_time_counts(flown):
    flight = flown("hang", orbits=0.04, hang_s="0.52", pace="realtime:20")
    text = broken(flight)["answers each tick"]
    assert text.startswith("it hung for 10 to 11 s at tick 150: tick 150 was answered in tick 16")


@pytest.mark.slow
def test_in_lockstep_a_hang_is_noted_and_not_blamed(flown):
    flight = flown("hang", orbits=0.04, hang_s="2.5")
    assert broken(flight) == {}
    answers = next(one for one in flight.invariants if one.name == "answers each tick")
    assert "that of 150 after 1 repetition of SYNC" in answers.text


@pytest.mark.slow
def test_a_restart_is_told(flown):
    flight = flown("restart", orbits=0.2)
    assert broken(flight) == {"does not restart": "it restarted in flight: FSW_BOOT in tick 700, after 700 s"}


@pytest.mark.slow
def test_a_bus_that_is_dead_after_an_hour_is_told(flown):
    flight = flown("dead", answer_s=3.0)
    assert list(broken(flight)) == ["flies to its end"]
    end = broken(flight)["flies to its end"]
    assert "3600 of 6052 ticks were flown: no answer from the flight software to tick 3600 within 3 s" in end
    assert [one["verdict"] for one in flight.requirements] == ["not judged"]


def test_one_that_ends_is_told_with_its_last_words(flown):
    flight = flown("hang", orbits=0.05, hang_s="soon")
    end = broken(flight)["flies to its end"]
    assert "the flight software ended with exit code 1 at tick 149" in end
    assert end.endswith("ValueError: could not convert string to float: 'soon'")


def test_what_a_profile_does_not_give_is_not_asked(flown):
    pointing = [{"index": "ape", "at_most_deg": 1.0, "last_orbits": 0.1, "by_orbit": 0.1}]
    knowing = [{"index": "ake", "at_most_deg": 1.0, "last_orbits": 0.1, "by_orbit": 0.1}]
    flight = flown("", orbits=0.1, settings={"requirement": pointing + knowing})
    assert [one["text"] for one in flight.requirements] == [
        "APE: not judged, the profile detumble does not point",
        "AKE: not judged, the profile detumble gives no estimate",
    ]
    assert flight.ok


def test_one_that_promises_an_estimate_must_give_it(flown):
    flight = flown("", orbits=0.05, profile=Profile.ATTITUDE)
    assert broken(flight) == {"tells its estimate": "NAV_ATTITUDE in 0 of 303 answers"}


def test_one_that_waits_for_the_hub_connects_once(tmp_path, firmware):
    """The hub of a bus that nobody serves is opened once for the flight."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    waits = subprocess.Popen([sys.executable, str(FIRMWARE), str(port)])
    try:
        software = dataclasses.replace(firmware(), command=None, bus=f"loop:{port}")
        flight = fly_and_judge(software, load(TUMBLER), 1, tmp_path / "run", 0.1)
        assert flight.ok
        assert waits.wait(10.0) == 0
    finally:
        waits.kill()


@pytest.mark.parametrize("mistake", ["", "long"])
@pytest.mark.slow
def test_one_that_runs_already_is_judged_where_it_is(running, tmp_path, mistake):
    software = running(mistake)
    flight = fly_and_judge(software, load(TUMBLER), 1, tmp_path / "run", 0.1)
    assert flight.ok is (mistake == "")
    assert flight.record.run["flight_software"] == {"command": None, "profile": "detumble"}
    assert "what runs on loop" in verdict_text(flight)
