"""Which flights differ between two versions."""

import pytest
import same_flights
from same_flights import different, main, scenarios, without_state_crc

from fsw.wire.messages import TickDone


@pytest.fixture(autouse=True)
def no_export(monkeypatch):
    if_real = same_flights.exported
    monkeypatch.setattr(
        same_flights, "exported", lambda commit, folder: None if commit == "HEAD" else if_real(commit, folder)
    )


def flights_of(before, now):
    digests = iter((before, now))
    return lambda tree, orbits, workers, state_crc: next(digests)


@pytest.mark.parametrize(
    ("before", "now", "names"),
    [
        ({"a": "1", "b": "2"}, {"a": "1", "b": "2"}, []),
        ({"a": "1", "b": "2"}, {"a": "1", "b": "3"}, ["b"]),
        ({"a": "1"}, {"a": "1", "b": "2"}, ["b"]),
        ({"a": "1", "b": "2"}, {"b": "2"}, ["a"]),
    ],
)
def test_a_flight_differs_by_its_digest_or_where_one_version_lacks_it(before, now, names):
    assert different(before, now) == names


def test_flights_that_differ_are_named(capsys):
    fly = flights_of({"microsat": "1", "posat1": "1"}, {"microsat": "1", "posat1": "2"})
    assert main(["HEAD"], fly) == 1
    assert capsys.readouterr().out == "differs: posat1\n1 of 2 flights differ\n"


def test_the_same_flights_are_counted(capsys):
    assert main(["HEAD"], flights_of({"microsat": "1"}, {"microsat": "1"})) == 0
    assert "1 flight the same byte for byte as by HEAD" in capsys.readouterr().out


def test_without_the_crc_of_the_state_logs_differ_by_every_other_frame():
    log = b"(1.000000) virtual 100#AABB\n(1.000000) virtual %03X#01000000DEADBEEF\n" % TickDone.ID
    assert without_state_crc(log) == without_state_crc(log.replace(b"DEADBEEF", b"00000000"))
    assert without_state_crc(log) != without_state_crc(log.replace(b"#01", b"#02"))
    assert without_state_crc(log) != without_state_crc(log.replace(b"AABB", b"AABC"))


def test_the_fault_that_flips_bits_of_the_state_is_left_out_with_its_layout(monkeypatch):
    monkeypatch.setattr(same_flights, "flown", lambda tree, name, orbits, state_crc: "1")
    monkeypatch.setattr(same_flights, "faults", lambda tree: {"fault bit-flip": "2", "fault open-coil": "3"})
    tree = same_flights.ROOT
    assert "fault bit-flip" in same_flights.flights(tree, 1.0, 1)
    found = same_flights.flights(tree, 1.0, 1, state_crc=False)
    assert "fault bit-flip" not in found
    assert found["fault open-coil"] == "3"


def test_every_scenario_that_ships_is_flown():
    assert {"microsat", "realsat", "spinner"} <= set(scenarios(same_flights.ROOT))


def test_no_commit_is_one_sentence(capsys):
    assert main(["no-such-commit"]) == 2
    assert capsys.readouterr().err.startswith("same_flights: fatal: ")


@pytest.mark.long
@pytest.mark.slow
def test_a_flight_has_the_same_digest_again_and_another_with_more_orbits():
    digest = same_flights.flown(same_flights.ROOT, "microsat", 0.01)
    assert same_flights.flown(same_flights.ROOT, "microsat", 0.01) == digest
    assert same_flights.flown(same_flights.ROOT, "microsat", 0.02) != digest


@pytest.mark.long
def test_a_fault_has_the_same_digest_again_and_is_not_another_one():
    first, again = (same_flights.faults(same_flights.ROOT, ["none", "mag-nan"]) for _ in range(2))
    assert first == again
    assert first["fault none"] != first["fault mag-nan"]


def test_the_time_a_computer_takes_is_no_figure_at_any_depth():
    row = {"cases": [{"wall_s": 1.5, "figures": {"worst step ms": 3.0, "pulses": 7}}], "code": "0123"}
    assert same_flights.figures(row) == {"cases": [{"figures": {"pulses": 7}}]}
