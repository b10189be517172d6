"""Real passes with two solutions: no start, and no motion offered alone, is believed wrongly."""

import pytest
from recorded_samples import DATA

from sim.commissioning.recorded.calibration import read_calibration
from sim.commissioning.telemetry import held_back
from sim.errors import HarnessError
from sim.validate.flight_data import passes
from sim.validate.flight_data.passes import believed, files, judged

KNOWN = read_calibration(DATA / "calibration.toml")


@pytest.mark.long
def test_a_wrong_motion_is_counted_where_it_is_believed(monkeypatch):
    path = DATA / "s3_20240426T041442Z.csv"
    judge, known = passes.judge, {}

    def once(around, calibration, noise, start_s):
        """The same start is followed once."""
        key = (calibration.inertia.tobytes(), start_s)
        known[key] = known.get(key) or judge(around, calibration, noise, start_s)
        return known[key]

    monkeypatch.setattr(passes, "judge", once)
    monkeypatch.setattr(passes, "SHORT_STARTS_S", (200.0,))
    monkeypatch.setattr(held_back, "COASTS", 5)
    assert believed(path, KNOWN).wrong == ()
    monkeypatch.setattr(passes, "TWO_SOLUTIONS", {path.stem: 65.0})
    wrong = believed(path, KNOWN).wrong
    assert wrong
    assert all(one.startswith(("65.8", "65.9", "66.0")) for one in wrong)


@pytest.mark.long
def test_figures_of_a_pass():
    found = judged(DATA / "s3_20240314T153551Z.csv", KNOWN)
    assert found.name == "s3_20240314T153551Z"
    assert found.span_s == 199.0
    assert 300.0 < found.own_fit_nt < 700.0
    assert found.found["converged"]


def test_without_the_pass_to_calibrate_by_there_is_nothing_to_judge(tmp_path):
    with pytest.raises(HarnessError, match="does not hold s3_20231211T151930Z"):
        files(tmp_path)
