"""Both sensors together: what proves an estimate, what disputes the pair, and how it is trusted again."""

from itertools import count

import pytest
from estimator_samples import tuned
from with_values import with_values

from fsw.core.estimation import mekf
from fsw.core.estimation.estimator import Used
from fsw.core.estimation.parameters import Prior
from fsw.core.fdir.evidence import weights
from fsw.core.fdir.sensors.credibility import credibility_config
from fsw.core.fdir.sensors.observed import Observed
from fsw.core.fdir.sensors.pair import (
    Pair,
    Standing,
    is_proven,
    is_usable,
    is_valid,
    judge_pair,
    skip_judgement,
)
from fsw.core.fdir.sensors.plausibility import Findings
from fsw.core.packing import copy_state

NINE = (0.0,) * 9
CONFIG = tuned(
    attitude_sigma_deg=1.0,
    mag_bias_t=Prior((3e-7,) * 3, (0.0,) * 3),
    dipole_body_am2=Prior((0.01,) * 3, (0.0,) * 3),
    coil_error=Prior((0.03,) * 9, NINE),
)
LIMITS, WEIGHTS = credibility_config(CONFIG), weights(40.0, 1.0)
ESTIMATE = with_values(mekf.start((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), CONFIG), nis=5.0, numbers=6)
TURNED = with_values(ESTIMATE, parameters=with_values(ESTIMATE.parameters, mag_bias_t=(2e-6, 0.0, 0.0)))
WEAK = with_values(
    ESTIMATE,
    parameters=with_values(ESTIMATE.parameters, coil_error=(0.0, 0.0, 0.0, 0.0, -0.6, 0.0, 0.0, 0.0, 0.0)),
)
"""An estimate by which a coil does 0.4 of what it should."""
DIPOLE = with_values(ESTIMATE, parameters=with_values(ESTIMATE.parameters, dipole_body_am2=(0.0, 0.05, 0.0)))
B, S = (2e-5, 1e-5, -3e-5), (1.0, 0.0, 0.0)
BOTH = Findings(0, 0, B, S, True, False)
ECLIPSE = with_values(BOTH, sun=None, pair=False)
TAKEN = Observed(BOTH, Used(True, True, False), ESTIMATE, False, False, False, False, 0.0, True)
"""A tick in which all is well."""
WITHOUT = with_values(TAKEN, estimate=None, used=Used(False, False, False))
REFUSED = with_values(TAKEN, used=Used(True, False, False), refused_sun=True)
LARGE = with_values(TAKEN, estimate=with_values(ESTIMATE, nis=20.0))
UNSURE = with_values(TAKEN, estimate=with_values(ESTIMATE, covariance=36.0 * ESTIMATE.covariance))
"""By an estimate that is certain of the attitude within 6 deg about each axis."""
BEGUN = with_values(TAKEN, estimate=with_values(ESTIMATE, nis=0.0, numbers=0))
"""The tick in which an estimate begins: both are taken, and nothing is compared."""
TRUSTED = Pair(Standing.TRUSTED, proof=WEIGHTS.threshold)


def after(pair, observed, ticks=1):
    """A copy of the pair after these ticks."""
    pair = copy_state(pair)
    for _ in range(ticks):
        judge_pair(pair, observed, WEIGHTS, LIMITS)
    return pair


def eased_before(pair):
    """The pair if its estimate was eased a while ago, and is nearly proven anew."""
    return with_values(pair, eased=True, proof=min(pair.proof, 0.9 * WEIGHTS.threshold))


def ticks_until(pair, observed, standing, most=3000):
    for ticks in count(1):
        pair = after(pair, observed)
        if pair.standing is standing:
            return ticks, pair
        if ticks >= most:
            return None, pair


class TestProof:
    def test_an_estimate_is_trusted_once_it_has_taken_both_for_long(self):
        ticks, pair = ticks_until(Pair(), TAKEN, Standing.TRUSTED)
        assert 120 < ticks < 140
        assert is_proven(pair, WEIGHTS)

    @pytest.mark.parametrize(
        "observed",
        [
            with_values(TAKEN, estimate=TURNED, credible=False),
            with_values(TAKEN, estimate=DIPOLE, credible=False),
            LARGE,
            WITHOUT,
            with_values(TAKEN, used=Used(True, False, False)),
        ],
        ids=[
            "by sensors that cannot be",
            "by a satellite that cannot be",
            "with large innovations",
            "never begun",
            "one alone",
        ],
    )
    def test_it_proves_nothing(self, observed):
        assert after(Pair(), observed, 25).proof == 0.0

    @pytest.mark.parametrize("standing", [Standing.NEW, Standing.ON_TRIAL])
    def test_a_coil_that_cannot_be_keeps_it_from_nothing(self, standing):
        """Which coil is faulty is judged by a proven estimate alone; a sensor is not forgiven beside it."""
        weak = with_values(TAKEN, estimate=WEAK, credible=False)
        ticks, pair = ticks_until(Pair(standing), weak, Standing.TRUSTED)
        assert ticks == ticks_until(Pair(standing), TAKEN, Standing.TRUSTED)[0]
        assert is_valid(pair)
        parameters = with_values(WEAK.parameters, mag_bias_t=TURNED.parameters.mag_bias_t)
        turned = with_values(weak, estimate=with_values(WEAK, parameters=parameters))
        assert ticks_until(Pair(standing), turned, Standing.TRUSTED)[0] is None

    def test_what_it_refuses_sets_back_a_young_one_by_far(self):
        young = after(Pair(), TAKEN, 60)
        assert after(young, REFUSED).proof < 0.3 * young.proof

    def test_a_trusted_one_is_proven_for_a_minute_after_it_has_last_taken_both(self):
        alone = with_values(TAKEN, findings=ECLIPSE, used=Used(True, False, False))
        assert is_proven(after(TRUSTED, alone, 60), WEIGHTS)
        later = after(TRUSTED, alone, 80)
        assert later.standing is Standing.TRUSTED
        assert not is_proven(later, WEIGHTS)

    def test_an_estimate_in_doubt_is_not_and_what_it_then_refuses_counts_against_the_pair(self):
        """A slow fault has led it away: the other sensor is the one that it refuses."""
        little, much = (with_values(TRUSTED, doubt=part * WEIGHTS.threshold) for part in (0.2, 0.3))
        assert is_proven(little, WEIGHTS)
        assert not is_proven(much, WEIGHTS)
        refused = with_values(TAKEN, refused_sun=True, used=Used(True, False, False))
        assert after(little, refused).doubt < little.doubt
        assert after(much, refused).doubt > much.doubt

    def test_without_an_estimate_trust_is_lost(self):
        assert after(TRUSTED, WITHOUT) == Pair(Standing.NEW, blind_ticks=1)

    def test_an_estimate_that_begins_anew_has_to_be_proven_again(self):
        """After a fast turn it does so without a tick in between: attitude and rate go on."""
        assert after(Pair(), BEGUN) == Pair()
        begun = after(TRUSTED, BEGUN)
        assert begun == Pair(Standing.NEW)
        ticks, _ = ticks_until(begun, TAKEN, Standing.TRUSTED)
        assert 120 < ticks < 140

    @pytest.mark.parametrize("observed", [WITHOUT, BEGUN], ids=["without one", "with another"])
    def test_where_it_had_contradicted_them_until_it_ended_the_next_is_on_trial(self, observed):
        """One of them may be wrong, and what begins with both then agrees with the wrong one."""
        lagged = after(with_values(TRUSTED, proof_required=0.3), observed)
        assert lagged.standing is Standing.ON_TRIAL
        ticks, _ = ticks_until(after(lagged, BEGUN), TAKEN, Standing.TRUSTED)
        assert 1000 < ticks < 1060

    def test_without_a_sample_or_with_the_field_alone_nothing_begins(self):
        for used in (Used(False, False, True), Used(True, False, False)):
            assert after(TRUSTED, with_values(BEGUN, used=used)).standing is Standing.TRUSTED


class TestValidity:
    """Whether an attitude may be valid."""

    @pytest.mark.parametrize("standing", Standing)
    def test_only_while_the_pair_is_trusted(self, standing):
        assert is_valid(Pair(standing, proof=WEIGHTS.threshold)) is (standing is Standing.TRUSTED)

    def test_not_once_nothing_was_taken_for_two_minutes_and_again_when_both_have_borne_it_out(self):
        blind = with_values(
            TAKEN, findings=ECLIPSE, used=Used(False, False, False), estimate=with_values(ESTIMATE, numbers=0)
        )
        pair = after(TRUSTED, blind, WEIGHTS.blind_ticks)
        assert WEIGHTS.blind_ticks == 120
        assert is_valid(pair)
        pair = after(pair, blind)
        assert pair.standing is Standing.TRUSTED
        assert not is_valid(pair)
        self.bear_out(pair)

    def test_not_while_innovations_have_a_mean_and_again_when_both_have_borne_it_out(self):
        lagging = with_values(TAKEN, estimate=with_values(ESTIMATE, lag=(0.0, 1.1, 0.0, 0.0, 0.0, 0.0)))
        pair = after(TRUSTED, lagging)
        assert pair.standing is Standing.TRUSTED
        assert not is_valid(pair)
        self.bear_out(pair)

    def test_a_mean_that_may_be_chance_is_none(self):
        slight = with_values(TAKEN, estimate=with_values(ESTIMATE, lag=(0.5, 0.6, -0.5, 0.5, 0.6, -0.5)))
        assert is_valid(after(TRUSTED, slight, 500))

    @pytest.mark.parametrize("used", [Used(True, False, False), Used(False, True, False)])
    def test_a_smaller_one_counts_that_a_sensor_shows_alone(self, used):
        for lag, holds in (((0.0, 0.8, 0.0, 0.0, 0.8, 0.0), False), ((0.0, 0.5, 0.0, 0.0, 0.5, 0.0), True)):
            lagging = with_values(TAKEN, estimate=with_values(ESTIMATE, lag=lag))
            assert is_valid(after(TRUSTED, lagging)), "with both it may be chance"
            assert is_valid(after(TRUSTED, with_values(lagging, findings=ECLIPSE, used=used))) is holds

    def bear_out(self, pair):
        alone = (Used(True, False, False), Used(False, True, False))
        for used in alone:
            assert not is_valid(after(pair, with_values(TAKEN, findings=ECLIPSE, used=used), 1000))
        ticks = round(WEIGHTS.threshold / WEIGHTS.fits)
        assert not is_valid(after(pair, TAKEN, ticks - 1))
        assert is_valid(after(pair, TAKEN, ticks + 1))

    def test_while_one_sensor_sees_it_lasts(self):
        alone = with_values(TAKEN, findings=ECLIPSE, used=Used(True, False, False))
        assert is_valid(after(TRUSTED, alone, 2000))


APART = with_values(BOTH, apart=True)
DOUBTS = {
    "large innovations": (TRUSTED, LARGE),
    "parameters beyond their bounds": (TRUSTED, with_values(TAKEN, estimate=TURNED, credible=False)),
    "the wrong angle, without an estimate": (Pair(), with_values(WITHOUT, findings=APART)),
    "the wrong angle, with a young one": (Pair(), with_values(TAKEN, findings=APART)),
    "a refusal by one that is not credible": (Pair(), with_values(REFUSED, credible=False)),
    "a refusal after a long time with one alone": (with_values(TRUSTED, proof=1.0), REFUSED),
}


@pytest.mark.requirement("REQ-SENSOR-07")
class TestDoubt:
    @pytest.mark.parametrize("name", DOUBTS)
    def test_speaks_against_the_pair_and_ends_the_filter(self, name):
        pair, observed = DOUBTS[name]
        ticks, pair = ticks_until(eased_before(pair), observed, Standing.DISPUTED)
        assert 25 < ticks < 35
        assert pair == Pair(Standing.DISPUTED, ended=True)
        assert not is_valid(pair)
        assert not after(pair, WITHOUT).ended, "once"

    @pytest.mark.parametrize(
        ("pair", "observed"),
        [
            (TRUSTED, TAKEN),
            (TRUSTED, REFUSED),
            (Pair(), REFUSED),
            (TRUSTED, with_values(TAKEN, findings=APART)),
        ],
        ids=[
            "all is well",
            "a refusal that names one",
            "a refusal by a young one",
            "an angle it explains",
        ],
    )
    def test_does_not_arise(self, pair, observed):
        assert after(pair, observed, 25).doubt == 0.0

    def test_of_an_isolated_sensor_neither_angle_nor_parameters_dispute_the_other(self):
        alone = with_values(TAKEN, isolated=True, used=Used(False, True, False))
        assert after(Pair(), with_values(alone, findings=APART), 100).standing is Standing.NEW
        assert after(TRUSTED, with_values(alone, estimate=TURNED), 100).standing is Standing.TRUSTED
        large = with_values(ESTIMATE, nis=15.0, numbers=3)
        assert after(TRUSTED, with_values(alone, estimate=large), 35).standing is Standing.DISPUTED


class TestEasing:
    """A proven estimate is eased before it ends: the satellite may change by more than its table says."""

    DOUBTED = with_values(TRUSTED, doubt=WEIGHTS.threshold - 0.01)
    BEYOND = with_values(TAKEN, estimate=TURNED, credible=False)

    @pytest.mark.parametrize("observed", [LARGE, BEYOND], ids=["large innovations", "parameters"])
    def test_it_goes_on_and_has_to_be_proven_anew(self, observed):
        pair = after(self.DOUBTED, observed)
        assert (pair.standing, pair.easing, pair.eased, pair.ended) == (Standing.TRUSTED, True, True, False)
        assert (pair.proof, pair.doubt, pair.accord, pair.false_convergence) == (0.0, 0.0, 0.0, 0.0)
        assert pair.proof_required == WEIGHTS.threshold
        assert not is_valid(pair)
        assert is_usable(pair, WEIGHTS)

    def test_it_is_eased_in_one_tick_alone(self):
        assert not after(after(self.DOUBTED, LARGE), TAKEN).easing

    def test_if_the_doubt_comes_back_before_it_is_proven_it_ends(self):
        pair = after(self.DOUBTED, LARGE)
        _, pair = ticks_until(pair, LARGE, Standing.DISPUTED, 40)
        assert (pair.ended, pair.easing, pair.eased) == (True, False, False)

    def test_once_proven_it_may_be_eased_again(self):
        pair = after(after(self.DOUBTED, LARGE), TAKEN, 200)
        assert is_valid(pair)
        assert not pair.eased
        assert after(with_values(pair, doubt=WEIGHTS.threshold - 0.01), LARGE).easing

    @pytest.mark.parametrize(
        ("pair", "observed"),
        [
            (with_values(DOUBTED, standing=Standing.NEW), LARGE),
            (with_values(DOUBTED, standing=Standing.ON_TRIAL), LARGE),
            (DOUBTED, with_values(LARGE, isolated=True)),
            (with_values(DOUBTED, proof=0.0), with_values(LARGE, findings=APART)),
            (DOUBTED, with_values(LARGE, refused_sun=True)),
        ],
        ids=["never proven", "on trial", "one is isolated", "they are apart", "one is refused"],
    )
    def test_where_a_sensor_may_be_wrong_it_ends(self, pair, observed):
        assert after(pair, observed).standing is Standing.DISPUTED


class TestSkippedJudgement:
    """While the time is in doubt: nothing is shown, but what ends or lags is not trusted."""

    def after(self, pair, estimate=ESTIMATE, used=TAKEN.used, ticks=1):
        pair = copy_state(pair)
        for _ in range(ticks):
            skip_judgement(pair, used, estimate, WEIGHTS)
        return pair

    def test_an_estimate_that_goes_on_keeps_its_standing_for_two_minutes(self):
        assert self.after(TRUSTED, ticks=120) == with_values(TRUSTED, blind_ticks=120)
        assert not is_valid(self.after(TRUSTED, ticks=121))

    def test_what_it_owes_is_not_paid(self):
        owes = with_values(TRUSTED, proof_required=3.0)
        assert self.after(owes, ticks=50).proof_required == 3.0

    @pytest.mark.parametrize("estimate", [None, BEGUN.estimate], ids=["none", "begun"])
    @pytest.mark.parametrize(("proof_required", "standing"), [(0.0, Standing.NEW), (1.0, Standing.ON_TRIAL)])
    def test_one_that_has_ended_was_proven_in_vain(self, estimate, proof_required, standing):
        pair = self.after(with_values(TRUSTED, proof_required=proof_required), estimate)
        assert (pair.standing, pair.proof, pair.proof_required) == (standing, 0.0, 0.0)

    @pytest.mark.parametrize("standing", [Standing.NEW, Standing.DISPUTED, Standing.ON_TRIAL])
    def test_any_other_standing_stays(self, standing):
        assert self.after(Pair(standing), None).standing is standing

    def test_one_that_lags_is_not_valid(self):
        lagging = with_values(ESTIMATE, lag=(0.0, 2.0, 0.0, 0.0, 0.0, 0.0))
        assert not is_valid(self.after(TRUSTED, lagging))


class TestUnsure:
    """An attitude too uncertain for linear equations is no longer what was proven."""

    def test_it_is_not_valid_before_both_have_borne_it_out_again(self):
        pair = after(TRUSTED, UNSURE)
        assert pair.unsure
        assert not is_valid(pair)
        assert is_usable(pair, WEIGHTS)
        assert not is_valid(after(pair, TAKEN, 120))
        assert is_valid(after(pair, TAKEN, 140))
        assert not after(pair, TAKEN, 140).unsure

    def test_as_long_as_it_lasts_nothing_bears_it_out(self):
        assert not is_valid(after(TRUSTED, UNSURE, 1000))

    def test_fewer_cells_than_show_the_sun_s_direction_bear_it_out_slowly(self):
        one_cell = with_values(TAKEN, findings=ECLIPSE)
        pair = after(TRUSTED, UNSURE)
        assert not is_valid(after(pair, one_cell, 500))
        assert is_valid(after(pair, one_cell, 530))

    def test_one_sensor_alone_does_not(self):
        alone = with_values(TAKEN, findings=ECLIPSE, used=Used(True, False, False))
        assert not is_valid(after(after(TRUSTED, UNSURE), alone, 1000))

    @pytest.mark.parametrize("standing", [Standing.NEW, Standing.ON_TRIAL])
    def test_one_that_is_still_to_be_proven_owes_no_more_than_that(self, standing):
        begun = after(Pair(standing), UNSURE)
        assert not begun.unsure
        assert begun.proof_required == 0.0

    def test_one_that_ends_leaves_no_doubt_of_the_sensors(self):
        assert after(after(TRUSTED, UNSURE), WITHOUT).standing is Standing.NEW

    def test_what_it_refuses_ends_it_and_disputes_no_sensor(self):
        contradicted = with_values(REFUSED, estimate=UNSURE.estimate)
        pair = after(TRUSTED, UNSURE)
        ends = [pair := after(pair, contradicted) for _ in range(200)]
        assert any(one.ended for one in ends)
        assert all(one.standing is not Standing.DISPUTED for one in ends)

    def test_a_wrong_angle_disputes_them_all_the_same(self):
        apart = with_values(REFUSED, estimate=UNSURE.estimate, findings=APART)
        assert ticks_until(after(TRUSTED, UNSURE), apart, Standing.DISPUTED)[0] < 200


class TestFalseConvergence:
    """An estimate that has settled on a satellite that cannot be begins anew, if it does not fit either."""

    LOST = with_values(
        TAKEN, credible=False, estimate=with_values(ESTIMATE, lag=(0.0, 1.1, 0.0, 0.0, 0.0, 0.0))
    )

    def test_it_ends_after_long_and_nobody_is_blamed(self):
        pair = after(eased_before(TRUSTED), self.LOST, 2000)
        assert pair.standing is Standing.TRUSTED
        pair = after(pair, self.LOST, 100)
        assert pair.standing is Standing.NEW
        assert pair.false_convergence < 0.1 * WEIGHTS.threshold

    def test_one_that_was_not_eased_before_is_eased_first(self):
        pair = after(TRUSTED, self.LOST, 2100)
        assert pair.standing is Standing.TRUSTED
        assert pair.eased

    @pytest.mark.parametrize(
        "observed",
        [
            with_values(LOST, credible=True),
            with_values(LOST, estimate=ESTIMATE),
            with_values(LOST, used=Used(True, False, False)),
        ],
        ids=["of the table", "that fits", "of one sensor alone"],
    )
    def test_one_goes_on(self, observed):
        assert after(TRUSTED, observed, 600).false_convergence == 0.0


class TestAccord:
    DISPUTED = Pair(Standing.DISPUTED)

    def test_a_disputed_pair_that_agrees_is_tried_and_then_trusted(self):
        ticks, pair = ticks_until(self.DISPUTED, WITHOUT, Standing.ON_TRIAL)
        assert 500 < ticks < 530
        assert not is_valid(pair)
        ticks, pair = ticks_until(with_values(pair, accord=0.0), TAKEN, Standing.TRUSTED)
        assert 1000 < ticks < 1060
        assert is_valid(pair)

    def test_one_wrong_angle_undoes_minutes(self):
        pair = after(self.DISPUTED, WITHOUT, 300)
        apart = with_values(WITHOUT, findings=APART)
        assert pair.accord - after(pair, apart).accord > 150 * WEIGHTS.agrees

    def test_in_eclipse_nothing_is_won_or_lost(self):
        pair = after(self.DISPUTED, WITHOUT, 300)
        assert after(pair, with_values(WITHOUT, findings=ECLIPSE), 100).accord == pair.accord

    def test_an_isolated_sensor_is_judged_so_only_while_no_estimate_can_tell(self):
        isolated = with_values(TAKEN, isolated=True)
        assert after(TRUSTED, isolated, 100).accord == 0.0
        assert after(TRUSTED, with_values(isolated, inconclusive=True), 100).accord > 0.0
