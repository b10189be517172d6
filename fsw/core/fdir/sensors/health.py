"""Which sensor is faulty, and when it is believed again.

The evidence of a tick against one sensor is what a check finds, or that a proven filter refuses it while it
takes the other. What it refuses of both, or of the Sun sensor while there is no field, does not show which
is wrong: the sensors, or the estimate; nor do checks that speak against both at once, as after a loss on the
bus or with a wrong clock.

An isolated sensor is readmitted if it is what the estimate predicts, if that is certain enough to tell; or if
both sensors have agreed for long, in which case the filter ends, since it did not agree.
"""

from typing import NamedTuple

import numpy as np

from fsw.core.algebra.vector import Vec3, sub
from fsw.core.estimation.estimator import Used
from fsw.core.estimation.kalman import Matrix, inverse
from fsw.core.estimation.measurement import Prediction, field_prediction, sun_prediction
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.fdir.evidence import INFLATION, EvidenceWeights, weigh
from fsw.core.fdir.faults import SensorFault
from fsw.core.fdir.sensors import pair
from fsw.core.fdir.sensors.credibility import CredibilityConfig, credible
from fsw.core.fdir.sensors.pair import Observed, Pair
from fsw.core.fdir.sensors.plausibility import Findings, Memory
from fsw.core.orbit.ephemeris import Reference

LOST = 0.5
"""Part of its weight that a missing sample has: the bus may lose some, in bursts."""


class Watch(NamedTuple):
    """One sensor: its fault (0: none), and the evidence against it; while it is isolated, for it; nats."""

    fault: int = 0
    nats: float = 0.0


class SensorHealth(NamedTuple):
    """Each sensor by itself, both together, and their last samples."""

    field: Watch = Watch()
    sun: Watch = Watch()
    pair: Pair = Pair()
    memory: Memory = Memory()

    def integers(self) -> tuple[int, ...]:
        """For the checksum of the state, as is ``floats``."""
        faults = (self.field.fault, self.sun.fault)
        both = self.pair
        return (*faults, both.standing, both.ended, both.blind_ticks, *self.memory.integers())

    def floats(self) -> tuple[float, ...]:
        """The evidence, and the last samples."""
        return (self.field.nats, self.sun.nats, *self.pair[1:4], *self.pair[6:8], *self.memory.floats())


class SensorConfig(NamedTuple):
    """The weights of evidence, what is credible, and the filter."""

    weights: EvidenceWeights
    credibility: CredibilityConfig
    mekf: MekfConfig


def suspected(health: SensorHealth) -> bool:
    """Whether there is evidence against a sensor in use."""
    return any(watch.nats > 0.0 and not watch.fault for watch in (health.field, health.sun))


def judge(
    health: SensorHealth,
    findings: Findings,
    used: Used,
    estimate: Estimate | None,
    reference: Reference,
    config: SensorConfig,
) -> SensorHealth:
    """The health after the samples of this tick.

    Args:
        health: of the tick before.
        findings: what the samples show by themselves.
        used: what the filter took.
        estimate: of this tick.
        reference: field and Sun as modelled.
        config: limits.
    """
    weights, (field, sun) = config.weights, health[:2]
    b_fits = _field_fits(findings, estimate, reference, config.mekf) if field.fault else None
    s_fits = _sun_fits(findings, estimate, reference, config.mekf) if sun.fault else None
    seen = Observed(
        findings,
        used,
        estimate,
        refused_field=_refused(findings.field, findings.field_cause or field.fault, used.field, estimate),
        refused_sun=_refused(findings.sun, findings.sun_cause or sun.fault, used.sun, estimate),
        isolated=bool(field.fault or sun.fault),
        untold=bool((field.fault and b_fits is None) or (sun.fault and s_fits is None)),
        shown=min([watch.nats for watch in (field, sun) if watch.fault], default=0.0),
        sound=estimate is None or credible(estimate, config.credibility),
    )
    both = pair.judge(health.pair, seen, weights, config.credibility)
    if both.accord >= weights.threshold:
        return SensorHealth(Watch(), Watch(), both._replace(accord=0.0), findings.memory)
    trusted = pair.valid(health.pair)  # one that lags may have been led away
    sure = trusted and pair.proven(health.pair, weights)
    alone = trusted and findings.sun is None  # dynamics do not jump
    b_refused = seen.refused_field and (alone or (sure and used.sun))
    s_refused = seen.refused_sun and sure and used.field
    common = findings.field_cause and findings.sun_cause and not seen.isolated
    unclear = common or (seen.refused and not (b_refused or s_refused))
    if field.fault:
        field = _readmitted(field, b_fits, weights)
    else:
        cause = findings.field_cause or (SensorFault.REFUSED if b_refused else 0)
        field = _accused(field, cause, unclear, weights)
    if sun.fault:
        sun = _readmitted(sun, s_fits, weights)
    else:
        cause = findings.sun_cause or (SensorFault.REFUSED if s_refused else 0)
        sun = _accused(sun, cause, unclear, weights)
    return SensorHealth(field, sun, both, findings.memory)


def _refused(sample: Vec3 | None, fault: int, taken: bool, estimate: Estimate | None) -> bool:
    """Whether the filter had a sample of a sensor in use, against which nothing spoke, and refused it."""
    return not (estimate is None or sample is None or fault or taken)


def _accused(watch: Watch, cause: int, unclear: bool, weights: EvidenceWeights) -> Watch:
    """A sensor in use after a tick in which this speaks against it, or nothing; or it is unclear what."""
    by = -weights.against
    if unclear:
        by = 0.0
    elif cause:
        by = LOST * weights.against if cause == SensorFault.SILENT else weights.against
    nats = weigh(watch.nats, by, weights.threshold)
    if nats >= weights.threshold:
        return Watch(cause)
    return watch if nats == watch.nats else Watch(0, nats)


def _readmitted(watch: Watch, fits: bool | None, weights: EvidenceWeights) -> Watch:
    """An isolated sensor after a tick in which its sample fits, or not, or nothing shows it."""
    if fits is None:
        return watch
    nats = weigh(watch.nats, weights.fits if fits else weights.misfits, weights.threshold)
    return Watch() if nats >= weights.threshold else Watch(watch.fault, nats)


def _field_fits(
    findings: Findings, estimate: Estimate | None, reference: Reference, mekf: MekfConfig
) -> bool | None:
    sample = findings.field
    if sample is None or estimate is None:
        return None
    prediction = field_prediction(*estimate[:3], reference.b_eci_t, mekf)
    return not findings.field_cause and _fits(estimate, sample, prediction, mekf.field_noise, mekf)


def _sun_fits(
    findings: Findings, estimate: Estimate | None, reference: Reference, mekf: MekfConfig
) -> bool | None:
    sample = findings.sun
    if sample is None or estimate is None:
        return None
    prediction = sun_prediction(*estimate[:3], reference.sun_eci, mekf)
    return not findings.sun_cause and _fits(estimate, sample, prediction, mekf.sun_noise, mekf)


def _fits(
    estimate: Estimate, sample: Vec3, prediction: Prediction, noise: Matrix, mekf: MekfConfig
) -> bool | None:
    """Whether a sample would pass the filter's gate; None where its prediction is too uncertain to tell."""
    predicted, sensitivity = prediction
    innovation = np.array(sub(sample, predicted))
    covariance = sensitivity.dot(estimate.covariance).dot(sensitivity.T) + noise
    if np.trace(covariance) > INFLATION * np.trace(noise):
        return None
    return bool(innovation.dot(inverse(covariance)).dot(innovation) <= mekf.gate_nis)
