"""What field and Sun show together: contradiction, and the proof of an estimate."""

import pytest

from fsw.core.fdir.sensor_pair import MISFIT, Comparison, Pair, PairConfig, judge_pair, proven

CONFIG = PairConfig(report_ticks=10, prove_ticks=15, agree_ticks=100)
AGREE = Comparison(True, agree=True, unexplained=False, estimated=False, took_both=False, refused=False)
CONTRADICT = AGREE._replace(agree=False, unexplained=True)
FLAWED = AGREE._replace(agree=False)
"""One of them has a fault of its own."""
ALONE = AGREE._replace(both=False)
TAKEN = AGREE._replace(estimated=True, took_both=True)
REFUSED = AGREE._replace(estimated=True, refused=True)
UNUSED = AGREE._replace(estimated=True)
PROVEN = Pair(proof=CONFIG.prove_ticks)


def after(pair, *comparisons):
    for comparison in comparisons:
        pair = judge_pair(pair, comparison, CONFIG)
    return pair


class TestContradiction:
    def test_it_is_reported_after_some_ticks_not_before(self):
        almost = after(Pair(), *[CONTRADICT] * 9)
        assert (almost.apart, almost.contradictory) == (9, False)
        assert after(almost, CONTRADICT).contradictory

    def test_ticks_of_agreement_are_taken_off(self):
        assert after(Pair(), *[CONTRADICT] * 9, *[AGREE] * 2, *[CONTRADICT] * 2).apart == 9
        assert after(Pair(), AGREE).apart == 0

    @pytest.mark.parametrize("comparison", [AGREE, ALONE, FLAWED], ids=["agree", "alone", "flawed"])
    def test_it_ends_when_it_has_been_absent_for_as_long(self, comparison):
        pair = after(Pair(), *[CONTRADICT] * 30)
        assert pair.apart == CONFIG.report_ticks
        ticks = [after(pair, *[comparison] * count).contradictory for count in range(12)]
        assert ticks == [True] * 10 + [False] * 2

    def test_a_fault_of_one_sensor_alone_is_none(self):
        assert not after(Pair(), *[FLAWED] * 50).contradictory

    def test_against_a_proven_estimate_there_is_none(self):
        """What that refuses isolates a sensor instead."""
        contradiction = CONTRADICT._replace(estimated=True, refused=True)
        assert after(PROVEN, *[contradiction] * 50) == PROVEN

    def test_it_costs_the_proof_and_a_long_agreement(self):
        unproven = Pair(apart=CONFIG.report_ticks - 1, proof=CONFIG.prove_ticks - 1)
        contradiction = CONTRADICT._replace(estimated=True, refused=True)
        assert after(unproven, contradiction) == Pair(CONFIG.report_ticks, True, -CONFIG.agree_ticks)


class TestProof:
    @pytest.mark.parametrize(("proof", "is_proven"), [(-100, False), (0, False), (14, False), (15, True)])
    def test_it_is_complete_at_its_number_of_ticks(self, proof, is_proven):
        assert proven(Pair(proof=proof), CONFIG) is is_proven

    def test_it_grows_by_each_pair_that_the_estimate_takes_and_no_further(self):
        assert [after(Pair(), *[TAKEN] * ticks).proof for ticks in (0, 1, 15, 16, 40)] == [0, 1, 15, 15, 15]

    def test_a_tick_without_both_adds_nothing(self):
        assert after(Pair(proof=7), UNUSED).proof == 7

    def test_a_refusal_undoes_many_until_it_is_complete(self):
        config = CONFIG._replace(prove_ticks=MISFIT + 10)
        assert judge_pair(Pair(proof=MISFIT + 3), REFUSED, config).proof == 3
        assert after(Pair(proof=CONFIG.prove_ticks - 1), REFUSED).proof == 0
        assert after(PROVEN, REFUSED).proof == CONFIG.prove_ticks

    @pytest.mark.parametrize("comparison", [AGREE, ALONE, FLAWED], ids=["agree", "alone", "flawed"])
    def test_it_is_lost_with_the_estimate(self, comparison):
        assert after(PROVEN, comparison).proof <= 0

    def test_an_estimate_that_begins_in_spite_of_a_debt_starts_without_it(self):
        assert after(Pair(proof=-30), REFUSED).proof == 0


class TestAgreementBeforeAnEstimate:
    @pytest.mark.parametrize(("good", "bad", "owed"), [(30, 0, 0), (30, 2, 40), (0, 3, 60), (0, 30, 100)])
    def test_each_bad_pair_costs_many_good_ones(self, good, bad, owed):
        pair = after(Pair(), *[AGREE] * good, *[CONTRADICT] * bad)
        assert pair.proof == -owed
        assert [after(pair, *[AGREE] * ticks).proof for ticks in range(owed + 2)] == [*range(-owed, 1), 0]

    def test_a_tick_without_both_changes_nothing(self):
        assert after(Pair(proof=-30), *[ALONE] * 20).proof == -30

    def test_a_fault_of_one_sensor_costs_as_much(self):
        assert after(Pair(proof=-30), FLAWED).proof == -30 - MISFIT
