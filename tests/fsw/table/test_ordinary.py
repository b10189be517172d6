"""Ordinary residual dipole and disturbance torque: by size, and by height where the air counts."""

import numpy as np
import pytest

from fsw.input.schema import TableError
from fsw.table.ordinary import ordinary_dipole_am2, ordinary_torque_nm
from fsw.table.table import flight_table
from fsw.table.uncertainty import LARGEST_FIELD_T
from sim.plant.environment.atmosphere import density_kgpm3

INERTIA = ((1.2, 0.03, -0.02), (0.03, 1.5, 0.05), (-0.02, 0.05, 2.1))
"""Mean moment 1.6 kg m^2: the size for which the ordinary values are written."""
TLE = [
    "1 22826U 93061D   15086.11593543  .00000251  00000-0  11414-3 0  9992",
    "2 22826  98.6946  36.4208 0008932 173.8349 186.2944 14.30166407121352",
]
"""Perigee at a (1 - e) - R = 7169.6 (1 - 0.0008932) - 6378.1 = 785 km; SGP4's own a is 3 km less."""
TRANSFER = [
    "1 22826U 93061D   15086.11593543  .00000251  00000-0  11414-3 0  9992",
    "2 22826  98.6946  36.4208 0300000 173.8349 186.2944 14.30166407121353",
]
"""The same at an eccentricity of 0.03: perigee at 576 km."""


def table_at(altitude_km=None, tle=None, **sections):
    orbit = {"tle": tle} if tle else {"tle": None, "altitude_km": altitude_km}
    return flight_table({"time": {"epoch_utc": "2025-03-20T09:00:00Z"}, "orbit": orbit, **sections}, "x")


@pytest.mark.parametrize(("moments", "volume"), [(1.0, 1.0), (1e-3, 10.0**-1.8), (1e5, 1e3)])
def test_both_grow_with_the_volume(moments, volume):
    """Of bodies of one density J ~ l^5, so that l^3 ~ J^(3/5): a 3U has 1/60 of a 50 kg satellite's."""
    body = tuple(tuple(moments * entry for entry in row) for row in INERTIA)
    assert ordinary_dipole_am2(body) == pytest.approx(0.1 * volume)
    assert ordinary_torque_nm(body, 800.0) == pytest.approx(3e-8 * volume)


@pytest.mark.parametrize("height_km", [780.0, 800.0, 1500.0, 40_000.0])
def test_where_light_outweighs_drag_the_height_makes_no_difference(height_km):
    assert ordinary_torque_nm(INERTIA, height_km) == pytest.approx(3e-8)


@pytest.mark.parametrize("height_km", [400.0, 450.0, 500.0, 550.0, 600.0, 650.0, 700.0, 750.0])
def test_below_the_torque_grows_as_the_density(height_km):
    """Against the atmosphere of the plant, an implementation of its own."""
    density, at_least = density_kgpm3(1e3 * np.array([height_km, 780.0]))
    grown = ordinary_torque_nm(INERTIA, height_km) / 3e-8
    assert 1.0 / 1.5 < grown / (density / at_least) < 1.5


def test_of_an_orbit_the_perigee_counts():
    assert table_at(tle=TLE).orbit.perigee_km == pytest.approx(785.0, abs=4.0)
    assert table_at(tle=TRANSFER).orbit.perigee_km == pytest.approx(576.4, abs=4.0)
    assert table_at(450.0).orbit.perigee_km == 450.0
    assert table_at(tle=TRANSFER).ordinary.torque_nm > 10.0 * table_at(tle=TLE).ordinary.torque_nm


THROUGH_THE_EARTH = [
    "1 22826U 93061D   15086.11593543  .00000251  00000-0  11414-3 0  9992",
    "2 22826  98.6946  36.4208 2000000 173.8349 186.2944 14.30166407121352",
]


def test_an_orbit_through_the_earth_is_refused_in_a_sentence():
    with pytest.raises(TableError, match=r"orbit: the perigee is 0\.101 Earth radii below the ground"):
        table_at(tle=THROUGH_THE_EARTH)


def test_no_torque_is_ordinary_that_the_coils_could_not_hold():
    """A bound that is given would be refused there."""
    low = table_at(250.0)
    assert low.ordinary.torque_nm < ordinary_torque_nm(low.body.inertia, 250.0)
    assert low.ordinary.torque_nm == low.coils.levels_am2[2] * low.coils.on_part * LARGEST_FIELD_T
    given = {"uncertainty": {"torque_nm": low.ordinary.torque_nm}}
    assert table_at(250.0, **given).uncertainty.torque_nm == low.ordinary.torque_nm
