"""NetCDF, opened by xarray: the run's own numbers, time, units and what identifies the flight."""

import numpy as np
import pytest
import xarray

from sim.record.truth import COLUMNS

pytestmark = pytest.mark.long


@pytest.fixture
def dataset(exported):
    with xarray.open_dataset(exported("nc"), engine="h5netcdf") as opened:
        yield opened


@pytest.mark.parametrize(("name", "unit"), [(name, unit) for name, _, unit, _ in COLUMNS])
def test_every_history_of_the_plant_is_there_with_its_unit(flight, dataset, name, unit):
    assert np.array_equal(dataset[name].values, flight.truth[name])
    assert dataset[name].attrs["units"] == unit
    assert dataset[name].attrs["long_name"]


def test_components_are_chosen_by_name(flight, dataset):
    chosen = dataset["q_body_from_orbit"].sel(wxyz="w")
    assert np.array_equal(chosen.values, flight.truth["q_body_from_orbit"][:, 0])
    assert dataset["torque_body_nm_coils"].dims == ("time", "xyz")


def test_time_is_utc(flight, dataset):
    began_us = flight.entries[0].timestamp_us
    assert dataset["time"].values[0] == np.datetime64(began_us, "us")
    assert dataset["time"].values[-1] == np.datetime64(began_us + 399_000_000, "us")


def test_the_file_says_which_flight_it_is_of(dataset):
    assert (dataset.attrs["scenario"], dataset.attrs["seed"], dataset.attrs["tick_hz"]) == ("microsat", 5, 1)
    assert dataset.attrs["Conventions"] == "CF-1.11"


def test_estimates_are_those_of_the_csv(exported, dataset):
    columns = np.genfromtxt(exported("csv"), delimiter=",", names=True)
    assert np.array_equal(dataset["estimate_error_deg"], columns["estimate_error_deg"], equal_nan=True)
    assert np.array_equal(dataset["mode"], columns["mode"])
