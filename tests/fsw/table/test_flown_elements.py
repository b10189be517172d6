"""Elements are refused where SGP4 leaves the orbit that they are of, which it does without an error."""

from datetime import UTC, datetime

import pytest

from fsw.core.orbit.propagation import sgp4_orbit, state_eci
from fsw.input.schema import TableError
from fsw.table.flown_elements import check_flown
from fsw.table.table import flight_table

DECAYING = (
    "1 45110U 20007A   23232.80903846  .00110000  00000-0  32750-2 0    04",
    "2 45110  69.9913 111.5649 0009740 159.9373 200.0626 15.34502222    06",
)
"""At 460 km, and with a drag that ends it within half a year."""
ITAMSAT = (
    "1 22826U 93061D   15086.11593543  .00000251  00000-0  11414-3 0  9992",
    "2 22826  98.6946  36.4208 0008932 173.8349 186.2944 14.30166407121352",
)


def unix_s(text):
    return datetime.fromisoformat(text).replace(tzinfo=UTC).timestamp()


@pytest.mark.parametrize(
    ("begin", "said"),
    [
        ("2024-03-01", r"at \d+\.\d km on 2024-03-01 .* UTC, 193\.2 days after their epoch: at least 150 km"),
        ("2024-03-15", r"at -?\d+\.\d km on 2024-03-15"),
        ("2025-12-17", r"at \d+ km on 2025-12-17 .* semi-major axis of \d+ km, .* that of 68\d\d km"),
        ("2024-09-01", r"SGP4 has no orbit on 2024-09-01 .*: .*decay"),
    ],
)
def test_elements_that_have_decayed_are_refused_with_altitude_and_time(begin, said):
    with pytest.raises(ValueError, match=said):
        check_flown(sgp4_orbit(*DECAYING), unix_s(begin), unix_s(begin))


@pytest.mark.parametrize("end", ["2024-03-01", "2024-03-15", "2024-09-01", "2025-12-17", "2027-01-01"])
def test_a_decay_at_any_time_of_a_flight_is_found(end):
    begin_s = unix_s("2023-08-21")
    check_flown(sgp4_orbit(*DECAYING), begin_s, begin_s + 86400.0)
    with pytest.raises(ValueError, match=r"the elements|SGP4 has no orbit"):
        check_flown(sgp4_orbit(*DECAYING), begin_s, unix_s(end))


def test_an_orbit_at_800_km_holds_for_years():
    begin_s = unix_s("2015-03-27")
    check_flown(sgp4_orbit(*ITAMSAT), begin_s, begin_s + 5 * 365 * 86400.0)


@pytest.mark.parametrize("begin", ["2024-03-15", "2025-12-17"])
def test_the_onboard_orbit_has_no_position_there(begin):
    assert state_eci(sgp4_orbit(*DECAYING), unix_s("2023-08-25")) is not None
    assert state_eci(sgp4_orbit(*DECAYING), unix_s(begin)) is None


def test_a_table_with_such_elements_is_refused():
    values = {"orbit": {"tle": DECAYING}, "time": {"epoch_utc": "2025-12-17T00:00:00Z"}}
    with pytest.raises(TableError, match=r"mine: orbit\.tle: the elements are at \d+ km on 2025-12-17"):
        flight_table(values, "mine")
