"""The coming part of the orbit: its field and rate, evaluated and interpolated."""

import numpy as np
import pytest

from fsw.core.laws.plan.orbit_ahead import interpolated_orbit, orbit_ahead, sight
from fsw.core.orbit.ephemeris import ephemeris_model
from fsw.core.orbit.field import FieldKind
from fsw.core.orbit.propagation import circular_orbit, sgp4_orbit, state_eci

EPOCH = 1_767_225_600
TLE = (
    "1 22826U 93061D   15086.11593543  .00000251  00000-0  11414-3 0  9992",
    "2 22826  98.6946  36.4208 0008932 173.8349 186.2944 14.30166407121352",
)
ORBIT_S = 6040.0


def model_of(kind, orbit=None):
    return ephemeris_model(orbit or sgp4_orbit(*TLE), EPOCH, 1, kind)


def test_the_field_is_that_of_the_orbit_to_come(bench):
    orbit = bench.Orbit()
    circle = circular_orbit(orbit.altitude_km, orbit.inclination_deg, 0.0, 0.0, EPOCH)
    times = 500.0 + 60.0 * np.arange(100)
    ahead = orbit_ahead(model_of(FieldKind.DIRECT_DIPOLE, circle), (EPOCH + times).tolist())
    expected = [orbit.c_orbit_from_eci(t) @ orbit.b_eci_t(t) for t in times]
    assert ahead.b_orbit_t == pytest.approx(np.array(expected), abs=1e-10)


def test_the_rate_is_that_of_the_orbital_frame():
    """The turn of its axes within a second."""
    model = model_of(FieldKind.DIRECT_DIPOLE)

    def axes(unix_s):
        r, v = map(np.array, state_eci(model.orbit, unix_s))
        e1, normal = r / np.linalg.norm(r), np.cross(r, v)
        e3 = normal / np.linalg.norm(normal)
        return np.array([e1, np.cross(e3, e1), e3])

    times = EPOCH + 60.0 * np.arange(100)
    expected = [(axes(t + 0.5) @ axes(t - 0.5).T)[1, 0] for t in times]
    assert np.ptp(np.abs(expected)) > 1e-6
    assert orbit_ahead(model, times.tolist()).rate_radps == pytest.approx(np.abs(expected), rel=1e-5)


@pytest.mark.interpreted
def test_none_where_the_orbit_has_no_position(monkeypatch):
    monkeypatch.setattr("fsw.core.laws.plan.orbit_ahead.state_eci", lambda orbit, unix_s: None)
    model = model_of(FieldKind.DIRECT_DIPOLE)
    assert orbit_ahead(model, [EPOCH, EPOCH + 60.0]) is None
    assert interpolated_orbit(model, EPOCH, sight([0.0, 60.0], ORBIT_S)) is None


class TestSight:
    @pytest.mark.parametrize("degree", range(4))
    def test_no_error_is_made_in_a_polynomial(self, degree):
        wanted_s = [10.0, 700.0, 650.0, 1234.0]
        by = sight(wanted_s, ORBIT_S)
        assert by.weights @ np.array(by.nodes_s) ** degree == pytest.approx(np.array(wanted_s) ** degree)

    @pytest.mark.parametrize(("share", "most_t"), [(0.12, 2e-8), (0.36, 3e-7), (1.11, 2e-6)])
    @pytest.mark.parametrize("start_s", [0.0, 1400.0, 9000.0, 31000.0])
    @pytest.mark.parametrize("altitude_km", [300.0, 800.0])
    def test_the_field_of_the_earth_is_seen_closely(self, altitude_km, start_s, share, most_t):
        model = model_of(FieldKind.IGRF14, circular_orbit(altitude_km, 97.0, 20.0, 10.0, EPOCH))
        wanted_s = np.linspace(0.0, share * ORBIT_S, 40)
        by = sight(wanted_s.tolist(), ORBIT_S)
        here = interpolated_orbit(model, EPOCH + start_s, by)
        exact = orbit_ahead(model, (EPOCH + start_s + wanted_s).tolist())
        assert np.abs(here.b_orbit_t - exact.b_orbit_t).max() < most_t
        assert len(by.nodes_s) <= 0.5 * len(wanted_s)

    def test_so_is_the_rate_of_an_orbit_that_is_no_circle(self):
        model, wanted_s = model_of(FieldKind.DIRECT_DIPOLE), np.linspace(0.0, 2190.0, 40)
        here = interpolated_orbit(model, EPOCH + 900.0, sight(wanted_s.tolist(), ORBIT_S))
        exact = orbit_ahead(model, (EPOCH + 900.0 + wanted_s).tolist()).rate_radps
        assert here.rate_radps == pytest.approx(exact, abs=1e-3 * np.ptp(exact))

    def test_nothing_is_evaluated_after_the_last_time_or_before_the_first(self):
        assert all(0.0 < node_s < 2190.0 for node_s in sight([0.0, 1000.0, 2190.0], ORBIT_S).nodes_s)


def test_a_circle_turns_evenly():
    ahead = orbit_ahead(
        model_of(FieldKind.DIRECT_DIPOLE, circular_orbit(800.0, 98.6, 20.0, 10.0, EPOCH)),
        [EPOCH + 60.0 * k for k in range(30)],
    )
    assert np.ptp(ahead.rate_radps) < 1e-15
