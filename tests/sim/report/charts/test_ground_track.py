"""Where the satellite was above the Earth."""

import numpy as np
import pytest

from sim.plant.environment.earth import gmst82_rad
from sim.report.charts.ground_track import below_deg, broken


def test_longitude_turns_with_the_earth_and_latitude_is_geocentric(made_run):
    t_s = np.arange(100.0)
    flight = made_run(ticks=100, pulses=()).flown(r_eci_m=np.tile([5e6, 0.0, 5e6], (100, 1)))
    longitude, latitude = below_deg(flight)
    turned = np.degrees(gmst82_rad(flight.start_unix_s, t_s))
    assert latitude == pytest.approx(np.full(100, 45.0))
    assert np.cos(np.radians(longitude + turned)) == pytest.approx(np.ones(100))


def test_a_track_over_the_edge_of_the_map_is_broken_there():
    longitude, latitude = broken(np.array([170.0, 179.0, -172.0]), np.array([1.0, 2.0, 3.0]))
    assert longitude == pytest.approx([170.0, 179.0, np.nan, -172.0], nan_ok=True)
    assert latitude == pytest.approx([1.0, 2.0, np.nan, 3.0], nan_ok=True)
