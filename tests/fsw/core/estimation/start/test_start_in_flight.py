"""A start by Sun cells in flight: the attitude that follows is valid where it is as good as it claims."""

import numpy as np
import pytest

from fsw.core.algebra.quaternion import conjugate, multiply
from fsw.core.events import Event
from fsw.table.config import flight_config
from sim.fault_rig.record import FaultFlightRecord
from sim.fault_rig.rig import Rig
from sim.scenario.schema import flight_table, load, parse_settings

TICKS = 2600
BEYOND = 16.27
"""99.9 % of the chi-square of 3 degrees of freedom."""


class Watched(FaultFlightRecord):
    """Also, by tick, how wrong a valid attitude is: rad, and in its standard deviations, squared."""

    def __init__(self, tick_hz):
        super().__init__(tick_hz)
        self.off = []

    def note_state(self, tick, state, truth):
        super().note_state(tick, state, truth)
        if not state.attitude.valid:
            return
        turn = multiply(conjugate(state.attitude.q_body_from_orbit), tuple(truth.q_body_from_orbit))
        theta = 2.0 * np.sign(turn[0]) * np.array(turn[1:])
        covariance = state.estimator.estimate.covariance[0:3, 0:3]
        self.off.append((np.linalg.norm(theta), theta @ np.linalg.solve(covariance, theta)))


def watched(settings, seed, ticks):
    """A flight of ``cubesat-cells`` with these settings."""
    scenario = load("cubesat-cells", parse_settings(settings))
    rig = Rig(scenario, flight_config(flight_table(scenario)), seed)
    rig.record = Watched(scenario.time.tick_hz)
    while rig.plant.tick < ticks:
        rig.tick()
    return rig.record


@pytest.mark.long
@pytest.mark.parametrize("seed", [5, 11, 13])
@pytest.mark.slow
def test_where_the_sun_is_near_the_field_it_does_not_become_sure_of_a_wrong_attitude(seed):
    """Field and Sun are 25 to 40 deg apart for ten minutes, and the Earth lights the cells."""
    flight = watched(("orbit.u0_deg=288.0",), seed, TICKS)
    off = np.array(flight.off)
    assert len(off) > 1000
    assert np.degrees(off[:, 0].max()) < 10.0
    assert off[:, 1].max() < BEYOND
    assert not [event for event in flight.events if event.number == Event.SENSOR_ISOLATED]


@pytest.mark.long
def test_it_starts_with_a_cell_in_the_shade_of_the_satellite():
    """The plant and the table have the same shade; cell 1 would see the Sun, and shows the Earth alone."""
    shade = "sensors.cells.shades=[{cell=1,axis=[1.0,0.5,0.5],half_deg=30.0}]"
    flight = watched((shade, "initial.rate_degps=[0.3,-0.25,0.2]"), 5, 1000)
    off = np.array(flight.off)
    assert len(off) > 200
    assert np.degrees(off[:, 0].max()) < 10.0
    assert off[:, 1].max() < BEYOND
    assert not [event for event in flight.events if event.number == Event.SENSOR_ISOLATED]
