"""``torquer new``: options, and questions where they are left out on a terminal."""

import pytest

from sim.errors import HarnessError
from sim.scenario.schema import load
from torquer.cli import satellite_options
from torquer.cli.main import main
from torquer.cli.satellite_options import asked, satellite, tle_lines

MISSING = ("altitude_km", "inclination_deg", "mass_kg", "size_m", "inertia_kgm2", "levels_am2", "dipole_am2")
NOTHING = dict.fromkeys((*MISSING, "axes")) | {"driver": "pulsed", "sun": "sensor"}
TLE = load("microsat").orbit.tle
OTHER = (
    "1 42680U 16049E   17100.50000000  .00000218  00000-0  80444-4 0  9999",
    "2 42680  98.3668 218.4259 0018140 186.3838 173.7123 14.41455213 48482",
)


def answered(monkeypatch, *answers, tle=None, **given):
    """What is asked for, with these answers."""
    left = list(answers)
    monkeypatch.setattr("click.termui.visible_prompt_func", lambda prompt: left.pop(0))
    found = asked({**NOTHING, **given}, tle)
    assert left == []
    return found


def test_enter_takes_what_is_usual(monkeypatch):
    found, tle = answered(monkeypatch, *9 * [""])
    assert tle is None
    assert found == {
        "altitude_km": 550.0,
        "inclination_deg": 97.6,
        "mass_kg": 4.0,
        "size_m": (0.34, 0.1, 0.1),
        "inertia_kgm2": None,
        "levels_am2": None,
        "dipole_am2": None,
        "axes": None,
        "driver": "pulsed",
        "sun": "sensor",
    }


def test_what_is_no_answer_is_asked_for_again(monkeypatch, capsys):
    body = ("1 2", "1, 1.9, 2", "z z x", "y x z")
    coils = ("maybe", "continuous", "strong", "-1", "8")
    found, _ = answered(monkeypatch, "", "high", "600", "97", *body, *coils, "moon", "cells")
    assert (found["inertia_kgm2"], found["axes"]) == ((1.0, 1.9, 2.0), ("y", "x", "z"))
    assert (found["driver"], found["dipole_am2"], found["sun"]) == ("continuous", 8.0, "cells")
    out = capsys.readouterr().out
    assert "three numbers are needed" in out
    assert "'z z x': x, y and z are needed, each once" in out
    assert "'-1': a positive number is needed" in out


def test_a_file_without_a_tle_is_asked_for_again_at_once(monkeypatch, capsys, tmp_path):
    file = tmp_path / "x.tle"
    file.write_text("\n".join(TLE))
    _, tle = answered(monkeypatch, "550", str(file), "1 1.9 2", "", "", "", "")
    assert tle == file
    assert "550: cannot be read (No such file or directory)" in capsys.readouterr().out


def test_nothing_is_asked_that_was_given(monkeypatch):
    given = {"altitude_km": 600.0, "inclination_deg": 50.0, "inertia_kgm2": (1.0, 2.0, 2.0)}
    assert answered(monkeypatch, **given) == ({**NOTHING, **given}, None)


def test_a_tle_has_two_lines_or_three(tmp_path):
    file = tmp_path / "x.tle"
    file.write_text("ITAMSAT\n" + "\n".join(TLE) + "\n")
    assert tle_lines(file) == TLE
    for text, sentence in (
        (TLE[0], "after line 1 its second element line is missing"),
        ("\n".join(TLE).replace("15086", "15087"), "checksum"),
        ("ä\nb", "there is no two-line element set in it"),
        ("\n".join((*TLE, *OTHER)), "sets of 2 satellites"),
    ):
        file.write_text(text)
        with pytest.raises(HarnessError, match=sentence):
            tle_lines(file)
    with pytest.raises(HarnessError, match="No such file"):
        tle_lines(tmp_path / "none")


@pytest.mark.parametrize(
    ("tle", "given"),
    [("x", {"altitude_km": 500.0}), (None, {"inertia_kgm2": (1.0,) * 3, "size_m": (1.0,) * 3})],
)
def test_what_contradicts_is_refused(tle, given):
    with pytest.raises(HarnessError, match="exclude each other"):
        satellite("mine", tle, {**NOTHING, **given})


def test_axes_may_be_written_in_capitals():
    given = {"inertia_kgm2": (0.03, 0.04, 0.01), "axes": ("Z", "X", "Y"), "altitude_km": 500.0}
    assert satellite("mine", None, {**NOTHING, **given}).moments_kgm2 == (0.01, 0.03, 0.04)


def test_without_a_terminal_nothing_is_asked(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(satellite_options, "asked", lambda *given: pytest.fail("asked"))
    with pytest.raises(SystemExit) as ended:
        main.main(["new", "mine"], prog_name="torquer")
    assert ended.value.code == 2
    assert capsys.readouterr().err.startswith("torquer: give ")
    assert list(tmp_path.iterdir()) == []
