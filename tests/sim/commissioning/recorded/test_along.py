"""The orbit beside a pass: the plant's own field and Sun at every row."""

from dataclasses import replace

import numpy as np
import pytest
from recorded_samples import DATA, TLE, made_up

from sim.commissioning.recorded.along import along, placed, sample_hz, sampled
from sim.commissioning.recorded.recorded_pass import read_pass
from sim.errors import HarnessError
from sim.scenario.element_file import nearest_elements


def test_field_and_sun_are_those_of_the_plant(tmp_path):
    truth = made_up(90)
    around = truth.along(tmp_path)
    np.testing.assert_allclose(around.b_eci_nt, truth.b_eci_nt, atol=30.0)
    np.testing.assert_allclose(around.sun_eci, truth.sun_eci, atol=1e-4)
    np.testing.assert_allclose(around.strength_nt, np.linalg.norm(truth.b_eci_nt, axis=1), atol=30.0)
    assert around.lit.all()
    assert around.tick_s == 1.0


def test_a_pass_in_shadow_is_dark():
    recorded = read_pass(DATA / "s3_20240426T041442Z.csv")
    around = along(recorded, nearest_elements(TLE, recorded.middle_unix_s))
    assert not around.lit.any()
    assert all(current.max() == 0.0 for current in around.recorded.cells.values())


def test_of_rows_of_one_second_the_first_alone_counts_and_gaps_stay(tmp_path):
    head, *rows = made_up(10).text.splitlines()
    rows.insert(4, ",".join([rows[3].split(",")[0], *rows[4].split(",")[1:]]))
    empty = rows[6].split(",")
    rows[6] = ",".join([empty[0], "", *empty[2:]])
    path = tmp_path / "gaps.csv"
    path.write_text("\n".join([head, *rows[:7], *rows[8:]]) + "\n")
    recorded = read_pass(path)
    around = along(recorded, nearest_elements(TLE, recorded.middle_unix_s))
    assert around.tick.tolist() == [0, 1, 2, 3, 3, 4, 5, 7, 8, 9]
    assert around.first_of_tick.tolist() == [True] * 4 + [False] + [True] * 5
    assert sampled(around).tolist() == [0, 1, 2, 3, 5, 7, 8, 9]


def test_faster_samples_have_shorter_ticks(tmp_path):
    head, *rows = made_up(12).text.splitlines()
    start = float(rows[0].split(",")[0])
    faster = [",".join([f"{start + 0.25 * n:.2f}", *row.split(",")[1:]]) for n, row in enumerate(rows)]
    path = tmp_path / "fast.csv"
    path.write_text("\n".join([head, *faster]) + "\n")
    recorded = read_pass(path)
    around = along(recorded, nearest_elements(TLE, recorded.middle_unix_s))
    assert around.tick_s == 0.25
    assert around.tick.tolist() == list(range(12))
    np.testing.assert_allclose(around.t_s, 0.25 * np.arange(12))


def test_time_is_counted_from_the_first_row_wherever_in_its_second_that_is(tmp_path):
    head, *rows = made_up(12).text.splitlines()
    start = float(rows[0].split(",")[0])
    for name, step_s, later_s in (("slow", 1.0, 0.75), ("half", 1.0, 0.5), ("fast", 0.25, 0.5)):
        moved = [
            ",".join([f"{start + later_s + step_s * n:.2f}", *row.split(",")[1:]])
            for n, row in enumerate(rows)
        ]
        path = tmp_path / f"{name}.csv"
        path.write_text("\n".join([head, *moved]) + "\n")
        recorded = read_pass(path)
        around = along(recorded, nearest_elements(TLE, recorded.middle_unix_s))
        np.testing.assert_allclose(around.t_s, recorded.utc_unix_s - recorded.utc_unix_s[0], atol=1e-6)
        assert around.first_of_tick.all()


@pytest.mark.parametrize(("step_s", "tick_s"), [(1.5, 0.5), (0.7, 0.1), (2.5, 0.5), (7.0, 1.0), (0.08, 0.04)])
def test_ticks_are_as_fine_as_it_takes_to_fall_on_the_samples(tmp_path, step_s, tick_s):
    recorded = made_up(60).along(tmp_path).recorded
    t_s = step_s * np.arange(60)
    around = along(
        replace(recorded, utc_unix_s=recorded.utc_unix_s[0] + t_s),
        nearest_elements(TLE, recorded.middle_unix_s),
    )
    assert around.tick_s == pytest.approx(tick_s)
    np.testing.assert_allclose(around.t_s, t_s, atol=1e-6)
    assert sample_hz(around) == pytest.approx(1.0 / step_s)


@pytest.mark.parametrize(
    ("seconds", "apart"),
    [
        (range(0, 60), 1),
        (range(0, 60, 4), 4),
        ([*range(0, 60, 4), 61], 4),
        ([0, 1, 4, 5, 8, 9, 12, 13, 16, 17, 20], 1),
        ([0, 3, 4, 7, 8, 11, 12, 15, 16, 19], 1),
        ([0, 10, 20, 30, 60, 90, 100], 10),
    ],
)
def test_how_far_samples_are_apart(tmp_path, capsys, seconds, apart):
    recorded = made_up(60).along(tmp_path).recorded
    chosen = np.arange(len(seconds))
    thinned = replace(
        recorded,
        utc_unix_s=recorded.utc_unix_s[0] + np.array(seconds, float),
        mag_nt=recorded.mag_nt[chosen],
        gyro_degps=None,
        cells={},
        lines=recorded.lines[chosen],
    )
    around = placed(thinned, TLE)
    assert sample_hz(around) == pytest.approx(1.0 / apart)
    assert ("looks like a slower one" in capsys.readouterr().err) is (apart > 1)


def test_a_time_without_a_field_model_is_refused(tmp_path):
    text = made_up(5).text.replace("17023079", "23023079")
    path = tmp_path / "late.csv"
    path.write_text(text)
    recorded = read_pass(path)
    with pytest.raises(HarnessError, match="late: "):
        along(recorded, nearest_elements(TLE, recorded.middle_unix_s))


@pytest.mark.parametrize(("days", "said"), [(6.9, ""), (-7.4, "set is 7 days away: its field may be off")])
def test_elements_that_are_far_away_are_warned_of(tmp_path, capsys, days, said):
    recorded = made_up(20).along(tmp_path).recorded
    alone = tmp_path / "one.txt"
    alone.write_text("\n".join(TLE.read_text().splitlines()[1:3]) + "\n")
    near = nearest_elements(alone, recorded.middle_unix_s)
    moved_s = days * 86400.0 - (recorded.middle_unix_s - near.epoch_unix_s)
    around = placed(replace(recorded, utc_unix_s=recorded.utc_unix_s + round(moved_s)), alone)
    assert around.elements == near
    warned = capsys.readouterr().err
    assert said in warned
    assert bool(said) == bool(warned)


@pytest.mark.parametrize("factor", [1e-9, 1e-5, 1e-3, 1e-2, 1e2, 1e3])
def test_a_field_of_another_unit_is_asked_about(tmp_path, factor):
    recorded = made_up(20).along(tmp_path).recorded
    with pytest.raises(
        HarnessError, match=r"by the unit in its columns the field is about .*: is it in anot"
    ):
        placed(replace(recorded, mag_nt=factor * recorded.mag_nt), TLE)


@pytest.mark.parametrize("missing", [np.nan, 0.0], ids=["left empty", "zeros"])
@pytest.mark.parametrize("part", [0.1, 0.6])
def test_rows_without_a_field_are_no_other_unit(tmp_path, missing, part):
    recorded = made_up(200).along(tmp_path).recorded
    mag_nt = recorded.mag_nt.copy()
    mag_nt[: round(part * len(mag_nt))] = missing
    placed(replace(recorded, mag_nt=mag_nt), TLE)


@pytest.mark.parametrize("offset_nt", [0.0, 2e5, -2e5])
def test_an_offset_as_large_as_they_come_is_no_other_unit(tmp_path, offset_nt):
    recorded = made_up(20).along(tmp_path).recorded
    placed(replace(recorded, mag_nt=recorded.mag_nt + offset_nt), TLE)


@pytest.mark.parametrize(
    ("clock", "said"),
    [
        (lambda unix_s: 1e3 * unix_s, "milliseconds"),
        (lambda unix_s: unix_s - 315_964_782.0, "GPS seconds, since 1980"),
        (lambda unix_s: unix_s - 946_728_000.0, "seconds since 2000"),
    ],
)
def test_times_of_another_clock_are_named(tmp_path, clock, said):
    head, *rows = made_up(10).text.splitlines()
    place = head.split(",").index("utc_unix_s")
    fields = [row.split(",") for row in rows]
    for row in fields:
        row[place] = f"{clock(float(row[place])):.3f}"
    path = tmp_path / "clock.csv"
    path.write_text("\n".join([head, *map(",".join, fields)]) + "\n")
    with pytest.raises(HarnessError, match=f"is it in {said}"):
        placed(read_pass(path), TLE)


OLDER = """s3_20220919T153638Z
1 52191U 22033AL  22262.21660011  .00008304  00000+0  36142-3 0  9992
2 52191  97.3907 342.0333 0011202  29.0466 331.1391 15.22431409 25937
"""


def test_gps_seconds_are_named_where_older_elements_are_nearer_to_them(tmp_path):
    elements = tmp_path / "tle.txt"
    elements.write_text(OLDER + TLE.read_text())
    recorded = made_up(20).along(tmp_path).recorded
    of_gps = replace(recorded, utc_unix_s=recorded.utc_unix_s - 315_964_782.0)
    with pytest.raises(HarnessError, match="is it in GPS seconds"):
        placed(of_gps, elements)
