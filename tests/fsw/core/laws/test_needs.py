"""What holds for each law of the review: nothing asked for without what it needs, nothing infinite."""

from math import isfinite

import numpy as np
import pytest

from fsw.core.laws.entry import Need
from fsw.core.laws.interface import FieldSample
from fsw.core.laws.table import LAWS

NOTHING = (0.0, 0.0, 0.0)
NO_SAMPLE = FieldSample()
SUN = np.array([0.6, 0.0, 0.8])
NEEDS = {
    "bdot_switched": {"second sample"},
    "rate_damping_matrix": {"attitude"},
    "bdot_held": {"second sample"},
    "least_momentum": {"attitude", "orbit"},
    "least_energy": {"attitude", "orbit"},
    "rate_model": {"attitude", "orbit"},
    "nutation": {"second sample"},
    "spin_up": {"attitude", "orbit"},
    "y_thomson": {"attitude", "orbit"},
    "spin_relay": {"attitude", "orbit"},
    "reorientation": {"attitude", "orbit"},
    "three_term": {"attitude", "orbit"},
    "roll_precession": {"attitude", "orbit"},
    "target_precession": {"attitude", "orbit"},
    "relay_stages": {"attitude", "orbit", "second sample"},
    "stepped_precession": {"attitude", "orbit"},
    "dual_spin": {"attitude", "wheel"},
    "horizon_roll": {"attitude", "wheel"},
    "six_gain": {"attitude", "wheel"},
    "wheel_integral": {"attitude", "wheel"},
    "wheel_relay": {"attitude", "wheel"},
    "field_tracking": {"orbit", "second sample"},
    "field_tracking_pd": {"orbit", "second sample"},
    "sun_pointing": {"orbit", "sun"},
    "pd_when_slow": {"attitude"},
    "slow_spin": {"second sample"},
    "sun_panels": {"attitude", "orbit", "sun"},
    "sun_critical": {"attitude", "orbit", "sun"},
    "direction_tracking": {"orbit", "second sample"},
    "pd_inertial": {"attitude", "orbit"},
    "field_direction": {"orbit", "second sample"},
    "pd_held": {"attitude"},
    "pd_delayed": {"attitude"},
    "two_step": {"attitude", "orbit"},
    "pd_neural": {"attitude", "orbit"},
    "sphere_vertical": {"attitude"},
    "sphere_output": {"attitude", "orbit"},
    "sliding_realisable": {"attitude", "orbit"},
    "sliding_rate": {"attitude", "orbit"},
    "sliding_rate_modified": {"attitude", "orbit"},
    "sliding_twisting": {"attitude", "orbit"},
    "sliding_sphere": {"attitude", "orbit"},
}


@pytest.fixture(scope="module")
def ask(bench, turned):
    """The dipole of a law in its second tick, with something missing in both."""

    def asked(name, missing="", orbit=None):
        row, orbit = LAWS[name], orbit or bench.Orbit()
        body = bench.Body(wheel=NOTHING if missing == "wheel" else (0.0, 0.0, 0.05))
        settings = bench.config(body, 1.0, {name: row.gains()} if row.gains else {})
        point = bench.setpoint(name, k_w=1e7, k_a=2000.0, spin_radps=0.02)
        before, memory, demand = NO_SAMPLE, (), None
        for tick in (500, 501):
            c = turned((1, 2, 3), 25.0 + 0.5 * (tick - 500)) @ orbit.c_orbit_from_eci(tick)
            omega = np.radians(0.5) * np.array([1, 2, 3]) / np.sqrt(14.0) + orbit.rate_radps * c[:, 2]
            inputs = bench.inputs_at(
                orbit,
                tick,
                1.0,
                c,
                omega,
                before,
                None if missing == "sun" else SUN,
                known=missing != "attitude",
                sampled=missing != "second sample" or tick == 500,
            )
            if missing == "orbit":
                inputs = inputs.replace(reference=None)
            demand = row.acquire(inputs, memory, point, settings)
            before, memory = inputs.sample, demand.memory
        return demand.m_body_am2

    return asked


@pytest.mark.parametrize("name", NEEDS)
def test_with_all_at_hand_each_law_acts(ask, name):
    m = ask(name)
    assert all(map(isfinite, m))
    assert m != NOTHING


@pytest.mark.parametrize(
    ("name", "missing"), [(name, need) for name, needs in NEEDS.items() for need in sorted(needs)]
)
def test_nothing_is_asked_for_without_what_the_law_needs(ask, name, missing):
    assert ask(name, missing) == NOTHING


@pytest.mark.parametrize(
    ("name", "missing"),
    [
        (name, other)
        for name, needs in NEEDS.items()
        for other in sorted({"attitude", "orbit", "sun", "second sample", "wheel"} - needs)
    ],
)
def test_what_a_law_does_not_need_may_be_missing(ask, name, missing):
    assert ask(name, missing) != NOTHING


@pytest.mark.parametrize("name", NEEDS)
def test_without_a_field_nothing_is_asked_for(ask, bench, name):
    assert ask(name, orbit=bench.Orbit(dipole=0.0)) == pytest.approx(NOTHING, abs=0.0)


def test_the_table_of_laws_knows_those_that_hold_a_wheel():
    """The others with a wheel drive theirs."""
    assert {name for name, row in LAWS.items() if row.needs is Need.MOMENTUM} == {
        name for name, needs in NEEDS.items() if "wheel" in needs
    }
