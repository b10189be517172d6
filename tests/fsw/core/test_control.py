"""Which law each mode flies, and that no law speaks without knowledge."""

import pytest

from fsw.core import control
from fsw.core.control import MODE_LAWS, POINTING_LAWS, ControlConfig, FieldSample, Seen, dipole
from fsw.core.estimator import UNKNOWN, Attitude
from fsw.core.laws.damping import bdot_dipole, rate_damping_dipole
from fsw.core.laws.pd import attitude_error, pd_dipole
from fsw.core.quaternion import dcm, normalise
from fsw.core.vector import ZERO, cross
from fsw.wire.messages import Mode

TICK_S = 0.25
CONFIG = ControlConfig(law="pd", k_w=6.2694e6, k_a=1614.9, spin_radps=0.0, tick_s=TICK_S)
DAMPING = ControlConfig(law="rate_damping", k_w=6.2694e6, k_a=1614.9, spin_radps=0.0, tick_s=TICK_S)
B_BODY_T = (1.7e-5, -2.3e-5, 3.1e-5)
BEFORE = FieldSample((1.5e-5, -2.6e-5, 3.3e-5), tick=40)
SAMPLE = FieldSample((1.6e-5, -2.4e-5, 3.2e-5), tick=44)
KNOWN = Attitude(normalise((0.9, 0.1, -0.2, 0.3)), (0.001, -0.002, 0.003), 0.01, 1e-4, True)
NOT_VALID = KNOWN._replace(valid=False)

BY_PD = pd_dipole(
    B_BODY_T,
    KNOWN.omega_body_orbit_radps,
    attitude_error(dcm(KNOWN.q_body_from_orbit)),
    CONFIG.k_w,
    CONFIG.k_a,
)
BY_RATE = rate_damping_dipole(B_BODY_T, KNOWN.omega_body_orbit_radps, CONFIG.k_w)
BY_BDOT = bdot_dipole(SAMPLE.b_body_t, BEFORE.b_body_t, 1.0, CONFIG.k_w)


def seen(attitude=KNOWN, sample=SAMPLE, before=BEFORE):
    return Seen(attitude, B_BODY_T, sample, before)


def test_every_mode_has_a_law():
    assert set(MODE_LAWS) == set(Mode)


def test_the_laws_of_this_test_all_differ():
    assert len({BY_PD, BY_RATE, BY_BDOT, ZERO}) == 4


@pytest.mark.parametrize(
    ("mode", "config", "attitude", "expected"),
    [
        (Mode.SAFE, CONFIG, KNOWN, ZERO),
        (Mode.SAFE, DAMPING, KNOWN, ZERO),
        (Mode.SAFE, CONFIG, UNKNOWN, ZERO),
        (Mode.DETUMBLE, CONFIG, KNOWN, BY_RATE),
        (Mode.DETUMBLE, DAMPING, KNOWN, BY_RATE),
        (Mode.DETUMBLE, CONFIG, NOT_VALID, BY_BDOT),
        (Mode.DETUMBLE, CONFIG, UNKNOWN, BY_BDOT),
        (Mode.ACQUIRE, CONFIG, KNOWN, BY_PD),
        (Mode.ACQUIRE, DAMPING, KNOWN, BY_RATE),
        (Mode.ACQUIRE, CONFIG, NOT_VALID, ZERO),
        (Mode.ACQUIRE, DAMPING, NOT_VALID, ZERO),
        (Mode.POINT, CONFIG, KNOWN, BY_PD),
        (Mode.POINT, DAMPING, KNOWN, BY_RATE),
        (Mode.POINT, CONFIG, UNKNOWN, ZERO),
    ],
)
def test_law_by_mode(mode, config, attitude, expected):
    assert dipole(mode, seen(attitude), config) == expected


@pytest.mark.parametrize("law", POINTING_LAWS)
def test_every_pointing_law_flies_and_is_silent_without_attitude(law):
    config = ControlConfig(law, k_w=1e6, k_a=1e3, spin_radps=0.0, tick_s=1.0)
    assert dipole(Mode.POINT, seen(), config) != ZERO
    assert dipole(Mode.POINT, seen(NOT_VALID), config) == ZERO


class TestSpin:
    """Rate damping holds a spin about body axis 1, relative to the orbital frame; other laws know of none."""

    SPINNING = ControlConfig(law="rate_damping", k_w=6.2694e6, k_a=1614.9, spin_radps=0.02, tick_s=TICK_S)

    def spinning_at(self, *omega):
        return seen(KNOWN._replace(omega_body_orbit_radps=omega))

    def test_the_rate_wanted_is_left_alone(self):
        assert dipole(Mode.POINT, self.spinning_at(0.02, 0.0, 0.0), self.SPINNING) == pytest.approx(
            ZERO, abs=1e-12
        )

    def test_the_difference_is_damped(self):
        expected = rate_damping_dipole(B_BODY_T, (0.001 - 0.02, -0.002, 0.003), 6.2694e6)
        assert dipole(Mode.POINT, self.spinning_at(0.001, -0.002, 0.003), self.SPINNING) == expected

    def test_a_body_at_rest_is_spun_up(self):
        m = dipole(Mode.POINT, self.spinning_at(0.0, 0.0, 0.0), self.SPINNING)
        assert cross(m, B_BODY_T)[0] > 0.0


class TestBdot:
    """Two usable samples, neither the same nor too far apart; else nothing."""

    def test_before_the_first_sample(self):
        assert control.bdot(seen(sample=FieldSample(), before=FieldSample()), CONFIG) == ZERO

    def test_after_the_first_sample_alone(self):
        assert control.bdot(seen(before=FieldSample()), CONFIG) == ZERO

    def test_a_tick_without_a_sample_says_nothing_twice(self):
        assert control.bdot(seen(before=SAMPLE), CONFIG) == ZERO

    def test_the_interval_counts_in_seconds(self):
        assert control.bdot(seen(), CONFIG) == BY_BDOT
        twice = control.bdot(seen(before=FieldSample(BEFORE.b_body_t, 36)), CONFIG)
        assert twice == pytest.approx(tuple(0.5 * c for c in BY_BDOT))

    @pytest.mark.parametrize(
        ("apart_ticks", "speaks"), [(1, True), (39, True), (40, True), (41, False), (4000, False)]
    )
    def test_samples_further_apart_than_ten_seconds_tell_nothing(self, apart_ticks, speaks):
        sample = FieldSample(SAMPLE.b_body_t, 5000)
        before = FieldSample(BEFORE.b_body_t, 5000 - apart_ticks)
        assert (control.bdot(seen(sample=sample, before=before), CONFIG) != ZERO) is speaks

    def test_a_sample_of_tick_zero_counts(self):
        before = FieldSample(BEFORE.b_body_t, 0)
        assert control.bdot(seen(sample=FieldSample(SAMPLE.b_body_t, 4), before=before), CONFIG) == BY_BDOT
