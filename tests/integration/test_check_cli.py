"""``torquer check`` on logs of real flights: accepted, and refused once a limit is broken in a copy."""

import re
import shutil

import pytest

from fsw.wire.messages import CoilStatus, PlantEnd

SHARED_10HZ = (
    ("microsat", "--seed", "3", "--orbits", "0.036", "--set", "time.tick_hz=10", "--bus", "virtual"),
    10,
)
PER_COIL = (("cubesat3u", "--orbits", "0.05", "--set", "coils.backoff=per_coil", "--bus", "virtual"), 1)
SHARED_1HZ = (("microsat", "--seed", "7", "--orbits", "0.05", "--bus", "loop"), 1)
FLIGHTS = {"shared 10 Hz": SHARED_10HZ, "per coil 1 Hz": PER_COIL, "shared 1 Hz": SHARED_1HZ}


@pytest.fixture(params=FLIGHTS.values(), ids=FLIGHTS)
def flight(request, sil_run):
    """A flight with at least two pulses, and its tick rate."""
    arguments, tick_hz = request.param
    return sil_run(*arguments), tick_hz


@pytest.fixture
def at_10hz(sil_run, copy_of):
    """A copy of a flight at 10 Hz, shared back-off."""
    return copy_of(sil_run(*SHARED_10HZ[0]))


def pulses(copy):
    """For each pulse: coil, level, first and last index of the COIL_STATUS that show it driven."""
    found, before = [], 0
    for index in copy.where(CoilStatus):
        status = CoilStatus.decode(copy.entries[index][2].data)
        if status.level and not before:
            found.append([status.coil, status.level, index, index])
        elif status.level:
            found[-1][3] = index
        before = status.level
    return found


def statuses(copy, index, steps):
    """Index of the COIL_STATUS so many ticks later."""
    places = copy.where(CoilStatus)
    return places[places.index(index) + steps]


def time_s(copy, index):
    return (copy.entries[index][0] - copy.entries[0][0]) / 1e6


def violations(done):
    """(time, coil, sentence) of each violation that a check tells."""
    assert (done.code, done.err) == (1, "")
    lines = [line for line in done.out.splitlines() if line.startswith("VIOLATION ")]
    found = [
        re.fullmatch(r"VIOLATION t=([\d.]+) s \(tick \d+\) coil (\d): (.*) \[line \d+\]", x) for x in lines
    ]
    assert all(found), done.out
    assert re.search(rf"^FAIL: {len(lines)} violation", done.out, re.MULTILINE)
    return [(float(match[1]), int(match[2]), match[3]) for match in found]


@pytest.mark.long
def test_a_flight_is_accepted(flight, torquer):
    run, _ = flight
    for which in (run, run / "bus.log"):
        done = torquer("check", which)
        assert (done.code, done.err) == (0, "")
        assert done.out.endswith("OK: limits kept\n")


@pytest.mark.long
def test_a_bare_log_is_judged_by_the_back_off_named(flight, torquer, tmp_path):
    run, _ = flight
    bare = shutil.copy(run / "bus.log", tmp_path)
    shared = "per_coil" not in (run / "scenario.toml").read_text()
    assert torquer("check", bare, "--backoff", "per_coil").code == 0
    assert torquer("check", bare, "--backoff", "shared").code == (0 if shared else 1)
    assert torquer("check", bare).code == (0 if shared else 1)
    done = torquer("check", bare, "--backoff", "none")
    assert done.code == 2
    assert "--backoff" in done.sentence


@pytest.mark.long
def test_a_pulse_of_3_1_s(at_10hz, torquer):
    coil, level, first, last = pulses(at_10hz)[0]
    after = statuses(at_10hz, last, 1)
    at_10hz.change(after, level=level, coil=coil, remaining_ms=0)
    found = violations(torquer("check", at_10hz.write()))
    start_s = time_s(at_10hz, first) - 0.1
    assert (pytest.approx(start_s), coil) in [(when, which) for when, which, _ in found]
    assert any("3.100 s" in sentence for _, _, sentence in found)


@pytest.mark.long
def test_a_gap_of_99_9_s(at_10hz, torquer):
    """The second pulse as it was flown, but sooner."""
    (_, _, _, last), (coil, _, first, end) = pulses(at_10hz)[:2]
    places = at_10hz.where(CoilStatus)
    begins_s = time_s(at_10hz, last) + 99.9
    sooner = round(10.0 * (time_s(at_10hz, first) - 0.1 - begins_s))
    driven = places[places.index(first) : places.index(end) + 1]
    values = [CoilStatus.decode(at_10hz.entries[index][2].data).by_name() for index in driven]
    for index in driven[-sooner:]:
        at_10hz.change(index, level=0)
    for index, status in zip(driven, values, strict=True):
        del status["counter"]
        at_10hz.change(statuses(at_10hz, index, -sooner), **status)
    (found,) = violations(torquer("check", at_10hz.write()))
    assert found[:2] == (pytest.approx(begins_s), coil)
    assert "99.900 s" in found[2]


@pytest.mark.long
@pytest.mark.parametrize("level", [4, -4, 7, -8])
def test_a_level_there_is_not(level, flight, copy_of, torquer):
    run, tick_hz = flight
    copy = copy_of(run)
    coil, _, first, last = pulses(copy)[1]
    for index in copy.where(CoilStatus):
        if first <= index <= last:
            copy.change(index, level=level)
    found = violations(torquer("check", copy.write()))
    assert any(
        time_s(copy, first) - 1 / tick_hz <= when <= time_s(copy, last)
        and which == coil
        and f"level {level}" in sentence
        for when, which, sentence in found
    )


@pytest.mark.long
def test_two_coils_at_once(flight, copy_of, torquer):
    run, tick_hz = flight
    copy = copy_of(run)
    coil, level, first, _ = pulses(copy)[0]
    other = list(copy.entries[first])
    copy.entries.insert(first + 1, other)
    copy.change(first + 1, coil=(coil + 1) % 3, level=-level)
    found = violations(torquer("check", copy.write()))
    at_once = [which for when, which, _ in found if when == pytest.approx(time_s(copy, first) - 1 / tick_hz)]
    assert set(at_once) & {coil, (coil + 1) % 3}
    assert "two coils" in torquer("check", copy.folder).out


@pytest.mark.long
def test_a_status_that_fails_its_crc(flight, copy_of, torquer):
    copy = copy_of(flight[0])
    index = pulses(copy)[0][2]
    frame = copy.entries[index][2]
    copy.entries[index][2] = frame.replace(data=bytes((frame.data[0] ^ 0x10,)) + frame.data[1:])
    done = torquer("check", copy.write())
    assert done.code == 1
    assert "CRC" in done.out


@pytest.mark.long
def test_a_log_without_its_end_is_incomplete(flight, copy_of, torquer):
    copy = copy_of(flight[0])
    assert copy.entries.pop()[2].can_id == PlantEnd.ID
    done = torquer("check", copy.write())
    assert done.code == 1
    assert "VIOLATION" not in done.out
    assert "incomplete" in done.out.splitlines()[-1]


@pytest.mark.long
def test_what_the_controller_says_is_no_evidence(flight, copy_of, torquer):
    """Judged is what was driven: without the frames of fsw the verdict and its figures are the same."""
    run, _ = flight
    copy = copy_of(run)
    copy.entries = [entry for entry in copy.entries if not 0x200 <= entry[2].can_id < 0x280]
    assert torquer("check", copy.write()).out == torquer("check", run).out
