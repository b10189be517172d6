"""The page of ``make comparison``, from invented figures, and when the tool fails."""

from dataclasses import asdict, replace

import comparison
import pytest
from comparison import SATELLITES, compared, main, page

from fsw.core.laws.entry import Aim
from sim.compare.case import Driver
from sim.compare.command import yardstick
from sim.compare.score import Score
from sim.scenario.schema import load

GOOD = Score(
    "pd", Aim.THREE_AXIS, Driver.PULSED, 1.5, 1.25, 2.5, 0.001, 4000.0, 70, 0.02, "POINT", True, tuned=True
)
BETTER = replace(GOOD, law="mpc", error_rms=0.5, dipole_squared_a2m4s=9000.0)
LOOSE = replace(GOOD, law="sliding", settle_orbits=None, error_rms=0.75, dipole_squared_a2m4s=10.0)
GENTLE = replace(GOOD, law="lqr", driver=Driver.CONTINUOUS, pulses=None, error_rms=0.125)
GROUNDED = Score("sdre", Aim.THREE_AXIS, Driver.CONTINUOUS, failure="it needs a wheel")


def record_of(name, *scores):
    by = yardstick(load(name))._asdict()
    return {
        "judged": by,
        "sim_seconds": 60413.0,
        "rows": [asdict(score) for score in scores],
    }


def page_of(*scores):
    return page([compared("microsat", record_of("microsat", *scores))])


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


@pytest.mark.long
@pytest.mark.slow
def test_all_satellites_are_flown_and_drawn(out, flown):
    assert main(["--out", str(out)]) == 0
    assert flown == list(SATELLITES)
    for name in SATELLITES:
        assert out.with_name(f"comparison-{name}.svg").read_text().count("lqr") == 1


@pytest.mark.long
def test_broken_limits_are_exit_code_1(out, monkeypatch):
    monkeypatch.setattr(
        comparison, "fly", lambda name, workers: record_of(name, replace(GOOD, limits_ok=False))
    )
    assert main(["--out", str(out)]) == 1


def test_ctrl_c_leaves_the_page_that_is_there(out, monkeypatch, capsys):
    def stopped(name, workers):
        raise KeyboardInterrupt

    out.write_text("of another day")
    monkeypatch.setattr(comparison, "fly", stopped)
    assert main(["--out", str(out)]) == 130
    assert capsys.readouterr().err == "comparison: interrupted; flights that are done are not flown again\n"
    assert out.read_text() == "of another day"
