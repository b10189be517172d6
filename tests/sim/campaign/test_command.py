"""A campaign is continued by the code that began it."""

import re
import shlex
import sqlite3
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from fsw.input.schema import merge
from sim.campaign.code_digest import code_digest
from sim.campaign.command import CampaignOptions, FlownCampaign, _watch, campaign, warnings_of_runs
from sim.campaign.results.store import CODE, RESULTS, RunRow, Status, open_results
from sim.errors import HarnessError


@pytest.fixture
def begun(small, row_of, tmp_path, monkeypatch):
    """A folder with one of six runs; what flies the others, and what draws them, is left out."""
    small.write(tmp_path)
    with open_results(tmp_path, small) as results:
        results.add(row_of(small, 0))
    monkeypatch.setattr("sim.campaign.command._fly", lambda *_: None)
    monkeypatch.setattr("sim.campaign.command._conclude", lambda *_: "continued")
    return tmp_path


def resume(folder):
    return campaign(str(folder), {}, {}, CampaignOptions(workers=1), None)


def meta(folder, statement):
    with sqlite3.connect(folder / RESULTS) as connection:
        connection.execute(statement)
    connection.close()


@pytest.mark.long
def test_by_the_same_code(begun, capsys):
    assert resume(begun) == "continued"
    assert "code" not in capsys.readouterr().err


class TestWarningsOfRuns:
    """Before the first flight: what the runs as they are drawn have against their onboard table."""

    def test_a_dispersion_beyond_a_bound_that_the_scenario_keeps(self, small):
        (warning,) = (one for one in warnings_of_runs(small, []) if "residual_dipole" in one)
        count, run = map(int, re.match(r"in (\d+) of the first 6 runs, as in run (\d): ", warning).groups())
        off = [max(map(abs, drawn_dipole(small, number))) for number in range(6)]
        assert 0 < count <= 6
        assert f"off by {off[run]:.3g}, and flight.uncertainty.residual_dipole_am2 = 0" in warning

    def test_what_the_scenario_was_warned_of_is_not_said_again(self, small):
        of_run = [one.split(": ", 1)[1] for one in warnings_of_runs(small, [])]
        assert of_run
        assert warnings_of_runs(small, of_run) == []

    def test_none_where_the_table_declares_what_is_drawn(self, small):
        declared = {"flight": {"uncertainty": {"residual_dipole_am2": 0.1}}}
        assert not [one for one in warnings_of_runs(with_base(small, declared), []) if "dipole" in one]


def drawn_dipole(campaign, run):
    return campaign.scenario(campaign.draw(run)).disturbance.residual_dipole_am2


def with_base(campaign, settings):
    return replace(campaign, base=merge(campaign.base, settings))


@pytest.mark.long
def test_by_other_code_of_the_same_version_it_is_refused(begun):
    meta(begun, f"UPDATE meta SET value = '0123' WHERE key = '{CODE}'")
    with pytest.raises(HarnessError, match=r"begun by other code of torquer .*, of digest 0123") as caught:
        resume(begun)
    assert code_digest() in str(caught.value)
    assert "choose another --out" in str(caught.value)


@pytest.mark.long
def test_by_other_code_it_is_still_shown_where_no_run_is_missing(begun, small, row_of):
    meta(begun, f"UPDATE meta SET value = '0123' WHERE key = '{CODE}'")
    with open_results(begun, small) as results:
        for run in range(1, 6):
            results.add(row_of(small, run))
    assert resume(begun) == "continued"


def test_the_command_that_continues_it_can_be_typed_as_it_stands(small, tmp_path, monkeypatch, capsys):
    def interrupt(*_):
        raise KeyboardInterrupt

    folder = tmp_path / "runs of today"
    folder.mkdir()
    small.write(folder)
    monkeypatch.setattr("sim.campaign.command._fly", interrupt)
    with pytest.raises(KeyboardInterrupt):
        resume(folder)
    command = capsys.readouterr().err.partition("; ")[2].removesuffix(" flies the rest\n")
    assert shlex.split(command) == ["torquer", "campaign", str(folder)]


def test_time_left_is_told_from_the_second_run_on(monkeypatch, capsys):
    now = iter((0.0, 100.0, 200.0))
    monkeypatch.setattr("sim.campaign.command.time.monotonic", lambda: next(now))
    with _watch("x", 4) as take:
        for run in range(2):
            take(RunRow(run, Status.DONE, "", 1, True, "", {}))
    assert capsys.readouterr().err.splitlines() == [
        "1 of 4 runs, 0 failed",
        "2 of 4 runs, 0 failed, 0.6 a minute, 3.3 min left",
    ]


def test_why_a_run_failed_is_told(small, monkeypatch):
    monkeypatch.setattr("sim.campaign.command.verdicts", lambda campaign, analysis: [])
    analysis = SimpleNamespace(failures={3: "the wheel is too fast"})
    flown = FlownCampaign(Path(), small, analysis, (3,), ())
    assert "run 3 failed (the first: the wheel is too fast); --retry flies again" in flown.complaints


@pytest.mark.long
def test_results_of_before_the_digest_are_continued_with_a_warning(begun, capsys):
    meta(begun, f"DELETE FROM meta WHERE key = '{CODE}'")
    assert resume(begun) == "continued"
    assert "does not say by which code" in capsys.readouterr().err
