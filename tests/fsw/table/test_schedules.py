"""Tables of the periodic regulators: from the table's own body and orbit, for every orbit that flies."""

from dataclasses import fields

import numpy as np
import pytest

from fsw.core.laws.lqr import STEPS
from fsw.core.laws.table import LAWS
from fsw.input.schema import TableError
from fsw.table.config import flight_config
from fsw.table.schedules import SCHEDULERS
from fsw.table.table import flight_table
from sim.design.theory.bodies import Body
from sim.design.theory.periodic_lqr import Augmented, Weights, design

CIRCLE = {"altitude_km": 800.0, "inclination_deg": 98.6, "raan_deg": 30.0, "u0_deg": 70.0}
INERTIA = ((1.02, 0.05, -0.03), (0.05, 1.85, 0.1), (-0.03, 0.1, 1.95))


def schedules(**values):
    return flight_config(flight_table(values, "table")).control.schedules


def test_a_circular_orbit_gives_the_regulator_of_the_design():
    """Within what the length of a step costs; the orbit's plane is found from position and velocity."""
    found = schedules(
        orbit=CIRCLE,
        body={"inertia_kgm2": INERTIA},
        control={"gains": {"lqr": {"rate": 1.0, "effort": 30.0}}},
    )["lqr"]
    body = Body("table", INERTIA, 800.0, 98.6)
    expected = design(body, Weights(rate=1.0, effort=30.0), Augmented.TORQUE, nodes=STEPS).gain
    assert found.problem.step_s == pytest.approx(2.0 * np.pi / body.rate_radps / STEPS, rel=1e-9)
    size = np.abs(expected).max(axis=(0, 1))
    assert (np.abs(found.gains - expected).max(axis=(0, 1)) / size).max() < 15.0 / STEPS


def test_each_law_has_its_own_weights():
    found = schedules(control={"gains": {"mpc": {"effort": 5.0}}})
    assert found["lqr"].problem.effort == pytest.approx(found["mpc"].problem.effort / 50.0)
    assert np.abs(found["mpc"].gains).max() < np.abs(found["lqr"].gains).max()


@pytest.mark.long
@pytest.mark.parametrize("inclination_deg", [0.0, 1e-9, 3.0, 90.0, 180.0])
@pytest.mark.parametrize("inertia", [(1.02, 1.85, 1.95), (1.0, 139.0, 139.0), (1.95, 1.85, 1.02)])
def test_every_orbit_and_body_has_a_finite_schedule(inclination_deg, inertia):
    """Also where nothing can be held for ever: equatorial, gravity gradient unstable."""
    orbit = {"altitude_km": 700.0, "inclination_deg": inclination_deg}
    for found in schedules(orbit=orbit, body={"inertia_kgm2": list(inertia)}).values():
        assert np.isfinite(found.gains).all()
        assert np.isfinite(found.costs).all()
        assert np.abs(found.gains).max() > 0.0


@pytest.mark.long
@pytest.mark.parametrize("momentum_nms", [0.15, 1.0, 20.0])
def test_the_momentum_of_an_ordinary_wheel_keeps_no_table_from_loading(momentum_nms):
    found = schedules(body={"wheel_nms": [0.0, 0.0, momentum_nms]})
    assert all(np.isfinite(one.gains).all() for one in found.values())


def test_the_scheduled_laws_are_laws_with_the_weights_they_need():
    for law in SCHEDULERS:
        assert {"rate", "effort"} <= {field.name for field in fields(LAWS[law].gains)}


@pytest.mark.parametrize(
    ("law", "gains", "named"),
    [
        ("lqr", {"effort": 0.0}, "effort 1e-6 to 1e6"),
        ("lqr", {"rate": -1.0}, "rate must be 0 to 1e6"),
        ("mpc", {"effort": 1e9}, "effort 1e-6 to 1e6"),
        ("mpc", {"horizon_orbits": 99.0}, "horizon_orbits must be 0.1 to 4"),
    ],
)
def test_weights_that_make_no_problem_are_refused(law, gains, named):
    with pytest.raises(TableError, match=named):
        schedules(control={"gains": {law: gains}})
