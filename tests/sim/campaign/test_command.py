"""A campaign is continued by the code that began it."""

import sqlite3

import pytest

from sim.campaign.code_digest import code_digest
from sim.campaign.command import campaign
from sim.campaign.results.row import RunRow, Status
from sim.campaign.results.store import CODE, RESULTS, open_results
from sim.errors import HarnessError


@pytest.fixture
def begun(small, tmp_path, monkeypatch):
    """A folder with one of six runs; what flies the others, and what draws them, is left out."""
    small.write(tmp_path)
    with open_results(tmp_path, small) as results:
        results.add(RunRow(0, Status.DONE, "", 1, True, "", {"limits_ok": 1}))
    monkeypatch.setattr("sim.campaign.command._fly", lambda *_: None)
    monkeypatch.setattr("sim.campaign.command._conclude", lambda *_: "continued")
    return tmp_path


def resume(folder):
    return campaign(str(folder), {}, {}, 1, None, "none", False, False, None)


def meta(folder, statement):
    with sqlite3.connect(folder / RESULTS) as connection:
        connection.execute(statement)
    connection.close()


def test_by_the_same_code(begun, capsys):
    assert resume(begun) == "continued"
    assert capsys.readouterr().err == ""


def test_by_other_code_of_the_same_version_it_is_refused(begun):
    meta(begun, f"UPDATE meta SET value = '0123' WHERE key = '{CODE}'")
    with pytest.raises(HarnessError, match=r"begun by other code of torquer .*, of digest 0123") as caught:
        resume(begun)
    assert code_digest() in str(caught.value)
    assert "choose another --out" in str(caught.value)


def test_by_other_code_it_is_still_shown_where_no_run_is_missing(begun, small):
    meta(begun, f"UPDATE meta SET value = '0123' WHERE key = '{CODE}'")
    with open_results(begun, small) as results:
        for run in range(1, 6):
            results.add(RunRow(run, Status.DONE, "", 1, True, "", {"limits_ok": 1}))
    assert resume(begun) == "continued"


def test_results_of_before_the_digest_are_continued_with_a_warning(begun, capsys):
    meta(begun, f"DELETE FROM meta WHERE key = '{CODE}'")
    assert resume(begun) == "continued"
    assert "does not say by which code" in capsys.readouterr().err
