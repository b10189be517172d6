"""Sweeps: one difference has the size that is asked for, all others are those of the population."""

import numpy as np
import pytest

from sim.campaign.consistency import consistency_figures
from sim.campaign.population import satellite
from sim.scenario.schema import flight_table, load
from sim.validate.population.sweep import QUANTITIES, sweep_order

DIPOLE, INERTIA, TURNS = QUANTITIES
KEYS = {
    "dipole": ("disturbance.residual_dipole_am2", "disturbance.residual_dipole_eclipse_am2"),
    "inertia": ("body.inertia_kgm2",),
    "turns": ("sensors.magnetometer.misalignment_deg", "sensors.sun.misalignment_deg"),
}


def flat(values, prefix=""):
    for key, value in values.items():
        if isinstance(value, dict):
            yield from flat(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", value


def flown(quantity, size, seed=5):
    return sweep_order(quantity, size, seed).overrides


@pytest.mark.parametrize("quantity", QUANTITIES, ids=lambda quantity: quantity.name)
def test_nothing_else_differs_from_the_satellite_of_the_population(quantity):
    drawn, changed = dict(flat(satellite("50kg", 5))), dict(flat(flown(quantity, quantity.bound)))
    assert {key for key in drawn if drawn[key] != changed[key]} == set(KEYS[quantity.name])
    assert drawn.keys() == changed.keys()


@pytest.mark.parametrize(
    ("quantity", "sizes"),
    [(DIPOLE, [0.001, np.sqrt(0.0002), 0.2]), (INERTIA, [0.0, 10.0, 20.0]), (TURNS, [0.0, 1.5, 3.0])],
)
def test_sizes_go_to_twice_the_bound(quantity, sizes):
    assert quantity.sizes(3) == pytest.approx(sizes)
    assert len(quantity.sizes(6)) == 6
    assert quantity.sizes(6)[-1] == pytest.approx(2.0 * quantity.bound)


@pytest.mark.parametrize("size_am2", [0.001, 0.07, 0.2])
def test_the_dipole_has_its_size_and_the_direction_that_was_drawn(size_am2):
    drawn, changed = satellite("50kg", 5)["disturbance"], flown(DIPOLE, size_am2)["disturbance"]
    factor = size_am2 / np.linalg.norm(drawn["residual_dipole_am2"])
    for key in ("residual_dipole_am2", "residual_dipole_eclipse_am2"):
        assert changed[key] == pytest.approx(factor * np.array(drawn[key]))


def test_the_error_of_the_inertia_has_one_shape_at_every_size():
    for seed in range(1, 9):
        nominal = np.diag(flown(INERTIA, 0.0, seed)["body"]["inertia_kgm2"])
        assert nominal == pytest.approx([1.02, 1.85, 1.95])
        errors = [np.array(flown(INERTIA, size, seed)["body"]["inertia_kgm2"]) for size in (5.0, 20.0)]
        small, large = (error - np.diag(nominal) for error in errors)
        np.testing.assert_allclose(4.0 * small, large, atol=1e-12)
        assert 100.0 * np.abs(np.diagonal(large) / nominal).max() == pytest.approx(20.0)
        off = np.abs(large[np.triu_indices(3, 1)])
        assert 0.0 < off.min() < off.max() <= 0.04 * nominal.mean()
        load("microsat", flown(INERTIA, 20.0, seed))


def test_both_sensors_turn_about_the_axes_that_were_drawn_to_the_same_part_of_their_bounds():
    drawn, changed = satellite("50kg", 5)["sensors"], flown(TURNS, 2.4)["sensors"]
    for name, size_deg in (("magnetometer", 1.6), ("sun", 0.8)):
        turn, axis = changed[name]["misalignment_deg"], np.array(drawn[name]["misalignment_deg"])
        assert turn == pytest.approx(size_deg * axis / np.linalg.norm(axis))


def orders(sizes, seeds):
    return [
        sweep_order(quantity, size, seed)
        for seed in seeds
        for quantity in QUANTITIES
        for size in quantity.sizes(sizes)
    ]


def test_what_is_declared_does_not_change():
    tables = [flight_table(load(order.scenario, order.overrides)).uncertainty for order in orders(2, [1, 2])]
    assert len(tables) == 12
    assert all(table == tables[0] for table in tables)


def test_the_flights_are_those_of_every_size_and_satellite():
    flown = orders(4, [1, 2, 3])
    assert len({order.name for order in flown}) == len(flown) == 3 * 4 * 3
    assert {order.orbits for order in flown} == {8.0}
    assert all(order.measure is consistency_figures for order in flown)
