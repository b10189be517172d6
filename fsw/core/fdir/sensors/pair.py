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

from enum import IntEnum
from typing import NamedTuple

from fsw.core.estimation.estimator import Used
from fsw.core.estimation.mekf import Estimate
from fsw.core.fdir.evidence import PAIR_NUMBERS, EvidenceWeights, mean_misfit, misfit, weigh
from fsw.core.fdir.sensors.credibility import CredibilityConfig, credible_but_coils, sensors_credible
from fsw.core.fdir.sensors.plausibility import Findings

SUSPICIOUS = 0.25
"""Fraction of the threshold: with more doubt about the pair, a refusal counts against no single sensor."""

ALONE = 0.4
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


class Pair(NamedTuple):
    """The standing of both, and the evidence, nats.

    ``proof``: that the estimate is right about both; ``doubt``: that one is wrong; ``accord``: that both are
    right, while they are disputed, or one is isolated and no estimate can tell; ``strange``: that the
    estimate has settled on a satellite that the table does not allow and that is not this one either.
    ``ended``: the filter is to end in this tick; ``blind_ticks``: ticks since it took a sample; ``owed``:
    what an estimate that lagged, or was blind, still has to prove.
    """

    standing: Standing = Standing.NEW
    proof: float = 0.0
    doubt: float = 0.0
    accord: float = 0.0
    ended: bool = False
    blind_ticks: int = 0
    owed: float = 0.0
    strange: float = 0.0


class Observed(NamedTuple):
    """What one tick shows of both: the samples, what the filter took, and what it refused of those in use.

    ``isolated``: one of them is, ``untold``: and no estimate is certain enough to show whether it is still
    faulty; ``shown``: what estimates have shown in its favour so far, nats. ``sound``: the estimate, if there
    is one, is credible.
    """

    findings: Findings
    used: Used
    estimate: Estimate | None
    refused_field: bool
    refused_sun: bool
    isolated: bool
    untold: bool
    shown: float
    sound: bool

    @property
    def refused(self) -> bool:
        """Whether the filter refused any."""
        return self.refused_field or self.refused_sun

    @property
    def begun(self) -> bool:
        """Whether the estimate began with the samples of this tick: they are taken, not compared."""
        return _begun(self.estimate, self.used)


def _begun(estimate: Estimate | None, used: Used) -> bool:
    return estimate is not None and used.sun and estimate.numbers == 0


def proven(pair: Pair, weights: EvidenceWeights) -> bool:
    """Whether the estimate has shown for long enough, and lately, that it is right about both sensors.

    Not while there is doubt: a slow fault of one may have misled it, so that it refuses the other.
    """
    shown = pair.proof >= 0.5 * weights.threshold and pair.doubt < SUSPICIOUS * weights.threshold
    return pair.standing is Standing.TRUSTED and shown


def valid(pair: Pair) -> bool:
    """Whether an attitude that rests on them may be valid."""
    return pair.standing is Standing.TRUSTED and not pair.owed


def judge(pair: Pair, seen: Observed, weights: EvidenceWeights, credibility: CredibilityConfig) -> Pair:
    """The pair after a tick; an ``accord`` that has reached the threshold readmits an isolated sensor."""
    threshold, standing, doubt, accord = weights.threshold, pair.standing, 0.0, 0.0
    if seen.isolated or standing is Standing.DISPUTED:
        counts = seen.untold or standing is Standing.DISPUTED
        accord = _accord(pair.accord, seen.findings, weights) if counts else pair.accord
    if standing is not Standing.DISPUTED:
        by = weights.against * _misfit(pair, seen, weights, credibility)
        doubt = weigh(pair.doubt, by, threshold)
    proof = _proof(pair, seen, weights, credibility)
    if doubt >= threshold:
        return Pair(Standing.DISPUTED, ended=True)
    if accord + seen.shown >= threshold:
        return Pair(Standing.ON_TRIAL, accord=threshold, ended=True)
    if standing is not Standing.DISPUTED and proof >= threshold:
        standing = Standing.TRUSTED
    elif seen.estimate is None or seen.begun:
        standing = _without_proof(pair)
    blind_ticks = 0 if seen.used.field or seen.used.sun else pair.blind_ticks + 1
    owed = _owed(pair.owed, blind_ticks, seen.estimate, seen.used, weights)
    lost = owed > 0.0 and seen.used.field and seen.used.sun and not seen.sound
    slow = weights.agrees / PAIR_NUMBERS  # a faulty coil, which looks the same at first, is found sooner
    strange = weigh(pair.strange, slow if lost else -slow, threshold)
    if strange >= threshold:
        return Pair(ended=True)
    return Pair(standing, proof, doubt, accord, False, blind_ticks, owed, strange)


def unjudged(pair: Pair, used: Used, estimate: Estimate | None, weights: EvidenceWeights) -> Pair:
    """The pair after a tick in which field and Sun may be those of another time.

    What is taken then shows nothing, for the estimate or against a sensor: the time without a sample goes on.
    But an estimate that has begun anew is not the one that was proven, and one that lags has to be.
    """
    blind_ticks = pair.blind_ticks + 1
    owed = max(pair.owed, _owed(pair.owed, blind_ticks, estimate, used, weights))
    if estimate is None or _begun(estimate, used):
        return pair._replace(
            standing=_without_proof(pair), proof=0.0, ended=False, blind_ticks=blind_ticks, owed=0.0
        )
    return pair._replace(ended=False, blind_ticks=blind_ticks, owed=owed)


def _without_proof(pair: Pair) -> Standing:
    """The standing where there is no estimate, or another has begun: a trusted one has ended."""
    if pair.standing is not Standing.TRUSTED:
        return pair.standing
    return Standing.ON_TRIAL if pair.owed else Standing.NEW


def _misfit(pair: Pair, seen: Observed, weights: EvidenceWeights, credibility: CredibilityConfig) -> float:
    """What this tick weighs against the pair, as a fraction of the most that a tick may.

    While one sensor is isolated, only the innovations of the other count: angle and parameters are of both.
    """
    estimate, wrong = seen.estimate, False
    if not seen.isolated:
        if not proven(pair, weights):
            was_proven = pair.standing is Standing.TRUSTED and seen.findings.pair
            wrong = seen.findings.apart or (seen.refused and (was_proven or not seen.sound))
        wrong = wrong or not (seen.sound or estimate is None or sensors_credible(estimate, credibility))
    if wrong:
        return 1.0
    return -1.0 if estimate is None else _innovations(estimate)


def _innovations(estimate: Estimate) -> float:
    """What the innovations of this tick weigh against the pair; -1 without any."""
    return misfit(estimate.nis, estimate.numbers) if estimate.numbers else -1.0


def _proof(pair: Pair, seen: Observed, weights: EvidenceWeights, credibility: CredibilityConfig) -> float:
    """An estimate gains by each pair that it takes, slowly on trial; a trusted one loses without one.

    Its coils need not be credible: a faulty one is found only once the estimate is proven. Of a trusted one
    the sensors alone need be: what turns the satellite may be a coil's fault.
    """
    if seen.estimate is None or seen.begun:
        return 0.0
    trusted = pair.standing is Standing.TRUSTED
    sound = (sensors_credible if trusted else credible_but_coils)(seen.estimate, credibility)
    if seen.refused:
        by = 0.0 if trusted else weights.misfits
    elif not sound:
        by = -weights.fits
    elif seen.used.field and seen.used.sun:
        by = weights.fits if _innovations(seen.estimate) < 0.0 else 0.0
    else:
        by = -weights.fits if trusted else 0.0
    slow = PAIR_NUMBERS if pair.standing is Standing.ON_TRIAL else 1
    return weigh(pair.proof, by / slow, weights.threshold)


def _owed(
    owed: float, blind_ticks: int, estimate: Estimate | None, used: Used, weights: EvidenceWeights
) -> float:
    """What both sensors have to prove anew.

    After a time without a sample, in which pulses may have failed; and if the innovations have a mean that is
    not chance, which contradicts the covariance: sooner with one sensor alone, as in the shadow.
    """
    if estimate is None:
        return 0.0
    alone = used.field != used.sun
    most = ALONE * weights.threshold if alone else weights.threshold
    lags = mean_misfit(estimate.lag, weights) >= most
    if lags or blind_ticks > weights.blind_ticks:
        return weights.threshold
    both = used.field and used.sun
    return max(0.0, owed - weights.fits) if both else owed


def _accord(accord: float, findings: Findings, weights: EvidenceWeights) -> float:
    """Both sensors gain by each pair at the modelled angle."""
    if findings.field is None or findings.sun is None:
        return accord
    good = findings.pair and not findings.apart
    return weigh(accord, weights.agrees if good else weights.misfits, weights.threshold)
