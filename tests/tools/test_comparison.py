"""The page of ``make comparison``, from invented figures, what is flown again, and when the tool fails."""

import json
from dataclasses import asdict, replace

import comparison
import pytest
from comparison import SATELLITES, compared, main, page, record_path, state_of

from fsw.core.laws.entry import Aim
from sim.compare.case import Driver
from sim.compare.command import yardstick
from sim.compare.score import Score
from sim.scenario.schema import load
from sim.tuning.kept import FOLDER

GOOD = Score(
    "pd", Aim.THREE_AXIS, Driver.PULSED, 1.5, 1.25, 2.5, 0.001, 4000.0, 70, 0.02, "POINT", True, tuned=True
)
BETTER = replace(GOOD, law="mpc", error_rms=0.5, dipole_squared_a2m4s=9000.0)
LOOSE = replace(GOOD, law="sliding", settle_orbits=None, error_rms=0.75, dipole_squared_a2m4s=10.0)
GENTLE = replace(GOOD, law="lqr", driver=Driver.CONTINUOUS, pulses=None, error_rms=0.125)
GROUNDED = Score("sdre", Aim.THREE_AXIS, Driver.CONTINUOUS, failure="it needs a wheel")


def record_of(name, *scores, state=None):
    by = yardstick(load(name))._asdict()
    return {
        "judged": by,
        "sim_seconds": 60413.0,
        "rows": [asdict(score) for score in scores],
        "state": state_of(name) if state is None else state,
    }


def page_of(*scores, **how):
    return page([compared("microsat", record_of("microsat", *scores, **how))])


@pytest.fixture
def out(tmp_path):
    return tmp_path / "comparison.md"


@pytest.fixture
def flown(monkeypatch):
    """No flight, but the names of the satellites that would have flown."""
    names = []

    def fly(name, workers):
        names.append(name)
        return record_of(name, BETTER, GENTLE)

    monkeypatch.setattr(comparison, "fly", fly)
    return names


def test_the_first_table_names_the_best_the_thriftiest_that_settled_and_the_best_continuous():
    row = "| [microsat](#microsat) | whole attitude | `mpc` 0.50 deg | `pd` 1.25 deg | `lqr` 0.12 deg |"
    assert row in page_of(GOOD, BETTER, LOOSE, GENTLE)


def test_without_a_law_that_settled_none_is_the_thriftiest():
    assert "| `sliding` 0.75 deg | none | none |" in page_of(LOOSE)


def test_a_law_that_damps_is_not_the_best_at_pointing():
    damping = replace(GOOD, law="bdot", aim=Aim.RATE, error_rms=0.01)
    assert "| `pd` 1.25 deg | `pd` 1.25 deg | none |" in page_of(GOOD, damping)


def test_the_table_of_a_satellite_has_every_law_best_first():
    text = page_of(GOOD, GROUNDED, BETTER)
    places = [text.index(f"\n| {law} | ") for law in ("mpc", "pd", "sdre")]
    assert places == sorted(places)
    assert "| pd | pulsed | best | 1.50 | 1.25 | 2.50 | 0.0010 | 4000 | 70 | 2.00 | POINT | kept |" in text


def test_what_other_code_or_gains_have_flown_is_said():
    assert "earlier version" not in page_of(GOOD)
    assert "by an earlier version of code, scenario or gains." in page_of(GOOD, state="other")


def test_other_gains_are_another_state(tmp_path, monkeypatch):
    before = state_of("microsat")
    (tmp_path / "microsat.toml").write_text((FOLDER / "microsat.toml").read_text() + "\n")
    monkeypatch.setattr(comparison, "GAINS", tmp_path)
    assert state_of("microsat") != before


def test_all_satellites_are_flown_once_and_recorded_each(out, flown):
    assert main(["--out", str(out)]) == 0
    assert flown == list(SATELLITES)
    assert list(json.loads(record_path(out).read_text())) == sorted(SATELLITES)
    for name in SATELLITES:
        assert out.with_name(f"comparison-{name}.svg").read_text().count("lqr") == 1
    flown.clear()
    assert main(["--out", str(out)]) == 0
    assert flown == []


def test_a_satellite_of_an_earlier_state_is_flown_again(out, flown):
    records = {
        "microsat": record_of("microsat", GOOD, state="other"),
        "spinner": record_of("spinner", replace(GOOD, aim=Aim.SPIN)),
    }
    record_path(out).write_text(json.dumps(records))
    assert main(["microsat", "spinner", "--out", str(out)]) == 0
    assert flown == ["microsat"]


def test_render_flies_nothing_and_keeps_the_page_of_what_was_flown(out, flown):
    record_path(out).write_text(json.dumps({"microsat": record_of("microsat", GOOD, state="other")}))
    assert main(["--render", "--out", str(out)]) == 0
    assert flown == []
    assert "| pd | pulsed |" in out.read_text()


def test_broken_limits_are_exit_code_1_when_flown_and_ever_after(out, monkeypatch):
    broken = record_of("microsat", replace(GOOD, limits_ok=False))
    monkeypatch.setattr(comparison, "fly", lambda name, workers: broken)
    assert main(["microsat", "--out", str(out)]) == 1
    assert main(["microsat", "--out", str(out)]) == 1


def test_ctrl_c_keeps_the_satellites_that_have_flown_whole(out, flown, monkeypatch, capsys):
    def stopped(name, workers):
        if flown:
            raise KeyboardInterrupt
        flown.append(name)
        return record_of(name, BETTER)

    monkeypatch.setattr(comparison, "fly", stopped)
    assert main(["microsat", "spinner", "--out", str(out)]) == 130
    assert list(json.loads(record_path(out).read_text())) == ["microsat"]
    assert capsys.readouterr().err == (
        "comparison: interrupted; the satellites that have flown whole are kept\n"
    )


def test_another_satellite_is_refused_by_name(flown, capsys):
    with pytest.raises(SystemExit) as ended:
        main(["micrsat"])
    assert ended.value.code == 2
    assert "there is no satellite 'micrsat' here: choose among microsat, " in capsys.readouterr().err
    assert flown == []


@pytest.mark.parametrize("text", ["[1]", "{", '{"microsat": {}}', '{"moon": {"judged": {}}}', "\udcff"])
def test_a_file_that_is_no_record_is_refused_and_left(out, flown, capsys, text):
    path = record_path(out)
    path.write_bytes(text.encode("utf-8", "surrogateescape"))
    before = path.read_bytes()
    assert main(["--out", str(out)]) == 2
    assert capsys.readouterr().err.startswith(f"comparison: {path}: no record of comparisons")
    assert (path.read_bytes(), flown) == (before, [])
