"""Which sensor is isolated for what, when not, and when it is readmitted."""

from dataclasses import replace
from math import acos, cos, degrees, nan, radians, sin

import numpy as np
import pytest

from fsw.core.algebra.quaternion import normalise, rotate
from fsw.core.algebra.vector import norm, scale, sub
from fsw.core.estimation.estimator import Used
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.parameters import Parameters
from fsw.core.estimation.samples import usable_field, usable_sun
from fsw.core.fdir.sensor_health import SensorHealth, judge, trusted
from fsw.core.fdir.sensor_pair import MISFIT, Pair, PairConfig
from fsw.core.fdir.sensor_watch import AGAINST_ESTIMATE, FULL, SLIGHT, SensorFault, SensorHealthConfig
from fsw.core.gate.readings import NOTHING
from fsw.core.orbit.earth import RADIUS_M
from fsw.core.orbit.ephemeris import Reference
from fsw.wire.messages import CoilStatus, MagField, SunVector

CONFIG = SensorHealthConfig(
    max_field_error_t=3e-6,
    max_norm_error=0.05,
    max_angle_error_rad=radians(5.0),
    field_noise_t=8e-7,
    sun_noise_rad=0.035,
    max_bias_t=2e-6,
    max_torque_nm=4e-7,
    frozen_ticks=12,
    silent_ticks=17,
    name_suspicion=FULL * 10,
    readmit_ticks=25,
    pair=PairConfig(report_ticks=10, prove_ticks=15, agree_ticks=100),
)
B_ECI_T, SUN_ECI = (2.1e-5, -1.3e-5, 1.7e-5), (0.36, 0.48, 0.8)
Q = normalise((0.7, 0.3, -0.5, 0.4))
BIAS_T = (2e-7, -3e-7, 1e-7)
ESTIMATE = Estimate(Q, (1e-3, -2e-3, 5e-4), Parameters(mag_bias_t=BIAS_T), np.eye(12) * 1e-6)
IDLE = CoilStatus(0, 1, 0, 0, 0, 0)
BOTH, NEITHER, FIELD_ONLY, SUN_ONLY = (
    Used(True, True, False),
    Used(False, False, False),
    Used(True, False, False),
    Used(False, True, False),
)
REFERENCE = Reference((7e6, 0.0, 0.0), 7e6, B_ECI_T, SUN_ECI, True, (1.0, 0.0, 0.0, 0.0), 1e-3)
BEFORE_THE_EARTH = REFERENCE
NEAR_THE_EDGE, IN_SHADOW = (
    replace(REFERENCE, r_eci_m=sub(scale(offset_m, (0.0, 0.8575, -0.5145)), scale(3e6, SUN_ECI)), lit=False)
    for offset_m in (RADIUS_M - 99e3, RADIUS_M - 101e3)
)
"""Behind the Earth, 99 and 101 km from the edge of its shadow."""
B_BODY_T, S_BODY = rotate(Q, B_ECI_T), rotate(Q, SUN_ECI)


def add(a, b):
    return tuple(x + y for x, y in zip(a, b, strict=True))


@pytest.fixture
def flight():
    """Judges tick after tick; each sample differs from the one before by a little."""

    class Flight:
        health = SensorHealth(pair=Pair(proof=CONFIG.pair.prove_ticks))
        tick = 0

        def step(
            self,
            b=B_BODY_T,
            s=S_BODY,
            used=BOTH,
            estimate=ESTIMATE,
            valid=1,
            coil=IDLE,
            moves="bs",
            sigma3=0.01,
            reference=REFERENCE,
        ):
            self.tick += 1
            wobble = 1e-8 * (self.tick % 7 + 1)
            readings = NOTHING._replace(coil=coil)
            if b is not None:
                b = add(b, (wobble, 0.0, 0.0)) if "b" in moves else b
                readings = readings._replace(field=MagField(valid, *scale(1e9, b)))
            if s is not None:
                s = add(s, (wobble, 0.0, 0.0)) if "s" in moves and s != DARK else s
                readings = readings._replace(sun=SunVector(int(s != DARK), *s))
            passed = trusted(readings, self.health, reference)
            used = Used(
                used.field and usable_field(passed) is not None,
                used.sun and usable_sun(passed) is not None,
                False,
            )
            self.health = judge(
                self.health,
                readings,
                usable_field(readings),
                usable_sun(readings),
                reference,
                used,
                estimate,
                sigma3,
                CONFIG,
            )
            return (self.health.field.fault, self.health.sun.fault)

        def until_isolated(self, most=200, **samples):
            """Ticks until a sensor is isolated, and (field, sun)."""
            for tick in range(1, most):
                if any(isolated := self.step(**samples)):
                    return tick, isolated
            return None

    return Flight()


DARK = (0.0, 0.0, 0.0)
STRENGTH, SATURATED, FROZEN, REFUSED, SILENT, UNLIT = (
    SensorFault.STRENGTH,
    SensorFault.SATURATED,
    SensorFault.FROZEN,
    SensorFault.REFUSED,
    SensorFault.SILENT,
    SensorFault.UNLIT,
)
LONGER = scale((norm(B_BODY_T) + 3.1e-6) / norm(B_BODY_T), B_BODY_T)
SHORTER = scale((norm(B_BODY_T) - 3.1e-6) / norm(B_BODY_T), B_BODY_T)
MIRRORED = (-B_BODY_T[0], B_BODY_T[1], B_BODY_T[2])


class TestIsolation:
    @pytest.mark.requirement("REQ-SENSOR-02")
    @pytest.mark.parametrize("b", [LONGER, SHORTER, (0.0, 0.0, 0.0)], ids=["longer", "shorter", "none"])
    def test_a_field_of_the_wrong_strength(self, flight, b):
        assert flight.until_isolated(b=b, used=SUN_ONLY) == (10, (STRENGTH, 0))

    @pytest.mark.requirement("REQ-SENSOR-02")
    @pytest.mark.parametrize("length", [0.94, 1.06])
    def test_a_sun_vector_of_the_wrong_length(self, flight, length):
        assert flight.until_isolated(s=scale(length, S_BODY), used=FIELD_ONLY) == (10, (0, STRENGTH))

    @pytest.mark.parametrize("length", [0.96, 1.04])
    def test_within_the_limit_is_well(self, flight, length):
        b = scale((norm(B_BODY_T) + (length - 1.0) / 0.04 * 2.9e-6) / norm(B_BODY_T), B_BODY_T)
        assert flight.until_isolated(b=b, s=scale(length, S_BODY)) is None

    @pytest.mark.requirement("REQ-SENSOR-01")
    def test_a_magnetometer_that_calls_itself_saturated(self, flight):
        assert flight.until_isolated(valid=0, used=SUN_ONLY) == (10, (SATURATED, 0))

    @pytest.mark.parametrize(
        "coil", [IDLE._replace(level=3), IDLE._replace(current_ma=40), None], ids=["on", "decays", "silent"]
    )
    def test_while_a_coil_drives_saturation_is_not_its_fault(self, flight, coil):
        assert flight.until_isolated(valid=0, used=SUN_ONLY, coil=coil) is None

    @pytest.mark.requirement("REQ-SENSOR-03")
    def test_a_frozen_field(self, flight):
        assert flight.until_isolated(moves="s") == (13, (FROZEN, 0))

    @pytest.mark.requirement("REQ-SENSOR-03")
    def test_a_frozen_field_in_the_dark(self, flight):
        assert flight.until_isolated(moves="", s=DARK) == (13, (FROZEN, 0))

    @pytest.mark.requirement("REQ-SENSOR-03")
    def test_a_frozen_sun(self, flight):
        assert flight.until_isolated(moves="b") == (13, (0, FROZEN))

    def test_where_nothing_moves_nothing_is_frozen(self, flight):
        """Boards on a bench before a stimulus that stands still."""
        assert flight.until_isolated(moves="") is None

    def test_a_sample_that_moves_once_in_a_while_is_not_frozen(self, flight):
        for tick in range(200):
            assert flight.step(moves="bs" if tick % 12 == 0 else "s") == (0, 0)

    @pytest.mark.requirement("REQ-SENSOR-04")
    @pytest.mark.parametrize(("used", "isolated"), [(SUN_ONLY, (REFUSED, 0)), (FIELD_ONLY, (0, REFUSED))])
    def test_what_the_filter_refuses_and_the_angle_bears_out(self, flight, used, isolated):
        assert flight.until_isolated(b=MIRRORED, used=used) == (10, isolated)

    @pytest.mark.requirement("REQ-SENSOR-04")
    @pytest.mark.parametrize(("used", "isolated"), [(SUN_ONLY, (REFUSED, 0)), (FIELD_ONLY, (0, REFUSED))])
    def test_what_the_filter_alone_refuses_takes_longer(self, flight, used, isolated):
        assert flight.until_isolated(used=used) == (10 * FULL / SLIGHT, isolated)

    @pytest.mark.requirement("REQ-SENSOR-04")
    @pytest.mark.parametrize("s", [DARK, None])
    def test_a_field_that_is_refused_in_the_dark(self, flight, s):
        assert flight.until_isolated(s=s, used=NEITHER) == (10 * FULL / SLIGHT, (REFUSED, 0))

    def test_a_filter_that_refuses_both_isolates_nothing(self, flight):
        assert flight.until_isolated(used=NEITHER) is None
        assert flight.until_isolated(b=MIRRORED, used=NEITHER) is None

    def test_a_sun_alone_that_is_refused_is_not_isolated(self, flight):
        """A driven coil hides the field for a pulse, and the filter may be wrong about what it did."""
        assert flight.until_isolated(used=NEITHER, coil=IDLE._replace(level=3)) is None

    def test_without_an_estimate_nothing_is_refused(self, flight):
        assert flight.until_isolated(used=NEITHER, estimate=None) is None
        assert flight.until_isolated(s=DARK, used=NEITHER, estimate=None) is None

    @pytest.mark.requirement("REQ-SENSOR-05")
    @pytest.mark.parametrize(
        ("samples", "isolated"), [({"b": None}, (SILENT, 0)), ({"s": None}, (0, SILENT))]
    )
    def test_a_silent_sensor(self, flight, samples, isolated):
        assert flight.until_isolated(**samples) == (17, isolated)

    def test_a_sensor_that_speaks_now_and_then_is_not_silent(self, flight):
        for tick in range(200):
            assert flight.step(**({} if tick % 17 == 0 else {"b": None, "s": None})) == (0, 0)

    @pytest.mark.requirement("REQ-SENSOR-08")
    def test_darkness_is_not_silence(self, flight):
        assert flight.until_isolated(s=DARK) is None

    @pytest.mark.requirement("REQ-SENSOR-09")
    def test_a_sun_in_the_shadow_though_it_is_as_predicted(self, flight):
        assert flight.until_isolated(reference=IN_SHADOW) == (10, (0, UNLIT))

    @pytest.mark.requirement("REQ-SENSOR-08", "REQ-SENSOR-09")
    @pytest.mark.parametrize("reference", [NEAR_THE_EDGE, BEFORE_THE_EARTH], ids=["penumbra", "day side"])
    def test_a_sun_that_may_be_there(self, flight, reference):
        assert flight.until_isolated(reference=reference) is None

    @pytest.mark.requirement("REQ-SENSOR-08")
    def test_a_glimpse_in_the_shadow(self, flight):
        for tick in range(200):
            assert flight.step(s=S_BODY if tick % 2 else DARK, reference=IN_SHADOW) == (0, 0)

    def test_a_field_that_is_refused_while_there_is_a_sun_in_the_shadow(self, flight):
        """What is no Sun excuses no magnetometer."""
        isolated = [flight.step(b=MIRRORED, used=NEITHER, reference=IN_SHADOW) for _ in range(15)]
        assert isolated == [(0, 0)] * 9 + [(0, UNLIT)] * 5 + [(REFUSED, UNLIT)]

    def test_a_field_that_is_no_number_is_isolated(self, flight):
        """It cannot be coded on the wire; whoever calls with it must not get it trusted."""
        assert flight.until_isolated(b=(nan, 0.0, 0.0), used=SUN_ONLY) == (10, (STRENGTH, 0))

    @pytest.mark.requirement("REQ-SENSOR-08")
    def test_bad_ticks_among_good_ones_isolate_nothing(self, flight):
        for tick in range(400):
            assert flight.step(b=LONGER if tick % 2 else B_BODY_T) == (0, 0)


class TestReadmission:
    @pytest.fixture
    def isolated(self, flight):
        flight.until_isolated(b=MIRRORED, used=SUN_ONLY)
        return flight

    def test_it_is_withheld_and_the_other_one_is_not(self, isolated):
        readings = NOTHING._replace(
            field=MagField(1, 1.0, 2.0, 3.0), sun=SunVector(1, 0.0, 0.6, 0.8), coil=IDLE
        )
        assert trusted(readings, isolated.health, REFERENCE) == readings._replace(field=None)
        assert trusted(readings, SensorHealth(), REFERENCE) is readings

    @pytest.mark.requirement("REQ-SENSOR-09")
    def test_nor_is_a_sun_in_the_shadow(self):
        readings = NOTHING._replace(sun=SunVector(1, 0.0, 0.6, 0.8), coil=IDLE)
        dark = readings._replace(sun=SunVector(0, 0.0, 0.0, 0.0))
        assert trusted(readings, SensorHealth(), IN_SHADOW) == readings._replace(sun=None)
        assert trusted(readings, SensorHealth(), NEAR_THE_EDGE) is readings
        assert trusted(dark, SensorHealth(), IN_SHADOW) is dark

    @pytest.mark.requirement("REQ-SENSOR-06", "REQ-SENSOR-09")
    def test_a_false_sun_stays_out_until_after_the_shadow_it_is_the_sun_again(self, flight):
        flight.until_isolated(reference=IN_SHADOW)
        assert {flight.step(reference=IN_SHADOW) for _ in range(100)} == {(0, UNLIT)}
        assert {flight.step(s=DARK, reference=IN_SHADOW) for _ in range(100)} == {(0, UNLIT)}
        assert [flight.step()[1] for _ in range(25)] == [UNLIT] * 24 + [0]

    @pytest.mark.requirement("REQ-SENSOR-06")
    def test_it_comes_back_when_it_is_as_predicted(self, isolated):
        b = add(B_BODY_T, BIAS_T)
        assert [isolated.step(b=b)[0] for _ in range(25)] == [REFUSED] * 24 + [0]
        assert not isolated.health.doubted

    @pytest.mark.requirement("REQ-SENSOR-06")
    def test_in_the_dark_too(self, isolated):
        b = add(B_BODY_T, BIAS_T)
        assert [isolated.step(b=b, s=DARK)[0] for _ in range(25)] == [REFUSED] * 24 + [0]

    def test_while_it_is_wrong_it_stays_out(self, isolated):
        assert {isolated.step(b=MIRRORED) for _ in range(300)} == {(REFUSED, 0)}

    def test_one_bad_sample_costs_many_good_ones(self, isolated):
        b = add(B_BODY_T, BIAS_T)
        for _ in range(300 // MISFIT):
            for _ in range(MISFIT):
                assert isolated.step(b=b)[0] == REFUSED
            assert isolated.step(b=MIRRORED)[0] == REFUSED

    def test_what_is_frozen_stays_out_though_it_fits(self, flight):
        flight.until_isolated(moves="s")
        assert {flight.step(moves="s") for _ in range(300)} == {(FROZEN, 0)}

    def test_an_uncertain_estimate_predicts_less(self, isolated):
        """0.1 rad off: out while the estimate is sure, back when its own error may be as large."""
        turn = 0.1
        perpendicular = sub(
            S_BODY,
            scale(sum(x * y for x, y in zip(S_BODY, B_BODY_T, strict=True)) / norm(B_BODY_T) ** 2, B_BODY_T),
        )
        off = add(
            scale(cos(turn), B_BODY_T), scale(sin(turn) * norm(B_BODY_T) / norm(perpendicular), perpendicular)
        )
        assert {isolated.step(b=add(off, BIAS_T), s=DARK)[0] for _ in range(100)} == {REFUSED}
        assert [isolated.step(b=add(off, BIAS_T), s=DARK, sigma3=0.12)[0] for _ in range(25)][-1] == 0

    @pytest.mark.requirement("REQ-SENSOR-06")
    def test_both_sensors_against_the_estimate_restart_it(self, isolated):
        """The pair is turned about some axis: strength and angle are right, the estimate is not."""
        wrong = Estimate(
            normalise((0.7, 0.3, -0.5, 0.8)),
            ESTIMATE.omega_body_radps,
            Parameters(mag_bias_t=BIAS_T, torque_body_nm=BIAS_T),
            ESTIMATE.covariance,
        )
        samples = {"b": B_BODY_T, "s": S_BODY, "estimate": wrong}
        for _ in range(AGAINST_ESTIMATE * CONFIG.readmit_ticks - 1):
            assert isolated.step(**samples) == (REFUSED, 0)
            assert not isolated.health.doubted
        assert isolated.step(**samples) == (0, 0)
        assert isolated.health.doubted
        isolated.step(**samples)
        assert not isolated.health.doubted

    @pytest.mark.requirement("REQ-SENSOR-06")
    def test_without_an_estimate_agreement_is_enough(self, isolated):
        assert [isolated.step(estimate=None)[0] for _ in range(25)] == [REFUSED] * 24 + [0]

    def test_both_left_out_and_no_estimate_is_no_dead_end(self, flight):
        for _ in range(20):
            flight.step(b=LONGER, s=scale(1.2, S_BODY), used=NEITHER, estimate=None)
        assert (flight.health.field.fault, flight.health.sun.fault) == (STRENGTH, STRENGTH)
        assert [flight.step(estimate=None) for _ in range(25)][-1] == (0, 0)


class TestContradiction:
    @pytest.fixture
    def flight(self, flight):
        flight.health = SensorHealth()
        return flight

    @pytest.mark.requirement("REQ-SENSOR-07")
    def test_without_an_estimate_it_is_reported_after_a_while(self, flight):
        samples = []
        for _ in range(30):
            flight.step(b=MIRRORED, used=NEITHER, estimate=None)
            samples.append(flight.health.pair.contradictory)
        assert samples == [False] * 9 + [True] * 21

    def test_it_ends_when_they_agree_for_as_long(self, flight):
        for _ in range(30):
            flight.step(b=MIRRORED, used=NEITHER, estimate=None)
        samples = []
        for _ in range(15):
            flight.step(estimate=None, used=NEITHER)
            samples.append(flight.health.pair.contradictory)
        assert samples == [True] * 9 + [False] * 6

    def test_with_a_proven_estimate_a_sensor_is_isolated_instead(self, flight):
        for _ in range(CONFIG.pair.prove_ticks):
            flight.step()
        assert flight.until_isolated(b=MIRRORED, used=SUN_ONLY) == (10, (REFUSED, 0))
        assert not flight.health.pair.contradictory

    @pytest.mark.requirement("REQ-SENSOR-04", "REQ-SENSOR-07")
    @pytest.mark.parametrize("used", [SUN_ONLY, FIELD_ONLY])
    def test_with_one_that_is_not_proven_nothing_is_isolated_and_it_restarts(self, flight, used):
        for _ in range(CONFIG.pair.prove_ticks - 1):
            flight.step()
        doubted = []
        for _ in range(12):
            assert flight.step(b=MIRRORED, used=used) == (0, 0)
            doubted.append(flight.health.doubted)
        assert doubted == [False] * 9 + [True] + [False] * 2

    @pytest.mark.parametrize("samples", [{"b": LONGER}, {"s": scale(1.06, S_BODY)}], ids=["field", "Sun"])
    def test_what_is_wrong_by_itself_needs_no_other_sensor(self, flight, samples):
        assert flight.until_isolated(**samples, used=NEITHER, estimate=None) is not None
        turned = {"b": (-LONGER[0], LONGER[1], LONGER[2])} if "b" in samples else samples | {"b": MIRRORED}
        for _ in range(30):
            flight.step(**turned, used=NEITHER, estimate=None)
        assert not flight.health.pair.contradictory

    def test_a_sun_is_not_isolated_for_a_field_of_the_wrong_strength(self, flight):
        for _ in range(CONFIG.pair.prove_ticks):
            flight.step()
        assert flight.until_isolated(b=LONGER, used=FIELD_ONLY) == (10, (STRENGTH, 0))

    @pytest.mark.parametrize(("good", "bad", "owed"), [(30, 0, 0), (30, 2, 40), (0, 3, 60), (0, 30, 100)])
    def test_a_pair_that_was_wrong_must_agree_for_as_long_as_it_cost(self, flight, good, bad, owed):
        for b in [B_BODY_T] * good + [MIRRORED] * bad:
            flight.step(b=b, used=NEITHER, estimate=None)
        assert flight.health.pair.proof == -owed
        for _ in range(owed):
            assert flight.health.pair.proof < 0
            flight.step(used=NEITHER, estimate=None)
        assert flight.health.pair.proof == 0
        flight.step(s=DARK, used=NEITHER, estimate=None)
        assert flight.health.pair.proof == 0

    def test_meanwhile_there_is_no_sun_to_begin_with(self):
        readings = NOTHING._replace(
            field=MagField(1, 1.0, 2.0, 3.0), sun=SunVector(1, 0.0, 0.6, 0.8), coil=IDLE
        )
        assert trusted(readings, SensorHealth(pair=Pair(proof=-1)), REFERENCE) == readings._replace(sun=None)
        assert trusted(readings, SensorHealth(pair=Pair(proof=0)), REFERENCE) is readings

    def test_what_an_estimate_refuses_undoes_its_proof_until_that_is_complete(self, flight):
        for used, proof in ((BOTH, 1), (SUN_ONLY, 0), (BOTH, 1), (BOTH, 2), (Used(False, False, True), 0)):
            flight.step(used=used)
            assert flight.health.pair.proof == proof
        for _ in range(CONFIG.pair.prove_ticks):
            flight.step()
        flight.step(used=SUN_ONLY)
        assert flight.health.pair.proof == CONFIG.pair.prove_ticks

    def test_what_an_estimate_has_proved_is_lost_with_it(self, flight):
        for _ in range(CONFIG.pair.prove_ticks):
            flight.step()
        flight.step(used=NEITHER, estimate=None)
        assert flight.health.pair.proof == 0


def with_parameters(**parameters):
    return ESTIMATE._replace(parameters=Parameters(**parameters))


class TestCredibility:
    """An estimate that began with a wrong sensor explains it by what cannot be."""

    BIASED = with_parameters(mag_bias_t=(1.3e-6, -1.2e-6, 1.1e-6))
    TURNED = with_parameters(mag_bias_t=BIAS_T, torque_body_nm=(-2.6e-7, 2.4e-7, 2.2e-7))
    AT_THE_LIMITS = with_parameters(
        mag_bias_t=(1.2e-6, -1.2e-6, 1.0e-6), torque_body_nm=(-2e-7, 2e-7, 2.5e-7)
    )

    @pytest.mark.requirement("REQ-SENSOR-07")
    @pytest.mark.parametrize(
        ("estimate", "proof"),
        [(BIASED, 0), (TURNED, 0), (AT_THE_LIMITS, CONFIG.pair.prove_ticks)],
        ids=["bias", "disturbance", "at the limits"],
    )
    def test_what_it_takes_proves_nothing(self, flight, estimate, proof):
        flight.health = SensorHealth()
        for _ in range(3 * CONFIG.pair.prove_ticks):
            assert flight.step(estimate=estimate) == (0, 0)
            assert not flight.health.doubted
        assert flight.health.pair == Pair(proof=proof)

    @pytest.mark.requirement("REQ-SENSOR-04")
    @pytest.mark.parametrize("estimate", [BIASED, TURNED], ids=["bias", "disturbance"])
    @pytest.mark.parametrize("used", [SUN_ONLY, FIELD_ONLY])
    def test_one_that_was_credible_until_a_sensor_drew_it_away_isolates_the_sensor(
        self, flight, estimate, used
    ):
        """As a magnetometer that saturates little by little does."""
        assert flight.until_isolated(b=MIRRORED, used=used, estimate=estimate) == (
            10,
            (REFUSED, 0) if used is SUN_ONLY else (0, REFUSED),
        )
        assert not flight.health.doubted

    @pytest.mark.requirement("REQ-SENSOR-07")
    @pytest.mark.parametrize(("estimate", "ends"), [(TURNED, True), (AT_THE_LIMITS, False)])
    def test_unproven_it_ends_by_refusals_though_the_angle_is_right(self, flight, estimate, ends):
        flight.health = SensorHealth()
        doubted = []
        for _ in range(CONFIG.pair.report_ticks):
            assert flight.step(used=SUN_ONLY, estimate=estimate) == (0, 0)
            doubted.append(flight.health.doubted)
        assert doubted == [False] * (CONFIG.pair.report_ticks - 1) + [ends]


def test_the_geometry_of_these_tests_hides_nothing():
    """The mirrored field has the right strength, and an angle to the Sun that is wrong by far."""
    assert norm(MIRRORED) == pytest.approx(norm(B_BODY_T))
    measured = sum(x * y for x, y in zip(MIRRORED, S_BODY, strict=True)) / norm(MIRRORED)
    true = sum(x * y for x, y in zip(B_BODY_T, S_BODY, strict=True)) / norm(B_BODY_T)
    assert abs(degrees(acos(measured) - acos(true))) > 10.0
