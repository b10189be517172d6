"""A run: summary, histories with units, pulses; what needs an extra and what does not."""

import json
import sys

import h5py
import numpy as np
import pytest

import torquer
from fsw.wire.messages import TickDone

SUFFIXES = {
    "T": "_t",
    "A m^2": "_am2",
    "N m": "_nm",
    "N m s": "_nms",
    "m": "_m",
    "rad": "_rad",
    "rad/s": "_radps",
    "deg": "_deg",
    "deg/s": "_degps",
}
"""How the name of a variable ends that has this unit."""


@pytest.mark.long
@pytest.mark.parametrize("histories", ["truth", "estimate"])
def test_every_variable_says_its_unit_in_name_and_attributes(histories, flown):
    dataset = getattr(flown, histories)
    for name, variable in dataset.data_vars.items():
        assert variable.attrs["long_name"]
        assert variable.dims[0] == "time"
        assert name.endswith(SUFFIXES.get(variable.attrs["units"], ""))
        assert variable.attrs["units"] in {*SUFFIXES, "1"}
    assert dataset.time.attrs == {"units": "s", "long_name": "time since tick 0"}
    assert dataset.sizes["time"] == flown.summary["ticks"]
    assert dataset.attrs["seed"] == 7
    assert float(dataset.orbit[-1]) == pytest.approx(0.05, rel=0.01)
    assert getattr(flown, histories) is dataset


def test_truth_is_what_the_plant_recorded(flown):
    truth = flown.truth
    with h5py.File(flown.path / "truth.h5") as file:
        assert np.array_equal(truth.b_body_t, file["b_body_t"])
        for source in file["torque_body_nm"]:
            assert np.array_equal(truth.torque_body_nm.sel(source=source), file["torque_body_nm"][source])
    assert truth.pointing_deg[-1] == flown.summary["pointing_deg"]["final"]
    assert truth.axis1_deg[-1] == flown.summary["axis1_deg"]["final"]


def test_the_estimate_is_that_of_the_flight(flown):
    estimate = flown.estimate
    assert estimate.attrs["replay"] == "bit-exact"
    assert estimate.mode.attrs["flag_meanings"].split()[int(estimate.mode[-1])] == flown.summary["mode_final"]
    valid = estimate.where(estimate.valid, drop=True)
    assert 0 < valid.sizes["time"] < estimate.sizes["time"]
    assert float(valid.attitude_error_deg.max()) < 5.0
    sigma_deg = np.degrees(np.linalg.norm(valid.attitude_sigma_body_rad, axis=1))
    assert (valid.attitude_error_deg < 4.0 * sigma_deg).all()


def test_histories_of_a_cut_run_are_as_long_as_they_are_whole(copy):
    with h5py.File(copy.path / "truth.h5", "r+") as file:
        file["r_eci_m"][100:] = np.nan
    assert copy.truth.sizes["time"] == copy.estimate.sizes["time"] == 100


def test_after_the_end_of_a_cut_log_no_mode_is_known(copy):
    lines = copy.log.read_text().splitlines(keepends=True)
    last = next(place for place, line in enumerate(lines) if f" {TickDone.ID:03X}#64" in line)  # tick 100
    copy.log.write_text("".join(lines[: last + 1]))
    estimate = copy.estimate
    assert estimate.sizes["time"] == copy.truth.sizes["time"] == 302
    assert not estimate.mode[:101].isnull().any()
    assert estimate.mode[101:].isnull().all()


@pytest.mark.long
def test_truth_has_the_momentum_of_a_driven_wheel(tmp_path):
    run = torquer.fly("microsat-wheel", orbits=0.005, out=tmp_path / "run")
    momentum_nms = run.truth.wheel_nms
    with h5py.File(run.path / "truth.h5") as file:
        assert np.array_equal(momentum_nms, file["wheel_nms"])
    assert momentum_nms.attrs["units"] == "N m s"


def test_pulses_are_those_of_the_audit(flown):
    pulses = flown.pulses
    assert list(pulses.columns) == ["coil", "level", "dipole_am2", "start_s", "end_s", "length_s"]
    assert len(pulses) == flown.summary["pulses"]["total"] > 0
    levels_am2 = flown.scenario.coils.levels_am2
    assert [abs(m) for m in pulses.dipole_am2] == [levels_am2[abs(level) - 1] for level in pulses.level]
    assert (np.sign(pulses.dipole_am2) == np.sign(pulses.level)).all()
    assert (pulses.end_s - pulses.start_s == pulses.length_s).all()


def test_a_run_without_pulses_has_a_table_without_rows(tmp_path):
    run = torquer.fly("microsat", orbits=0.005, out=tmp_path / "run")
    assert run.pulses.empty
    assert list(run.pulses.dtypes.astype(str)) == ["int64", "int64", *["float64"] * 4]


@pytest.mark.long
def test_without_the_extra_only_tables_and_histories_are_missing(copy, monkeypatch):
    for package in ("xarray", "pandas"):
        monkeypatch.setitem(sys.modules, package, None)
    for name, package in (("truth", "xarray"), ("estimate", "xarray"), ("pulses", "pandas")):
        with pytest.raises(torquer.InputError, match=rf"needs {package}: .*torquer\[data\]"):
            getattr(copy, name)
    assert copy.summary["limits_ok"]
    assert copy.check().ok
    assert copy.replay().ok
    assert copy.replay(plant=True).ok


def test_the_failures_of_the_summary_are_those_of_the_run(copy):
    failed = {"replay": "the replay is not exact: tick 3"}
    (copy.path / "summary.json").write_text(json.dumps({**copy.summary, "failures": failed}))
    run = torquer.load(str(copy.path))
    assert run.failures == failed
    assert not run.ok


@pytest.mark.parametrize("content", ["", "[1]", "{", "{}", "[" * 100_000])
def test_a_damaged_summary_is_wrong_input(content, copy):
    (copy.path / "summary.json").write_text(content)
    with pytest.raises(torquer.InputError, match=r"summary\.json"):
        torquer.load(copy.path).ok  # noqa: B018  to be asked for is to fail


@pytest.mark.parametrize("path", ["nowhere", 3, None, ""])
def test_what_is_no_run_is_not_loaded(path):
    with pytest.raises(torquer.InputError):
        torquer.load(path)


def test_it_shows_as_its_summary(flown):
    assert str(flown).startswith("microsat, seed 7: 302 s flown")
    assert repr(flown) == f"<Run {flown.path}>"
