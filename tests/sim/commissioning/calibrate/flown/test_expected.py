"""What the models expect of a log, and times that they do not reach."""

import numpy as np
import pytest

from fsw.table.table import flight_table
from sim.commissioning.calibrate.flown.expected import expected
from sim.errors import HarnessError

TABLE = flight_table({}, "table.toml")


def test_field_and_sun_come_for_each_time():
    along = expected(TABLE, TABLE.epoch_unix_s + np.arange(0.0, 100.0, 0.1))
    assert along.b_eci_nt.shape == (1000, 3)
    assert (np.abs(np.linalg.norm(along.b_eci_nt, axis=1) - 40000.0) < 20000.0).all()
    assert np.linalg.norm(along.sun_eci, axis=1) == pytest.approx(1.0, abs=1e-6)


def test_times_beyond_the_field_model_are_named():
    with pytest.raises(HarnessError) as error:
        expected(TABLE, 1_999_999_990.0 + np.arange(20.0))
    assert str(error.value) == (
        "the log is of 2033-05-18 03:33:10 to 2033-05-18 03:33:29 UTC: "
        "the IGRF-14 table covers 1900 to 2030; the time asked for lies outside"
    )
