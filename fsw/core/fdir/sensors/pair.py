"""Both sensors together: whether the estimate is proven right about them, and whether they disagree.

Without an attitude only the angle between two directions can be compared, and a filter can explain a slow
fault for long: it spreads it over both sensors and its parameters. So evidence against the pair is

- innovations that are larger than the filter expects, and not so large that its gate refuses them;
- a sensor that it can only take with parameters that the table does not allow;
- while the estimate is not proven: what it refuses, if it is not credible or was proven once; an angle that
  is not the modelled one.

When that is enough, the pair is disputed: both sensors are kept, the filter ends, and none begins before both
have agreed for long. No attitude is valid before its estimate is proven, nor after long without a sample
taken.
"""

from dataclasses import dataclass
from enum import IntEnum
from typing import Final, final

from fsw.core.estimation.estimator import Used
from fsw.core.estimation.mekf import Estimate
from fsw.core.fdir.evidence import PAIR_NUMBERS, EvidenceWeights, mean_misfit, misfit, weigh
from fsw.core.fdir.sensors.certainty import is_unsure
from fsw.core.fdir.sensors.credibility import (
    CredibilityConfig,
    are_sensors_credible,
    is_credible_but_coils,
)
from fsw.core.fdir.sensors.observed import Observed, is_new
from fsw.core.fdir.sensors.plausibility import Findings

SUSPICIOUS: Final = 0.25
"""Fraction of the threshold: with more doubt about the pair, a refusal counts against no single sensor."""

TRIAL: Final = 2 * PAIR_NUMBERS
"""How many times as long an estimate on trial has to prove itself. A turned sensor may keep the modelled
angle until the field has turned about the Sun, which takes a sixth of an orbit."""

ALONE: Final = 0.4
"""Fraction of the threshold at which a lag of one sensor alone counts: the other cannot contradict it."""


class Standing(IntEnum):
    """What is thought of both sensors together.

    ``NEW``: no estimate has been proven yet. ``TRUSTED``: this one has. ``DISPUTED``: one sensor is wrong,
    and nothing shows which. ``ON_TRIAL``: they have agreed since, or a trusted estimate has contradicted them
    until it ended; the new one is still to be proven.
    """

    NEW = 0
    TRUSTED = 1
    DISPUTED = 2
    ON_TRIAL = 3


@final
@dataclass(slots=True)
class Pair:
    """The standing of both, and the evidence, nats.

    ``proof``: that the estimate is right about both; ``doubt``: that one is wrong; ``accord``: that both are
    right, while they are disputed, or one is isolated and no estimate can tell; ``false_convergence``: that
    the estimate has settled on a satellite that the table does not allow and that is not this one either.
    ``ended``: the filter is to end in this tick; ``blind_ticks``: ticks since it took a sample;
    ``proof_required``: what an estimate that lagged, or was blind, still has to prove; ``easing``: the filter
    is to be eased in this tick; ``eased``: it was, and has not been proven since; ``unsure``: it was too
    uncertain for its linear equations, and has not been confirmed since.
    """

    standing: Standing = Standing.NEW
    proof: float = 0.0
    doubt: float = 0.0
    accord: float = 0.0
    ended: bool = False
    blind_ticks: int = 0
    proof_required: float = 0.0
    false_convergence: float = 0.0
    easing: bool = False
    eased: bool = False
    unsure: bool = False


def is_proven(pair: Pair, weights: EvidenceWeights) -> bool:
    """Whether the estimate has shown for long enough, and lately, that it is right about both sensors.

    Not while there is doubt: a slow fault of one may have misled it, so that it refuses the other.
    """
    enough = pair.proof >= 0.5 * weights.threshold and pair.doubt < SUSPICIOUS * weights.threshold
    return pair.standing is Standing.TRUSTED and enough


def is_valid(pair: Pair) -> bool:
    """Whether an attitude that rests on them may be valid."""
    return pair.standing is Standing.TRUSTED and not pair.proof_required


def is_usable(pair: Pair, weights: EvidenceWeights) -> bool:
    """Whether such an attitude may be controlled by: while it lags, or was eased, too, but not blindly."""
    return pair.standing is Standing.TRUSTED and pair.blind_ticks <= weights.blind_ticks


def judge_pair(
    pair: Pair, observed: Observed, weights: EvidenceWeights, credibility: CredibilityConfig
) -> None:
    """Judge the pair by a tick; an ``accord`` that has reached the threshold readmits an isolated sensor."""
    threshold, estimate, used = weights.threshold, observed.estimate, observed.used
    disputed, doubt, accord = pair.standing is Standing.DISPUTED, 0.0, 0.0
    if observed.isolated or disputed:
        counts = observed.inconclusive or disputed
        accord = _accord(pair.accord, observed.findings, weights) if counts else pair.accord
    if not disputed:
        by = weights.against * _misfit(pair, observed, weights, credibility)
        doubt = weigh(pair.doubt, by, threshold)
    if doubt >= threshold and _may_ease(pair, observed):
        ease_estimate(pair, weights)
        return
    if doubt >= threshold:  # an attitude that got lost is no sensor's fault
        lost = pair.unsure and not (observed.isolated or observed.findings.apart)
        end_estimate(pair, Standing.NEW if lost else Standing.DISPUTED)
        return
    if accord + observed.in_favour >= threshold:
        end_estimate(pair, Standing.ON_TRIAL)
        pair.accord = threshold
        return
    proof = _proof(pair, observed, weights, credibility)
    if not disputed and proof >= threshold:
        pair.standing = Standing.TRUSTED
    elif estimate is None or is_new(estimate, used):
        pair.standing = _without_proof(pair)
    pair.proof, pair.doubt, pair.accord, pair.ended = proof, doubt, accord, False
    pair.blind_ticks = 0 if used.field or used.sun else pair.blind_ticks + 1
    whole = observed.findings.sun is not None
    pair.proof_required = _proof_required(pair, estimate, used, weights, whole)
    pair.unsure = _is_unsure(pair, estimate)
    if pair.unsure and pair.proof_required >= threshold:  # it is not the one that was proven
        pair.proof = 0.0
    pair.easing = False
    pair.eased = pair.eased and (proof < threshold or pair.proof_required > 0.0)
    lost = pair.proof_required > 0.0 and used.field and used.sun and not observed.credible
    slow = weights.agrees / PAIR_NUMBERS  # a faulty coil, which looks the same at first, is found sooner
    pair.false_convergence = weigh(pair.false_convergence, slow if lost else -slow, threshold)
    if pair.false_convergence >= threshold and _may_ease(pair, observed):
        ease_estimate(pair, weights)
    elif pair.false_convergence >= threshold:
        end_estimate(pair)


def skip_judgement(pair: Pair, used: Used, estimate: Estimate | None, weights: EvidenceWeights) -> None:
    """Carry the pair over a tick in which field and Sun may be those of another time.

    What is taken then shows nothing, for the estimate or against a sensor: the time without a sample goes on.
    But an estimate that has begun anew is not the one that was proven, and one that lags has to be.
    """
    pair.blind_ticks += 1
    pair.ended = pair.easing = False
    if estimate is None or is_new(estimate, used):
        pair.standing = _without_proof(pair)
        pair.proof, pair.proof_required = 0.0, 0.0
    else:
        pair.proof_required = max(pair.proof_required, _proof_required(pair, estimate, used, weights, False))
    pair.unsure = _is_unsure(pair, estimate)


def _may_ease(pair: Pair, observed: Observed) -> bool:
    """Whether the satellite may have changed by more than its table says: the sensors still agree.

    Once, until the estimate is proven anew: what an eased one cannot follow is a fault.
    """
    agree = not (observed.isolated or observed.refused or observed.findings.apart)
    return pair.standing is Standing.TRUSTED and agree and not pair.eased


def ease_estimate(pair: Pair, weights: EvidenceWeights) -> None:
    """Ease the estimate in this tick: it goes on, wider, and has to be proven anew."""
    pair.easing = pair.eased = True
    pair.ended = False
    pair.proof, pair.doubt, pair.accord, pair.false_convergence = 0.0, 0.0, 0.0, 0.0
    pair.proof_required = weights.threshold


def end_estimate(pair: Pair, standing: Standing = Standing.NEW) -> None:
    """End the filter in this tick: nothing counts of what has been shown so far."""
    pair.standing, pair.ended, pair.blind_ticks = standing, True, 0
    pair.proof, pair.doubt, pair.accord = 0.0, 0.0, 0.0
    pair.proof_required, pair.false_convergence = 0.0, 0.0
    pair.easing = pair.eased = pair.unsure = False


def discard_proof(pair: Pair) -> None:
    """Forget what the lost estimate has proved."""
    if pair.standing is Standing.TRUSTED:
        pair.standing = Standing.NEW
    pair.proof = 0.0


def _without_proof(pair: Pair) -> Standing:
    """The standing where there is no estimate, or another has begun: a trusted one has ended."""
    if pair.standing is not Standing.TRUSTED:
        return pair.standing
    return Standing.ON_TRIAL if pair.proof_required and not pair.unsure else Standing.NEW


def _misfit(
    pair: Pair, observed: Observed, weights: EvidenceWeights, credibility: CredibilityConfig
) -> float:
    """What this tick weighs against the pair, as a fraction of the most that a tick may.

    While one sensor is isolated, only the innovations of the other count: angle and parameters are of both.
    """
    estimate, wrong = observed.estimate, False
    if not observed.isolated:
        if not is_proven(pair, weights):
            was_proven = pair.standing is Standing.TRUSTED and observed.findings.pair
            wrong = observed.findings.apart or (observed.refused and (was_proven or not observed.credible))
        if not (wrong or observed.credible or estimate is None):
            wrong = not are_sensors_credible(estimate, credibility)
    if wrong:
        return 1.0
    return -1.0 if estimate is None else _innovations(estimate)


def _innovations(estimate: Estimate) -> float:
    """What the innovations of this tick weigh against the pair; -1 without any."""
    return misfit(estimate.nis, estimate.numbers) if estimate.numbers else -1.0


def _proof(pair: Pair, observed: Observed, weights: EvidenceWeights, credibility: CredibilityConfig) -> float:
    """An estimate gains by each pair that it takes, slowly on trial; a trusted one loses without one.

    Its coils need not be credible: a faulty one is found only once the estimate is proven. Of a trusted one
    the sensors alone need be: what turns the satellite may be a coil's fault.
    """
    estimate, used = observed.estimate, observed.used
    if estimate is None or is_new(estimate, used):
        return 0.0
    trusted, by = pair.standing is Standing.TRUSTED, 0.0
    if observed.refused:
        by = 0.0 if trusted else weights.misfits
    elif not (
        are_sensors_credible(estimate, credibility)
        if trusted
        else is_credible_but_coils(estimate, credibility)
    ):
        by = -weights.fits
    elif used.field and used.sun:
        by = weights.fits if _innovations(estimate) < 0.0 else 0.0
    elif trusted:
        by = -weights.fits
    times = TRIAL if pair.standing is Standing.ON_TRIAL else 1
    return weigh(pair.proof, by / times, weights.threshold)


def _is_unsure(pair: Pair, estimate: Estimate | None) -> bool:
    """Whether an estimate that was proven is, or has been since it was confirmed, too uncertain."""
    if estimate is None or pair.standing is not Standing.TRUSTED:
        return False
    return is_unsure(estimate) or (pair.unsure and pair.proof_required > 0.0)


def _proof_required(
    pair: Pair, estimate: Estimate | None, used: Used, weights: EvidenceWeights, whole: bool
) -> float:
    """What both sensors have to prove anew, by the ticks without a sample, this one included.

    After a time without a sample, in which pulses may have failed; if the innovations have a mean that is not
    chance, which contradicts the covariance: sooner with one sensor alone, as in the shadow; and if a trusted
    attitude is too uncertain for the filter's equations. Both prove it, by the ``whole`` Sun, or slowly by
    what fewer than three cells show of it.
    """
    if estimate is None:
        return 0.0
    alone = used.field != used.sun
    most = ALONE * weights.threshold if alone else weights.threshold
    lags = mean_misfit(estimate.lag, weights) >= most
    unsure = pair.standing is Standing.TRUSTED and is_unsure(estimate)
    if lags or unsure or pair.blind_ticks > weights.blind_ticks:
        return weights.threshold
    if not (used.field and used.sun):
        return pair.proof_required
    return max(0.0, pair.proof_required - (weights.fits if whole else weights.agrees))


def _accord(accord: float, findings: Findings, weights: EvidenceWeights) -> float:
    """Both sensors gain by each pair at the modelled angle."""
    if findings.field is None or findings.sun is None:
        return accord
    good = findings.pair and not findings.apart
    return weigh(accord, weights.agrees if good else weights.misfits, weights.threshold)
