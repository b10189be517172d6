"""A row of results.sqlite that no campaign can have written is one sentence, whoever reads it."""

import sqlite3
from contextlib import closing

import pytest

from sim.campaign.results.store import RESULTS, Status, open_results, read_results
from sim.errors import HarnessError

CONTRADICTIONS = {
    "UPDATE runs SET run = -1 WHERE run = 2": "run -1 contradicts itself: its number is less than 0",
    "UPDATE runs SET run = 10000000 WHERE run = 2": "its number is over 9999999",
    "UPDATE runs SET status = 'flown' WHERE run = 2": "it is neither done nor failed",
    "UPDATE runs SET status = x'ff' WHERE run = 2": "its status is no text",
    "UPDATE runs SET success = 2 WHERE run = 2": "it is neither a success nor none",
    "UPDATE runs SET success = 'yes' WHERE run = 2": "its success is no whole number",
    "UPDATE runs SET success = 0 WHERE run = 2": "it is no success, and misses nothing",
    "UPDATE runs SET success = 1 WHERE run = 3": "it failed, and is a success",
    "UPDATE runs SET failure = '' WHERE run = 3": "it failed, and nothing says why",
    "UPDATE runs SET failure = 'no fuel' WHERE run = 2": "it is done, and it failed",
    "UPDATE runs SET missed = 'limits_ok' WHERE run = 2": "it is a success that misses a requirement",
    "UPDATE runs SET limits_ok = 0 WHERE run = 2": "it is a success that broke the limits of the coils",
    "UPDATE runs SET limits_ok = NULL WHERE run = 2": "nothing says whether the limits of the coils",
    "UPDATE runs SET nees_mean = 'large' WHERE run = 2": "its nees_mean is no number",
    "UPDATE runs SET requirements_1_verdict = 'fine' WHERE run = 2": "1_verdict is no verdict",
    "UPDATE runs SET seed = 1.5 WHERE run = 2": "its seed is no whole number",
    "UPDATE runs SET mode_final = x'00' WHERE run = 2": "its mode_final is no text",
    "UPDATE runs SET status = 'failed', failure = 'x', success = 0 WHERE run = 2": "and was not flown",
    "DELETE FROM profiles WHERE run = 2 AND name = 'ake'": "and lacks a profile of a pointing index",
    "DELETE FROM runs WHERE run = 2": "run 2 contradicts itself: it has a history and was not flown",
    "UPDATE profiles SET f4 = x'0000803f' WHERE run = 2 AND name = 'mpe'": "does not have 256 points",
    "UPDATE profiles SET f4 = 'long' WHERE run = 2 AND name = 'rpe'": "its history is no array",
    "INSERT INTO profiles VALUES (2, 'error_deg', x'00')": "does not hold whole numbers of 4 bytes",
    "ALTER TABLE runs ADD COLUMN note BOOLEAN": "its note is no value of a known type",
}


@pytest.fixture
def flown(small, row_of, tmp_path):
    """A folder with the results of four runs, the last of which failed."""
    with open_results(tmp_path, small) as results:
        for run in range(3):
            results.add(row_of(small, run))
        failed = {
            "status": Status.FAILED,
            "failure": "no fuel",
            "success": False,
            "cells": {},
            "profiles": {},
        }
        results.add(row_of(small, 3, **failed))
    return tmp_path


def alter(folder, statement):
    with closing(sqlite3.connect(folder / RESULTS)) as connection, connection:
        connection.execute(statement)


def test_what_a_campaign_has_written_does_not_contradict_itself(flown, small):
    with open_results(flown, small) as results:
        assert results.runs() == [0, 1, 2, 3]
    with read_results(flown) as results:
        assert results.runs() == [0, 1, 2, 3]


@pytest.mark.parametrize(("statement", "says"), CONTRADICTIONS.items())
def test_a_row_that_contradicts_itself_is_told_to_all_who_read_it(statement, says, flown, small):
    alter(flown, statement)
    with pytest.raises(HarnessError, match=says) as caught, open_results(flown, small):
        pass
    assert str(caught.value).startswith(f"{flown / RESULTS}: the row of run ")
    with pytest.raises(HarnessError, match=says), read_results(flown):
        pass


@pytest.mark.parametrize("figure", ["60.5", "NULL"])
def test_a_success_that_misses_a_requirement_of_its_campaign_is_told(figure, flown, small):
    alter(flown, f"UPDATE runs SET pointing_deg_rms_last_orbit = {figure} WHERE run = 1")
    says = "run 1 contradicts itself: it is a success, and misses pointing_deg_rms_last_orbit <= 60"
    with pytest.raises(HarnessError, match=says), open_results(flown, small):
        pass
