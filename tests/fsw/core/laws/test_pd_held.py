"""The held dipole: computed once in a cycle, off while it measures, the mean torque kept, not too long."""

import numpy as np
import pytest

from fsw.core.estimation.attitude import UNKNOWN
from fsw.core.laws.pd import pd
from fsw.core.laws.pd_held import ApartGains, HoldGains
from fsw.core.laws.table import LAWS

K_W, K_A = 6.2694e6, 1614.9
NOTHING = (0.0, 0.0, 0.0)


@pytest.fixture
def dipoles(bench, turned):
    """A law's dipole in each second of some, and pd's, on a body that turns."""

    def of(name, own, seconds):
        orbit, point, memory, rows = bench.Orbit(), bench.setpoint(k_w=K_W, k_a=K_A), (), []
        settings = bench.config(bench.Body(), 1.0, {name: own})
        for tick in range(700, 700 + seconds):
            c = turned((1, -2, 3), 25.0 + 0.1 * tick) @ orbit.c_orbit_from_eci(float(tick))
            inputs = bench.inputs_at(orbit, tick, 1.0, c, np.array([1e-3, 2e-3, -1e-3]), None)
            demand = LAWS[name].point(inputs, memory, point, settings)
            memory = demand.memory
            assert (demand.pulse is None) == (demand.memory[1] == 1.0)
            rows.append((demand.m_body_am2, pd(inputs, (), point, settings).m_body_am2))
        return rows

    return of


def test_the_dipole_of_a_cycles_first_tick_is_held(dipoles):
    rows = dipoles("pd_held", HoldGains(5.0), 12)
    own, plain = zip(*rows, strict=True)
    assert own == (*[plain[0]] * 5, *[plain[5]] * 5, *[plain[10]] * 2)
    assert plain[0] != plain[4]


def test_while_it_measures_the_coils_are_off_and_then_give_the_mean(dipoles):
    rows = dipoles("pd_apart", ApartGains(4.0, 2.0), 12)
    own, plain = zip(*rows, strict=True)
    assert own[:4] == own[6:10] == (NOTHING,) * 4
    assert own[4] == own[5] == pytest.approx(tuple(3.0 * part for part in plain[4]))
    assert own[10] == own[11] == pytest.approx(tuple(3.0 * part for part in plain[10]))


@pytest.mark.parametrize("name", ["pd_held", "pd_apart"])
def test_an_unknown_attitude_ends_the_cycle(bench, turned, name):
    orbit = bench.Orbit()
    inputs = bench.inputs_at(orbit, 700, 1.0, turned((1, 2, 3), 25.0), np.zeros(3), None)
    settings = bench.config(bench.Body(), 1.0, {name: LAWS[name].gains()})
    demand = LAWS[name].point(
        inputs.replace(attitude=UNKNOWN), (650.0, 1.0, 0.1, 0.2, 0.3), bench.setpoint(), settings
    )
    assert demand.m_body_am2 == NOTHING
    assert demand.memory == ()


@pytest.mark.parametrize("name", ["pd_held", "pd_apart"])
def test_upside_down_the_far_form_turns_and_the_near_form_rests(bench, turned, name):
    orbit = bench.Orbit()
    c = turned((0, 1, 0), 180.0) @ orbit.c_orbit_from_eci(700.0)
    inputs = bench.inputs_at(orbit, 700, 1.0, c, orbit.rate_radps * c[:, 2], None)
    own = HoldGains() if name == "pd_held" else ApartGains(measure_s=0.0)
    settings, point = bench.config(bench.Body(), 1.0, {name: own}), bench.setpoint(k_w=0.0, k_a=K_A)
    assert np.linalg.norm(LAWS[name].acquire(inputs, (), point, settings).m_body_am2) > 1e-3
    assert np.linalg.norm(LAWS[name].point(inputs, (), point, settings).m_body_am2) < 1e-9


@pytest.fixture(scope="module")
def last_deg(bench, turned):
    """Largest angle in the last of four orbits, from 20 deg."""

    def run(name, own, share=1.0):
        flight = bench.fly_from_rest(
            LAWS[name].point,
            bench.setpoint(k_w=share * K_W, k_a=share**2 * K_A),
            gains={name: own},
            body=bench.Body(most_am2=5.0),
            c_body_from_orbit=turned((1, 2, 3), 20.0),
            orbits=4.0,
            step_s=10.0,
        )
        return flight.angle_deg[-600:].max()

    return run


@pytest.mark.long
def test_held_for_minutes_the_attitude_still_converges(last_deg):
    """The claim of the source."""
    assert last_deg("pd_held", HoldGains(200.0)) < 0.5


@pytest.mark.long
def test_measuring_as_long_as_acting_it_does_too(last_deg):
    assert last_deg("pd_apart", ApartGains(120.0, 120.0)) < 1.0


@pytest.mark.long
def test_held_too_long_for_its_gains_it_diverges(last_deg):
    assert last_deg("pd_held", HoldGains(600.0)) > 90.0


@pytest.mark.parametrize(
    ("kind", "changed"),
    [(HoldGains, {"hold_s": 0.0}), (ApartGains, {"act_s": 0.0}), (ApartGains, {"measure_s": -1.0})],
)
def test_lengths_out_of_range_are_refused(kind, changed):
    with pytest.raises(ValueError, match="must"):
        kind(**changed)
