"""Which attitudes gravity holds: by the equations of motion themselves, for every order of the axes."""

from itertools import permutations

import numpy as np
import pytest

from sim.design.theory.bodies import Body, diagonal
from sim.scenario.schema import load, parse_settings, shipped_names
from sim.sizing.gravity import gravity_on, gravity_words, stiffness

MOMENTS = (0.02, 0.06, 0.075)


def energy(inertia, turn, rate):
    """Dynamic potential of a body at rest in the turning frame, by its rotation vector from nominal."""
    angle = float(np.linalg.norm(turn))
    axis = np.asarray(turn) / angle
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    body_from_orbit = np.eye(3) - np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    up, normal = body_from_orbit[:, 0], body_from_orbit[:, 2]
    return rate**2 * (1.5 * up @ inertia @ up - 0.5 * normal @ inertia @ normal)


@pytest.mark.parametrize("moments", [*permutations(MOMENTS)])
def test_the_stiffness_is_the_curvature_of_the_dynamic_potential(moments):
    body = Body("", diagonal(moments), 500.0, 97.4)
    inertia, d = np.diag(moments), 1e-3
    rest = energy(inertia, (1e-12, 0, 0), body.rate_radps)
    for axis, k in enumerate(stiffness(body)):
        turn = d * np.eye(3)[axis]
        curvature = 2.0 * (energy(inertia, turn, body.rate_radps) - rest) / d**2
        assert k == pytest.approx(curvature, rel=1e-5)


@pytest.mark.parametrize("order", [*permutations(range(3))])
def test_only_the_least_moment_up_and_the_largest_along_the_normal_is_held(order):
    moments = [MOMENTS[axis] for axis in order]
    found = gravity_on(load("cubesat6u", {"body": {"inertia_kgm2": moments}}))
    assert (found.away == ()) is (order == (0, 1, 2))
    assert [moments[axis] for axis in found.held_order] == sorted(MOMENTS)


@pytest.mark.parametrize(
    ("moments", "away", "free", "falls_over"),
    [
        ((0.008, 0.04, 0.04), (), (0,), False),
        ((0.008, 0.041, 0.04), (0,), (), False),
        ((0.04, 0.008, 0.041), (2,), (), True),
        ((0.04, 0.04, 0.008), (0, 1), (2,), True),
        ((0.04, 0.04, 0.04), (), (0, 1, 2), False),
    ],
)
def test_axes_that_are_free_and_axes_that_turn_away(moments, away, free, falls_over):
    found = gravity_on(load("cubesat3u", {"body": {"inertia_kgm2": moments}}))
    assert (found.away, found.free, found.falls_over) == (away, free, falls_over)
    assert (found.away_nm > 0.0) is bool(away)


def test_a_body_whose_principal_axes_are_turned_rests_elsewhere():
    """A long body turned by 45 deg about axis 3: not the disturbance is too strong, and no coil too weak."""
    turned = [[0.0245, 0.0155, 0.0], [0.0155, 0.0245, 0.0], [0.0, 0.0, 0.0385]]
    found = gravity_on(load("cubesat3u", {"body": {"inertia_kgm2": turned}}))
    rate_radps = 2.0 * np.pi / 5739.0
    assert found.resting_nm == pytest.approx(3.0 * rate_radps**2 * 0.0155, rel=0.01)
    assert found.rests_elsewhere
    assert "choose body axes along the principal ones" in gravity_words(found)
    slightly = [[0.0067, 0.0002, 0.0], [0.0002, 0.033, 0.0], [0.0, 0.0, 0.0335]]
    assert not gravity_on(load("cubesat3u", {"body": {"inertia_kgm2": slightly}})).rests_elsewhere


def test_a_wheel_about_the_normal_holds_the_other_two_axes():
    """(J3 - J2) w0^2 + w0 h: by some 1e-3 N m s a body of 50 kg is held whatever its moments."""
    unheld = {"body": {"inertia_kgm2": [1.85, 1.95, 1.02]}}
    assert gravity_on(load("microsat", unheld)).away == (0, 1)
    turned = {"inertia_kgm2": [1.85, 1.95, 1.02], "wheel_nms": [0.0, 0.0, 0.01]}
    assert gravity_on(load("microsat", {"body": turned})).away == ()


@pytest.mark.parametrize("name", shipped_names())
def test_gravity_holds_what_ships(name):
    found = gravity_on(load(name))
    assert found.away == ()
    assert not found.rests_elsewhere


def test_what_points_one_axis_alone_may_turn_about_it():
    settings = parse_settings(("body.inertia_kgm2=[1.02,1.95,1.85]",))
    assert gravity_on(load("microsat", settings)).away == (0,)
    about_axis = parse_settings(("body.inertia_kgm2=[1.02,1.95,1.85]", "flight.modes.axis_only=true"))
    assert gravity_on(load("microsat", about_axis)).away == ()


def test_it_is_said_with_the_order_that_would_be_held():
    found = gravity_on(load("cubesat3u", {"body": {"inertia_kgm2": [0.041, 0.008, 0.04]}}))
    words = gravity_words(found)
    assert "turns the body over about axes 2 and 3" in words
    assert "y, of the least moment, up and x, of the largest" in words
    assert "set body.up = 'y' and body.ahead = 'z'" in words


@pytest.mark.parametrize("moments", [*permutations(MOMENTS)])
def test_the_attitude_that_is_advised_is_held(moments):
    body = {"inertia_kgm2": list(moments), "up": "-z", "ahead": "y"}
    found = gravity_on(load("cubesat6u", {"body": body}))
    if not found.away:
        assert [moments[axis] for axis in (2, 1, 0)] == sorted(MOMENTS)
        return
    up, ahead, _ = (found.names[axis] for axis in found.held_order)
    assert f"body.up = '{up}' and body.ahead = '{ahead}'" in gravity_words(found)
    assert gravity_on(load("cubesat6u", {"body": body | {"up": up, "ahead": ahead}})).away == ()
