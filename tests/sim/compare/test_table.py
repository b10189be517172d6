"""The table from planted scores: its order, its text and its files."""

import csv
import json
from dataclasses import fields
from io import StringIO

import pytest

from fsw.core.laws.entry import Aim
from sim.compare.case import Driver
from sim.compare.score import Score
from sim.compare.table import as_csv, as_json, as_text, error_text, ranked
from sim.scenario.controlled import Controlled


def score(law, pointing, rate=0.01, aim=Aim.THREE_AXIS, driver=Driver.PULSED, **more):
    figures = {
        "settle_orbits": 1.234,
        "error_rms": pointing,
        "error_max": 2.5 * pointing,
        "rate_rms_degps": rate,
        "dipole_squared_a2m4s": 12345.6,
        "pulses": 231,
        "duty": 0.0287,
        "mode_final": "POINT",
        "limits_ok": True,
    }
    return Score(law, aim, driver, **(figures | more))


ATTITUDE = Controlled("attitude", "whole attitude", "deg", 5.0)
SPIN = Controlled("spin", "spin rate about axis 1", "deg/s", 0.1)
ABSENT = Score("lqr", Aim.THREE_AXIS, Driver.PULSED, failure="no periodic dipole holds this body")
SCORES = [
    score("pd", 0.71, rate=0.004),
    ABSENT,
    score("bdot", 0.3, rate=0.02, aim=Aim.RATE),
    score("rate_damping", 50.0, rate=0.001, aim=Aim.RATE, limits_ok=False),
    score("sliding", 93.2, rate=0.0001, settle_orbits=None, mode_final="DETUMBLE"),
    score("mpc", 0.25, driver=Driver.CONTINUOUS, pulses=None),
]


def test_best_pointing_first_and_damping_by_rate():
    laws = [one.law for one in ranked(SCORES, ATTITUDE)]
    assert laws == ["mpc", "pd", "sliding", "lqr", "rate_damping", "bdot"]
    assert [one.law for one in ranked(reversed(SCORES), ATTITUDE)] == laws


def test_text_has_a_line_each_and_says_what_is_missing():
    heading, units, *lines, why = as_text(SCORES, ATTITUDE).splitlines()
    assert heading.split()[:6] == ["law", "driver", "gains", "settle", "RMS", "max"]
    assert units.split()[:3] == ["orbits", "deg", "deg"]
    cells = [line.split() for line in lines]
    figures = ["1.23", "0.71", "1.77", "0.0040", "1.235e+04", "231", "2.87"]
    assert cells[0] == ["pd", "pulsed", "scenario", *figures, "POINT", "kept"]
    assert cells[1] == ["lqr", "pulsed", "scenario", *"-" * 9]
    assert cells[3][-1] == "BROKEN"
    assert cells[4][3] == "-"
    assert cells[4][-2] == "DETUMBLE"
    assert cells[5][8] == "-"
    assert why == "lqr, pulsed: no periodic dipole holds this body"


def test_where_the_rate_is_judged_it_ranks_and_has_its_unit():
    spun = [score(law, error, aim=Aim.SPIN) for law, error in (("spin_up", 0.0412), ("slow_spin", 0.0031))]
    assert [one.law for one in ranked(spun, SPIN)] == ["slow_spin", "spin_up"]
    _, units, first, _ = as_text(ranked(spun, SPIN), SPIN).splitlines()
    assert units.split()[:3] == ["orbits", "deg/s", "deg/s"]
    assert first.split()[4] == "0.0031"


@pytest.mark.parametrize(
    ("error", "unit", "text"),
    [
        (12.346, "deg", "12.35"),
        (0.01, "deg", "0.01"),
        (0.0094, "deg", "0.0094"),
        (0.000812, "deg", "0.00081"),
        (0.0, "deg", "0.00"),
        (0.01234, "deg/s", "0.0123"),
        (0.0000123, "deg/s", "1.2e-05"),
    ],
)
def test_a_small_error_is_not_told_as_none(error, unit, text):
    assert error_text(error, unit) == text


def test_columns_stand_under_their_headings():
    lines = as_text([one for one in SCORES if not one.failure], ATTITUDE).splitlines()
    end = lines[0].index("RMS") + len("RMS")
    assert all(line[end - 1] != " " and line[end] == " " for line in lines)


def test_csv_reads_back():
    rows = list(csv.DictReader(StringIO(as_csv(SCORES))))
    assert list(rows[0]) == [field.name for field in fields(Score)]
    assert (rows[0]["law"], rows[0]["aim"], rows[0]["driver"]) == ("pd", "three_axis", "pulsed")
    assert float(rows[0]["error_rms"]) == 0.71
    assert rows[1]["error_rms"] == rows[5]["pulses"] == ""
    assert rows[1]["failure"] == ABSENT.failure


def test_json_holds_the_rows_and_the_description():
    read = json.loads(json.dumps(as_json(SCORES, {"scenario": "microsat", "seed": 3})))
    assert {"schema_version", "torquer_version", "scenario", "seed", "rows"} == set(read)
    assert set(read["rows"][0]) == {field.name for field in fields(Score)}
    assert read["rows"][5]["pulses"] is None
    assert read["rows"][0]["duty"] == pytest.approx(0.0287)
