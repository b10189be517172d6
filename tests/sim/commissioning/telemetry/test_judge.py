"""Which motion is believed: cells or coasting tell it, and one that nothing bears out has not converged."""

from dataclasses import replace
from math import nan

import numpy as np
import pytest
from recorded_samples import DATA, TLE

from sim.commissioning.recorded.along import along
from sim.commissioning.recorded.calibration import read_calibration
from sim.commissioning.recorded.recorded_pass import read_pass
from sim.commissioning.telemetry.follow import Noise
from sim.commissioning.telemetry.held_back import NO_AZIMUTHS
from sim.commissioning.telemetry.judge import figures, judge, mean_gyro, rank_motions
from sim.scenario.element_file import nearest_elements

KNOWN = read_calibration(DATA / "calibration.toml")


def judged(name):
    recorded = read_pass(DATA / f"s3_{name}.csv")
    return judge(along(recorded, nearest_elements(TLE, recorded.middle_unix_s)), KNOWN, Noise())


@pytest.mark.parametrize("apart", [3, 5])
def test_of_samples_that_are_seconds_apart_no_faster_spin_is_believed(tmp_path, apart):
    head, *rows = (DATA / "s3_20240314T153551Z.csv").read_text().splitlines()
    path = tmp_path / "thinned.csv"
    path.write_text("\n".join([head, *rows[::apart]]) + "\n")
    recorded = read_pass(path)
    around = along(recorded, nearest_elements(TLE, recorded.middle_unix_s))
    thinned = judge(around, KNOWN, Noise())
    rates = [motion.followed.rate_degps[-1, 1] for motion in thinned.motions]
    assert rates == pytest.approx([23.6] * len(rates), abs=0.5), "the gyro, which is not used, has 23.3"


@pytest.fixture(scope="module")
def sunlit():
    """200 s of 24 deg/s, calibrated three months before."""
    return judged("20240314T153551Z")


@pytest.fixture(scope="module")
def eclipsed():
    """200 s of 66 deg/s in shadow."""
    return judged("20240426T041442Z")


def spoiled_pass(folder, name, spoilt):
    """Judged, and judged without them, with these rows, by their numbers, in place of those of a pass."""
    head, *rows = (DATA / f"s3_{name}.csv").read_text().splitlines()
    found = []
    for kept in (
        [spoilt.get(place, row) for place, row in enumerate(rows)],
        [row for place, row in enumerate(rows) if place not in spoilt],
    ):
        path = folder / f"{len(found)}.csv"
        path.write_text("\n".join([head, *kept]) + "\n")
        recorded = read_pass(path)
        found.append(judge(along(recorded, nearest_elements(TLE, recorded.middle_unix_s)), KNOWN, Noise()))
    return found


def turned(row):
    """The row with a field that has the right strength and a wrong direction, about y and x exchanged."""
    index, time, x, y, z, *rest = row.split(",")
    offset = KNOWN.offset_nt
    body = KNOWN.matrix @ (np.array([float(x), float(y), float(z)]) - offset)
    wrong = np.linalg.solve(KNOWN.matrix, -body) + offset
    return ",".join([index, time, *map(str, wrong), *rest])


@pytest.mark.long
@pytest.mark.parametrize("places", [(0,), (1,), (100,), (199,), (60, 61, 62, 63), (5, 50, 120, 180, 198)])
def test_samples_that_the_filter_rightly_refuses_count_for_nothing(tmp_path, places):
    name = "20240426T041442Z"
    rows = (DATA / f"s3_{name}.csv").read_text().splitlines()[1:]
    spoiled, without = spoiled_pass(tmp_path, name, {place: turned(rows[place]) for place in places})
    found, right = figures(spoiled), figures(without)
    lines = sorted(line for one in found.pop("rows_left_out") for line in one["lines"])
    assert lines == [place + 2 for place in places]
    assert right.pop("rows_left_out") == []
    assert found == right


@pytest.mark.long
def test_where_the_filter_refuses_more_than_a_tenth_all_of_it_is_its_error(tmp_path):
    name = "20240426T041442Z"
    rows = (DATA / f"s3_{name}.csv").read_text().splitlines()[1:]
    spoiled, _ = spoiled_pass(tmp_path, name, {n: turned(rows[n]) for n in range(100, 200, 3)})
    assert figures(spoiled)["rows_left_out"] == []
    assert spoiled.best.direction_deg_rms > 10.0
    assert not spoiled.verdict.converged


class TestOfAPassInTheSun:
    def test_the_field_allows_two_motions_and_the_cells_tell_one(self, sunlit):
        best, other = sunlit.motions
        assert sunlit.verdict == (True, "cells", "")
        assert best.direction_deg_rms == pytest.approx(other.direction_deg_rms, rel=0.02)
        assert abs(best.followed.rate_degps[-1, 1] - other.followed.rate_degps[-1, 1]) > 0.05
        assert abs(best.azimuths.median_deg) < 5.0
        assert abs(other.azimuths.median_deg) > 15.0

    def test_the_wrong_one_alone_is_not_reported_as_converged(self, sunlit):
        _, verdict = rank_motions([sunlit.motions[1]])
        assert not verdict.converged
        assert "the Sun that the cells see is off by" in verdict.reason

    def test_without_cells_neither_is(self, sunlit):
        blind = [replace(motion, azimuths=NO_AZIMUTHS) for motion in sunlit.motions]
        _, verdict = rank_motions(blind)
        assert not verdict.converged
        assert "fit the field alike, and neither cells nor coasting tell them apart" in verdict.reason

    def test_cells_that_told_the_motion_do_not_count_as_held_back(self, sunlit):
        told = sunlit.best.held_back("cells").rows
        assert told.min() >= 100
        assert len(told) < len(sunlit.best.held_back("field").rows)

    def test_its_figures(self, sunlit):
        found = figures(sunlit)
        assert found["field_norm_nt_rms"] < 1000.0
        assert found["field_direction_deg_rms"] < 2.5
        assert found["gyro_y_degps_mean"] == pytest.approx(23.28, abs=0.01)
        assert found["rate_y_degps_mean"] == pytest.approx(23.277, abs=0.1 + 0.025 * 23.277)
        assert found["rate_y_degps_mean"] == pytest.approx((23.277 + 0.2) / 0.985, abs=0.3)
        assert set(found["coast_deg_rms"]) == {"10", "30", "60", "120"}
        assert found["coast_deg_rms"]["120"] < 5.0
        assert abs(found["sun_azimuth_deg"]["median"]) < 15.0
        assert found["sun_azimuth_deg"]["rms"] < 5.0
        assert found["converged"]

    @staticmethod
    def off_by(motion, error_deg):
        ticks = tuple(one._replace(direction_deg=error_deg) for one in motion.followed.ticks)
        return replace(motion, followed=replace(motion.followed, ticks=ticks))

    def test_a_motion_that_leaves_no_error_at_all_is_told_by_the_field(self, sunlit):
        exact, other = self.off_by(sunlit.best, 0.0), sunlit.motions[1]
        ordered, verdict = rank_motions([other, exact])
        assert ordered == [exact, other]
        assert verdict == (True, "field", "")
        assert rank_motions([exact, self.off_by(other, 0.0)])[1].by == "cells"

    def test_a_motion_whose_error_is_no_number_is_lost_and_comes_last(self, sunlit):
        lost = self.off_by(sunlit.best, nan)
        assert rank_motions([lost])[1].reason == "the field is off by nan deg: the filter is lost"
        assert rank_motions([lost, sunlit.motions[1]])[0] == [sunlit.motions[1], lost]


class TestOfAPassInShadow:
    def test_coasting_tells_one_of_two_motions(self, eclipsed):
        best, other = eclipsed.motions
        assert eclipsed.verdict == (True, "coasting", "")
        assert other.longest_coast()[1] > 2.0 * best.longest_coast()[1]
        assert other.direction_deg_rms < 2.5

    def test_the_wrong_one_alone_is_not_reported_as_converged(self, eclipsed):
        _, verdict = rank_motions([eclipsed.motions[1]])
        assert not verdict.converged
        assert "without samples the field is off by" in verdict.reason

    def test_one_that_nothing_bears_out_is_not_believed_though_it_stands_alone(self, eclipsed):
        best = eclipsed.best
        short = replace(best, coasts_deg={10: best.coasts_deg[10], 30: best.coasts_deg[30]})
        _, verdict = rank_motions([short])
        assert verdict == (False, "field", "neither cells nor a minute of coasting bear the motion out")
        assert rank_motions([best])[1].converged

    def test_its_figures(self, eclipsed):
        found = figures(eclipsed)
        assert found["sun_azimuth_deg"] == {"median": None, "rms": None, "rows": 0}
        assert found["field_direction_deg_rms"] < 2.5
        assert found["rate_y_degps_mean"] == pytest.approx((64.59 + 0.2) / 0.985, abs=0.3)


def test_too_short_a_pass_has_no_coasting_and_is_not_believed(tmp_path):
    lines = (DATA / "s3_20240426T041442Z.csv").read_text().splitlines()
    path = tmp_path / "short.csv"
    path.write_text("\n".join(lines[:41]) + "\n")
    recorded = read_pass(path)
    found = judge(along(recorded, nearest_elements(TLE, recorded.middle_unix_s)), KNOWN, Noise())
    assert not found.verdict.converged
    assert figures(found)["coast_deg_rms"]["60"] is None


@pytest.mark.long
def test_a_rate_is_right_without_a_calibration_of_the_body(sunlit):
    """A sphere spins about what axis it has: that across which the field turns."""
    recorded = sunlit.around.recorded
    sphere = KNOWN._replace(inertia=np.eye(3))
    found = judge(along(recorded, nearest_elements(TLE, recorded.middle_unix_s)), sphere, Noise())
    assert found.best.followed.rate_degps[-50:, 1].mean() == pytest.approx(23.9, abs=0.2)


def test_a_gyro_axis_without_a_sample_has_no_mean():
    samples = np.array([[1.0, nan, 3.0], [3.0, 4.0, nan]])
    np.testing.assert_allclose(mean_gyro(samples), [2.0, 4.0, 3.0])
    assert mean_gyro(samples[:1]) is None
    assert mean_gyro(samples[:0]) is None
