"""Field tracking linearised: against flights of the law, and against the PD law where the field stands."""

import numpy as np
import pytest

from sim.design.field_tracking_stability import (
    RATES,
    STIFFNESSES,
    best_tracking,
    tracking_degree,
    tracking_loop,
)
from sim.design.theory.bodies import Body, diagonal
from sim.design.theory.floquet import monodromy
from sim.design.theory.linear import Gains, closed_loop
from sim.validate.review.law_flight import LawFlight, fly

BOOM = Body("boom", diagonal((0.3, 2.0, 2.2)), 800.0, 98.6)
MICROSAT = Body("50 kg", diagonal((1.02, 1.85, 1.95)), 800.0, 98.6)
GAINS = Gains(1.2e6, 800.0)


@pytest.mark.long
@pytest.mark.parametrize("body", [BOOM, MICROSAT], ids=lambda body: body.name)
def test_a_flight_of_the_law_ends_where_the_map_of_an_orbit_says(body):
    """From a small turn; the flight samples the field every 2 s and begins with one sample alone."""
    turn = 1e-3 * np.array([1.0, -2.0, 1.5])
    flown = fly(
        LawFlight(
            "field_tracking",
            body.inertia_kgm2,
            k_w=GAINS.k_w,
            k_a=GAINS.k_a,
            rotation_rad=tuple(turn.tolist()),
            relative=True,
            orbits=1.001,
            step_s=2.0,
        )
    )
    last = int(np.searchsorted(flown.orbits, 1.0))
    expected = monodromy(tracking_loop(body, GAINS)) @ np.concatenate([np.zeros(3), turn])
    got = 2.0 * flown.q_body_from_orbit[last, 1:] * np.sign(flown.q_body_from_orbit[last, 0])
    np.testing.assert_allclose(got, expected[3:], atol=0.02 * np.linalg.norm(expected[3:]))


def test_over_the_equator_it_is_the_pd_law():
    """There the dipole's field does not turn in the orbital frame."""
    body, u = Body("equator", diagonal((1.02, 1.85, 1.95)), 800.0, 0.0), np.array([0.4, 2.0])
    np.testing.assert_array_equal(tracking_loop(body, GAINS)(u), closed_loop(body, GAINS)(u))


@pytest.mark.long
def test_a_boom_is_stabilised_and_a_body_without_one_hardly():
    """Hardly: by a factor e in more than 25 orbits."""
    assert best_tracking(BOOM).degree < -0.2
    assert best_tracking(MICROSAT).degree > -0.0063


@pytest.mark.long
def test_the_best_gains_are_those_of_a_positive_grid():
    found, w0 = best_tracking(BOOM), BOOM.rate_radps
    unit = (0.3 + 2.0 + 2.2) / 3.0 * w0 / BOOM.field_t**2
    degrees = tracking_degree(BOOM, Gains(unit * RATES[:, None], unit * w0 * STIFFNESSES))
    i, j = np.unravel_index(degrees.argmin(), degrees.shape)
    assert found.degree == pytest.approx(degrees[i, j])
    assert found.gains[:2] == pytest.approx((unit * RATES[i], unit * w0 * STIFFNESSES[j]))


def test_gains_found_for_pd_drive_the_body_away():
    assert tracking_degree(MICROSAT, Gains(6.27e6, 1615.0)) > 0.05
