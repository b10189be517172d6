"""``torquer.replay``: the command's verdict, as a value."""

import pytest

import torquer
from fsw.wire.messages import NavRate


def test_it_says_what_the_command_prints(flown, command):
    report = torquer.replay(flown.path)
    done = command("replay", flown.path)
    assert (done.exit_code, done.stdout) == (0, f"{report}\n")
    assert report.ok
    assert report.result.bit_exact


def test_through_the_plant(flown, command):
    report = flown.replay(plant=True)
    assert report.ok
    assert report.lines == ("plant reproduced: 302 ticks, every frame equal",)
    assert command("replay", flown.path, "--plant").stdout == f"{report}\n"


def test_through_the_plant_or_onto_a_bus(flown):
    with pytest.raises(torquer.InputError, match="plant, and onto loop: a replay is one or the other"):
        torquer.replay(flown.path, plant=True, onto="loop")


def test_it_tells_the_first_tick_that_differs(copy, command):
    lines = copy.log.read_text().splitlines(keepends=True)
    place = next(place for place, line in enumerate(lines) if f" {NavRate.ID:03X}#" in line)
    copy.log.write_text("".join(lines[:place] + lines[place + 1 :]))
    report = copy.replay()
    assert not report.ok
    assert report.lines[0].startswith("differs: tick ")
    assert command("replay", copy.path).exit_code == 1


def test_a_bare_log_takes_a_scenario_and_settings(flown, tmp_path):
    log = tmp_path / "bare.log"
    log.write_bytes(flown.log.read_bytes())
    with pytest.raises(torquer.InputError, match=r"scenario\.toml"):
        torquer.replay(log)
    assert torquer.replay(log, scenario="microsat").ok
    wrong = {"flight.body.inertia_kgm2": [1.0, 2.0, 2.5]}
    assert not torquer.replay(log, scenario="microsat", set=wrong).ok
