"""Which law each mode flies, and that no law speaks without knowledge."""

from dataclasses import replace

import pytest

from fsw.core.algebra.quaternion import dcm, normalise
from fsw.core.algebra.vector import ZERO, Mat3, cross, inverse, sub
from fsw.core.estimation.attitude import UNKNOWN, Attitude
from fsw.core.laws import by_mode
from fsw.core.laws.damping import bdot, bdot_dipole, rate_damping, rate_damping_dipole
from fsw.core.laws.interface import ControlConfig, Demand, FieldSample, LawInput, OwnLaw, Setpoint
from fsw.core.laws.pd import attitude_error, far_error, pd_dipole
from fsw.core.laws.plan.law_axes import law_axes
from fsw.core.laws.plan.pulse_model import NO_PULSE, Pulse
from fsw.core.laws.predictive import predictive
from fsw.core.laws.table import LAWS
from fsw.core.orbit.ephemeris import Reference
from fsw.wire.messages import Mode

TICK_S = 0.25
INERTIA: Mat3 = ((1.02, 0.03, -0.02), (0.03, 1.85, 0.05), (-0.02, 0.05, 1.95))
K_W, K_A = 6.2694e6, 1614.9
PD = Setpoint("pd", K_W, K_A, k_i=0.0, spin_radps=0.0)
DAMPING = replace(PD, law="rate_damping")
PREDICTIVE = replace(PD, law="predictive")
CONFIG = ControlConfig(
    setpoint=PD,
    gains={name: law.gains() for name, law in LAWS.items() if law.gains is not None},
    inertia_kgm2=INERTIA,
    inertia_inverse=inverse(INERTIA),
    wheel_body_nms=(0.01, -0.02, 0.03),
    pulsed=True,
    tick_s=TICK_S,
    horizon_s=3.0,
    mean_dipole_am2=0.25,
)
B_BODY_T = (1.7e-5, -2.3e-5, 3.1e-5)
BEFORE = FieldSample((1.5e-5, -2.6e-5, 3.3e-5), tick=40)
SAMPLE = FieldSample((1.6e-5, -2.4e-5, 3.2e-5), tick=44)
KNOWN = Attitude(normalise((0.9, 0.1, -0.2, 0.3)), (0.001, -0.002, 0.003), 0.01, 1e-4, True)
NOT_VALID = KNOWN.invalid()
TOO_FAST = KNOWN.replace(omega_body_orbit_radps=(0.001, -0.5, 0.003))
REFERENCE = Reference(
    r_eci_m=(4.302e6, -3.4416e6, 4.5888e6),
    radius_m=7.17e6,
    b_eci_t=(2.1e-5, -1.2e-5, 2.6e-5),
    sun_eci=(0.6, -0.48, 0.64),
    lit=True,
    q_orbit_from_eci=normalise((0.6, -0.5, 0.4, 0.3)),
    orbit_rate_radps=1.04e-3,
)
EVERY_LAW = pytest.mark.parametrize("law", LAWS)


def inputs(attitude=KNOWN, sample=SAMPLE, before=BEFORE):
    return LawInput(attitude, B_BODY_T, sample, before, (0.6, 0.0, 0.8), REFERENCE, (1e-7, -2e-7, 3e-7))


def run(mode, setpoint=PD, attitude=KNOWN, memory=(), config=CONFIG):
    return by_mode.demand(mode, inputs(attitude), memory, setpoint, config)


def pd_with(error):
    return Demand(pd_dipole(B_BODY_T, KNOWN.omega_body_orbit_radps, error, K_W, K_A), memory=ZERO)


BY_PD = pd_with(attitude_error(dcm(KNOWN.q_body_from_orbit)))
BY_FAR_PD = pd_with(far_error(KNOWN.q_body_from_orbit))
BY_RATE = Demand(rate_damping_dipole(B_BODY_T, KNOWN.omega_body_orbit_radps, K_W))
BY_BDOT = Demand(bdot_dipole(SAMPLE.b_body_t, BEFORE.b_body_t, 1.0, K_W))
BY_PREDICTION = predictive(inputs(), (), PD, CONFIG)
NOTHING = Demand()
NOTHING_BUT_MEMORY = Demand(memory=ZERO)


def test_the_demands_of_this_test_all_differ():
    assert len({BY_PD, BY_FAR_PD, BY_RATE, BY_BDOT, BY_PREDICTION, NOTHING, NOTHING_BUT_MEMORY}) == 7
    assert BY_PREDICTION.impulse_body_nms is not None


@pytest.mark.parametrize(
    ("mode", "setpoint", "attitude", "expected"),
    [
        (Mode.SAFE, PD, KNOWN, None),
        (Mode.SAFE, DAMPING, KNOWN, None),
        (Mode.SAFE, PD, UNKNOWN, None),
        (Mode.DETUMBLE, PD, KNOWN, BY_PREDICTION),
        (Mode.DETUMBLE, DAMPING, KNOWN, BY_PREDICTION),
        (Mode.DETUMBLE, PD, NOT_VALID, BY_BDOT),
        (Mode.DETUMBLE, PD, UNKNOWN, BY_BDOT),
        (Mode.DETUMBLE, PREDICTIVE, UNKNOWN, BY_BDOT),
        (Mode.DETUMBLE, PD, TOO_FAST, BY_BDOT),
        (Mode.ACQUIRE, PD, KNOWN, BY_FAR_PD),
        (Mode.ACQUIRE, DAMPING, KNOWN, BY_RATE),
        (Mode.ACQUIRE, PREDICTIVE, KNOWN, BY_PREDICTION),
        (Mode.ACQUIRE, PD, NOT_VALID, NOTHING_BUT_MEMORY),
        (Mode.ACQUIRE, DAMPING, NOT_VALID, NOTHING),
        (Mode.POINT, PD, KNOWN, BY_PD),
        (Mode.POINT, DAMPING, KNOWN, BY_RATE),
        (Mode.POINT, PREDICTIVE, KNOWN, BY_PREDICTION),
        (Mode.POINT, PD, UNKNOWN, NOTHING_BUT_MEMORY),
        (Mode.POINT, PREDICTIVE, UNKNOWN, NOTHING),
    ],
)
def test_law_by_mode(mode, setpoint, attitude, expected):
    assert run(mode, setpoint, attitude) == expected


@pytest.mark.parametrize(
    ("attitude", "expected"),
    [(KNOWN, BY_RATE), (NOT_VALID, BY_BDOT), (UNKNOWN, BY_BDOT), (TOO_FAST, BY_BDOT)],
)
def test_detumble_with_a_continuous_driver_is_proportional(attitude, expected):
    assert run(Mode.DETUMBLE, PD, attitude, config=replace(CONFIG, pulsed=False)) == expected


@EVERY_LAW
@pytest.mark.parametrize("mode", [Mode.ACQUIRE, Mode.POINT])
def test_acquire_and_point_fly_the_law_of_the_setpoint(law, mode):
    row = LAWS[law]
    flies = row.acquire if mode is Mode.ACQUIRE else row.point
    setpoint = replace(PD, law=law)
    assert run(mode, setpoint) == flies(inputs(), (), setpoint, CONFIG)


RESIDUAL_AM2 = (0.04, -0.03, 0.07)


def with_a_residual_dipole(mode, law, attitude=KNOWN):
    """The demand beside the same one without it."""
    setpoint = replace(PD, law=law)
    given = inputs(attitude)
    known = given.replace(dipole_body_am2=RESIDUAL_AM2)
    return tuple(by_mode.demand(mode, case, (), setpoint, CONFIG) for case in (known, given))


@pytest.mark.parametrize("law", [law for law in LAWS if law not in ("predictive", "phasing", "pd_apart")])
@pytest.mark.parametrize("mode", [Mode.ACQUIRE, Mode.POINT])
def test_from_every_dipole_the_residual_one_is_taken_off(law, mode):
    known, without = with_a_residual_dipole(mode, law)
    assert known == without.replace(m_body_am2=sub(without.m_body_am2, RESIDUAL_AM2))


@pytest.mark.parametrize("mode", [Mode.ACQUIRE, Mode.POINT])
def test_it_is_taken_off_too_where_a_law_lacks_what_it_needs_beside_the_attitude(mode):
    in_the_shadow = inputs().replace(sun_body=None, dipole_body_am2=RESIDUAL_AM2)
    demand = by_mode.demand(mode, in_the_shadow, (), replace(PD, law="sun_pointing"), CONFIG)
    assert demand == Demand(sub(ZERO, RESIDUAL_AM2))


@pytest.mark.parametrize("mode", [Mode.ACQUIRE, Mode.POINT])
@pytest.mark.parametrize("measuring", [True, False])
def test_while_a_law_measures_its_coils_are_off_and_then_it_is_taken_off(mode, measuring):
    setpoint = replace(PD, law="pd_apart")
    memory = (0.0, 0.0 if measuring else 1.0, *(ZERO if measuring else (0.1, -0.2, 0.3)))
    demand = by_mode.demand(mode, inputs().replace(dipole_body_am2=RESIDUAL_AM2), memory, setpoint, CONFIG)
    taken = ZERO if measuring else sub((0.1, -0.2, 0.3), RESIDUAL_AM2)
    assert demand == Demand(taken, memory=memory, pulse=NO_PULSE if measuring else None)


@pytest.mark.parametrize("mode", [Mode.ACQUIRE, Mode.POINT])
def test_an_impulse_has_the_residual_dipole_in_the_motion_it_predicts(mode):
    known, without = with_a_residual_dipole(mode, "predictive")
    turned = cross(RESIDUAL_AM2, B_BODY_T)
    expected = tuple(r - CONFIG.horizon_s * t for r, t in zip(without.impulse_body_nms, turned, strict=True))
    assert known.impulse_body_nms == pytest.approx(expected, abs=1e-12)
    assert known.m_body_am2 == ZERO


@EVERY_LAW
def test_without_an_attitude_that_holds_no_dipole_is_taken_off(law):
    known, without = with_a_residual_dipole(Mode.POINT, law, NOT_VALID)
    assert known == without


@EVERY_LAW
def test_safe_asks_for_nothing_whatever_the_law(law):
    """Not even for no dipole: what was owed is forgotten."""
    assert run(Mode.SAFE, replace(PD, law=law)) is None


@pytest.mark.parametrize("attitude", [KNOWN, NOT_VALID, UNKNOWN])
@pytest.mark.parametrize("mode", [Mode.DETUMBLE, Mode.ACQUIRE, Mode.POINT])
def test_a_law_that_acts_without_looking_is_flown_in_each_mode_and_remembers(mode, attitude):
    ready = inputs(attitude).replace(wait_ticks=(0, 0, 0))
    demand = by_mode.demand(mode, ready, (4.0,), replace(PD, law="phasing"), CONFIG)
    assert demand == Demand(memory=(5.0,), pulse=Pulse(1, -3))


@pytest.mark.parametrize("law", [law for law, row in LAWS.items() if not row.open_loop])
@pytest.mark.parametrize("attitude", [KNOWN, NOT_VALID, UNKNOWN])
def test_detumble_flies_the_same_whatever_the_law_and_forgets(law, attitude):
    with_memory = run(Mode.DETUMBLE, replace(PD, law=law), attitude, memory=(1.0, 2.0, 3.0))
    assert with_memory == run(Mode.DETUMBLE, PD, attitude)
    assert with_memory.memory == ()


class TestSpin:
    """A spin about body axis 1, relative to the orbital frame, is what damping and prediction leave alone."""

    SPINNING = replace(DAMPING, spin_radps=0.02)

    def spinning_at(self, *omega):
        return inputs(KNOWN.replace(omega_body_orbit_radps=omega))

    def test_the_rate_wanted_is_left_alone(self):
        m = rate_damping(self.spinning_at(0.02, 0.0, 0.0), (), self.SPINNING, CONFIG).m_body_am2
        assert m == pytest.approx(ZERO, abs=1e-12)

    def test_the_difference_is_damped(self):
        expected = rate_damping_dipole(B_BODY_T, (0.001 - 0.02, -0.002, 0.003), K_W)
        got = rate_damping(self.spinning_at(0.001, -0.002, 0.003), (), self.SPINNING, CONFIG)
        assert got == Demand(expected)

    def test_a_body_at_rest_is_spun_up(self):
        m = rate_damping(self.spinning_at(0.0, 0.0, 0.0), (), self.SPINNING, CONFIG).m_body_am2
        assert cross(m, B_BODY_T)[0] > 0.0

    def test_prediction_misses_the_momentum_of_the_spin_that_is_wanted(self):
        without, wanting = (
            predictive(inputs(), (), setpoint, CONFIG).impulse_body_nms
            for setpoint in (PREDICTIVE, replace(PREDICTIVE, spin_radps=0.02))
        )
        momentum = tuple(0.02 * row[0] for row in INERTIA)
        more = tuple(b - a for a, b in zip(without, wanting, strict=True))
        assert more == pytest.approx(momentum, rel=1e-9)


class TestBdot:
    """Two usable samples, neither the same nor too far apart; else nothing."""

    def by_bdot(self, sample=SAMPLE, before=BEFORE):
        return bdot(inputs(sample=sample, before=before), (), PD, CONFIG)

    def test_before_the_first_sample(self):
        assert self.by_bdot(sample=FieldSample(), before=FieldSample()) == NOTHING

    def test_after_the_first_sample_alone(self):
        assert self.by_bdot(before=FieldSample()) == NOTHING

    def test_a_tick_without_a_sample_says_nothing_twice(self):
        assert self.by_bdot(before=SAMPLE) == NOTHING

    def test_the_interval_counts_in_seconds(self):
        assert self.by_bdot() == BY_BDOT
        twice = self.by_bdot(before=FieldSample(BEFORE.b_body_t, 36))
        assert twice.m_body_am2 == pytest.approx(tuple(0.5 * c for c in BY_BDOT.m_body_am2))

    @pytest.mark.parametrize(
        ("apart_ticks", "speaks"), [(1, True), (39, True), (40, True), (41, False), (4000, False)]
    )
    def test_samples_further_apart_than_ten_seconds_tell_nothing(self, apart_ticks, speaks):
        sample = FieldSample(SAMPLE.b_body_t, 5000)
        before = FieldSample(BEFORE.b_body_t, 5000 - apart_ticks)
        assert (self.by_bdot(sample, before) != NOTHING) is speaks

    def test_a_sample_of_tick_zero_counts(self):
        before = FieldSample(BEFORE.b_body_t, 0)
        assert self.by_bdot(FieldSample(SAMPLE.b_body_t, 4), before) == BY_BDOT


class TestOwnLaw:
    """A law that is not in the table, beside those that are."""

    OWN = OwnLaw("mine", lambda *given: Demand((1.0, 0.0, 0.0)), lambda *given: Demand((0.0, 1.0, 0.0)))
    CONFIG = replace(CONFIG, own=OWN)

    def test_it_flies_in_both_modes(self):
        mine = replace(PD, law="mine")
        assert run(Mode.ACQUIRE, mine, config=self.CONFIG) == Demand((1.0, 0.0, 0.0))
        assert run(Mode.POINT, mine, config=self.CONFIG) == Demand((0.0, 1.0, 0.0))

    def test_damping_and_the_other_laws_stay(self):
        mine = replace(PD, law="mine")
        assert run(Mode.DETUMBLE, mine, config=self.CONFIG) == BY_PREDICTION
        assert run(Mode.SAFE, mine, config=self.CONFIG) is None
        assert run(Mode.POINT, PD, config=self.CONFIG) == BY_PD


class TestAxesOfTheLaws:
    """A law sees and answers in its own axes; what comes of it is in those of the body."""

    AXES = law_axes("-z", "x")
    """Law axes 1, 2, 3 are body axes -z, x and -y."""

    def own(self, demanded):
        seen = []

        def law(inputs, memory, setpoint, config):
            seen.append(inputs)
            return demanded

        config = replace(CONFIG, own=OwnLaw("mine", law, law), axes=self.AXES)
        given = inputs().replace(dipole_body_am2=(0.1, 0.2, 0.3), wait_ticks=(7, 8, 9))
        found = by_mode.demand(Mode.POINT, given, (), replace(PD, law="mine"), config)
        return seen[0], found

    def test_what_the_law_sees_is_turned(self):
        seen, _ = self.own(Demand())
        assert seen.b_body_t == (-B_BODY_T[2], B_BODY_T[0], -B_BODY_T[1])
        assert seen.sample.b_body_t == (-3.2e-5, 1.6e-5, 2.4e-5)
        assert (seen.sample.tick, seen.before.tick) == (44, 40)
        assert seen.sun_body == (-0.8, 0.6, -0.0)
        assert seen.torque_body_nm == (-3e-7, 1e-7, 2e-7)
        assert seen.dipole_body_am2 == (-0.3, 0.1, -0.2)
        assert seen.wait_ticks == (9, 7, 8)
        assert seen.attitude.omega_body_orbit_radps == (-0.003, 0.001, 0.002)
        assert seen.reference is REFERENCE

    def test_a_dipole_is_turned_back_less_the_residual_one(self):
        _, found = self.own(Demand((1.0, 2.0, 3.0), memory=(4.0,)))
        assert found.m_body_am2 == pytest.approx((2.0 - 0.1, -3.0 - 0.2, -1.0 - 0.3))
        assert found.memory == (4.0,)

    def test_an_impulse_is_turned_back(self):
        _, found = self.own(Demand(impulse_body_nms=(1.0, 2.0, 3.0)))
        assert found.impulse_body_nms == (2.0, -3.0, -1.0)

    @pytest.mark.parametrize(
        ("asked", "fired"), [((0, 2), (2, -2)), ((1, -3), (0, -3)), ((2, 1), (1, -1)), ((0, 0), (2, 0))]
    )
    def test_a_pulse_is_that_of_the_coil_along_the_axis(self, asked, fired):
        _, found = self.own(Demand(pulse=Pulse(*asked)))
        assert found.pulse == Pulse(*fired)

    def test_safe_asks_for_nothing(self):
        assert run(Mode.SAFE, config=replace(CONFIG, axes=self.AXES)) is None
