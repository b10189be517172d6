"""A pitch wheel: roll and yaw on an ellipse, its laws compared, and the decay by rate damping."""

from dataclasses import replace
from math import radians, sin, sqrt

import numpy as np
import pytest

from fsw.core.laws.roll_yaw import RollYaw
from fsw.core.laws.six_gain import SixGainGains, six_gain_dipole
from sim.design.pitch_wheel import LAWS, Ellipse, WheelLaw, convergence, decays, roll_yaw_motion, slowest
from sim.design.theory.bodies import Body, diagonal
from sim.design.theory.floquet import monodromy, multipliers
from sim.design.theory.linear import Gains, closed_loop, free_motion
from sim.plant.dynamics.rigid_body import Motion, RigidBody
from sim.plant.dynamics.torques import BodyTorque, TorqueFunction
from sim.plant.environment.surroundings import Surroundings

# --- Roll and yaw on an ellipse: against the plant's rigid body, against the circle's theory, and the decay

BODY = Body("wheeled", diagonal((1.4, 1.6, 1.9)), 2100.0, 75.0, (0.0, 0.0, 0.02))
LAW = WheelLaw(8000.0, 1e7, SixGainGains(k2=0.7, k4=0.9, k5=0.3, k6=0.8))
ELLIPSE = Ellipse(0.2, 40.0)


def plant_rates(nu, state):
    """The same right-hand side by the plant: the radius along eci 1, the normal along eci 3."""
    e, n = ELLIPSE.eccentricity, BODY.rate_radps
    near = (1.0 + e * np.cos(nu)) / (1.0 - e * e)
    w, u = n * near**2 * sqrt(1.0 - e * e), nu + radians(ELLIPSE.perigee_deg)
    size, i = BODY.field_t * near**3, radians(BODY.inclination_deg)
    b_eci = size * np.array([-2.0 * np.sin(u) * np.sin(i), np.cos(u) * np.sin(i), 0.0])
    yaw, roll, first, second = state
    q = (sqrt(1.0 - 0.25 * (yaw * yaw + roll * roll)), 0.5 * yaw, 0.5 * roll, 0.0)

    def torque(q, omega, around):
        c = np.array([[1.0, 0.0, -roll], [0.0, 1.0, yaw], [roll, -yaw, 1.0]])
        b1, b2, _ = c @ b_eci
        motion = RollYaw(roll, yaw, omega[1] - w * yaw, omega[0] + w * roll)
        m = six_gain_dipole((b1, b2, 0.0), motion, LAW.k1, LAW.k3, LAW.others)
        return BodyTorque(BODY.inertia_kgm2, m).at(q, omega, around)

    around = Surroundings((1.0, 0.0, 0.0), 3.0 * n * n * near**3, tuple(b_eci.tolist()))
    body = RigidBody(BODY.inertia_kgm2, BODY.wheel_nms)
    _, (r1, r2, _) = body.rates(Motion(q, (n * first, n * second, w)), TorqueFunction(torque), around)
    return np.array([n * first + w * roll, n * second - w * yaw, r1 / n, r2 / n]) / w


@pytest.mark.parametrize("nu", [0.3, 2.1, 4.4])
def test_the_matrix_is_that_of_the_plant(nu):
    step = 1e-5
    columns = [(plant_rates(nu, axis) - plant_rates(nu, -axis)) / (2.0 * step) for axis in step * np.eye(4)]
    ours = roll_yaw_motion(BODY, ELLIPSE, LAW)(np.array([nu]))[0]
    np.testing.assert_allclose(ours, np.stack(columns, axis=1), rtol=1e-7, atol=1e-8)


def test_on_a_circle_without_coils_it_is_the_motion_of_the_theory():
    """By the same frequencies: the theory has the rates relative to the orbital frame."""
    ours = roll_yaw_motion(BODY, Ellipse(0.0), WheelLaw(0.0, 0.0))(np.array([0.7]))[0]
    theirs = free_motion(BODY)[np.ix_((0, 1, 3, 4), (0, 1, 3, 4))]
    first, second = (np.sort(np.abs(np.linalg.eigvals(matrix))) for matrix in (ours, theirs))
    np.testing.assert_allclose(first, second, rtol=1e-9)


@pytest.mark.parametrize("e", [0.0, 0.1, 0.2])
def test_precession_and_nutation_decay(e):
    precession, nutation = decays(BODY, Ellipse(e, 40.0), WheelLaw(8000.0, 5e6))
    assert nutation < precession < 0.0


def test_without_the_rate_part_nutation_is_not_damped():
    _, nutation = decays(BODY, Ellipse(0.2), WheelLaw(8000.0, 0.0))
    assert nutation > -1e-3


def test_a_slanting_perigee_and_the_size_of_the_body_count():
    one, other = (decays(BODY, Ellipse(0.2, angle), LAW) for angle in (0.0, 90.0))
    assert one[1] != pytest.approx(other[1], rel=1e-3)
    heavier = replace(BODY, inertia_kgm2=diagonal((2.8, 3.2, 3.8)))
    assert decays(heavier, ELLIPSE, LAW)[1] > decays(BODY, ELLIPSE, LAW)[1]


@pytest.mark.parametrize("e", [-0.1, 1.0, float("nan")])
def test_no_ellipse_is_refused(e):
    with pytest.raises(ValueError, match="eccentricity must be 0 to below 1"):
        Ellipse(e)


# --- The laws of a pitch wheel compared: what yaw and springs are worth, and that averaging says the same

COMPARED = Body("wheeled", diagonal((1.9, 1.95, 2.0)), 800.0, 98.6, (0.0, 0.0, 0.05))
STRONG = Body("strong", diagonal((1.9, 1.95, 2.0)), 800.0, 98.6, (0.0, 0.0, 0.5))
K1, K3 = 8000.0, 1e7


@pytest.fixture(scope="module")
def compared():
    return slowest(COMPARED, K1, K3)


def test_all_are_stable_and_faster_with_more_measured(compared):
    degrees = [compared[name] for name in LAWS][:4]
    assert max(degrees) < 0.0
    assert degrees == sorted(degrees, reverse=True)


def test_a_spring_of_either_sign_helps_alike(compared):
    plain = compared["roll and yaw"]
    assert LAWS["roll and yaw, springs reversed"].k5 < 0.0 < LAWS["roll and yaw, springs"].k5
    for name in ("roll and yaw, springs", "roll and yaw, springs reversed"):
        assert compared[name] / plain == pytest.approx(10.0 / 9.0, rel=0.02)


def test_averaging_says_the_same_of_a_strong_wheel():
    """9/8 (k1 + w0 k3) B0^2 sin^2 i / (h w0): the rates of the precession are w0 times the angles."""
    w0 = STRONG.rate_radps
    across = (STRONG.field_t * sin(np.radians(98.6))) ** 2
    expected = -9.0 / 8.0 * (K1 + w0 * K3) * across / (0.5 * w0)
    assert slowest(STRONG, K1, K3)["roll and yaw"] == pytest.approx(expected, rel=0.02)


# --- Closed expressions for the decay with a pitch wheel, against Floquet theory

DAMPED = Body("wheeled", diagonal((1.4, 1.6, 1.9)), 800.0, 70.0, (0.0, 0.0, 0.01))
WEAK = 2e4


def floquet(body, k_w, steps=512):
    values = np.log(np.abs(multipliers(monodromy(closed_loop(body, Gains(k_w, 0.0)), steps)))) / (2.0 * np.pi)
    return np.sort(values)[::2]


@pytest.mark.parametrize("wheel_nms", [0.003, 0.01, 0.03, -0.02])
@pytest.mark.parametrize("inclination_deg", [40.0, 98.6])
def test_they_are_the_exponents_of_weak_damping(wheel_nms, inclination_deg):
    body = replace(DAMPED, wheel_nms=(0.0, 0.0, wheel_nms), inclination_deg=inclination_deg)
    np.testing.assert_allclose(np.sort(convergence(body, WEAK)), floquet(body, WEAK), rtol=0.02)


def test_the_modes_are_told_apart_by_a_strong_wheel():
    """The precession slows as the wheel, the nutation and the pitch do not."""
    body, stronger = (replace(DAMPED, wheel_nms=(0.0, 0.0, h)) for h in (0.1, 0.2))
    one, two = convergence(body, WEAK), convergence(stronger, WEAK)
    assert one.precession == pytest.approx(2.0 * two.precession, rel=0.05)
    assert one.nutation == pytest.approx(two.nutation, rel=0.02)
    assert one.pitch == two.pitch
    assert one.nutation < one.precession < 0.0


def test_against_a_wheel_the_drag_drives_the_precession():
    """The free motion is stable there by the gyroscopic torque alone."""
    assert convergence(replace(DAMPED, wheel_nms=(0.0, 0.0, -0.02)), WEAK).precession > 0.0


@pytest.mark.parametrize(
    ("changed", "named"),
    [
        ({"inertia_kgm2": ((1.4, 0.1, 0.0), (0.1, 1.6, 0.0), (0.0, 0.0, 1.9))}, "principal"),
        ({"wheel_nms": (0.001, 0.0, 0.01)}, "along axis 3"),
        ({"wheel_nms": (0.0, 0.001, 0.01)}, "along axis 3"),
        ({"inertia_kgm2": diagonal((1.6, 1.4, 1.9))}, "not stable"),
        ({"wheel_nms": (0.0, 0.0, -0.0005)}, "not stable"),
    ],
)
def test_what_the_expressions_do_not_hold_for_is_refused(changed, named):
    with pytest.raises(ValueError, match=f"wheeled: .*{named}"):
        convergence(replace(DAMPED, **changed), WEAK)
