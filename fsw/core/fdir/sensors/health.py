"""Which sensor is faulty, and when it is trusted again.

The evidence of a tick against one sensor is what a check finds, or that a proven filter refuses it while it
takes the other. A refusal of both, or of the Sun sensor while there is no field, does not show which is
wrong, the sensors or the estimate; nor do checks that speak against both at once, as after a loss on the bus
or with a wrong clock.

An isolated sensor is readmitted if it shows what the estimate predicts, where that is certain enough; or if
both sensors have agreed for long, in which case the estimate is given up, since it did not agree.
"""

from typing import NamedTuple

import numpy as np

from fsw.core.algebra.vector import Vec3, sub
from fsw.core.estimation.cells.cell_set import light
from fsw.core.estimation.cells.update import NO_CELLS
from fsw.core.estimation.estimator import Used
from fsw.core.estimation.kalman import Matrix, inverse
from fsw.core.estimation.measurement import Prediction, field_prediction, field_sampled, sun_prediction
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.fdir.evidence import INFLATION, EvidenceWeights
from fsw.core.fdir.faults import SensorFault
from fsw.core.fdir.sensors import cells, pair
from fsw.core.fdir.sensors.cells import CellEvidence, CellsHealth
from fsw.core.fdir.sensors.credibility import CredibilityConfig, credible
from fsw.core.fdir.sensors.pair import Observed, Pair
from fsw.core.fdir.sensors.plausibility import Findings, Memory
from fsw.core.fdir.sensors.watch import Watch, accused, readmitted
from fsw.core.orbit.ephemeris import Reference


class SensorHealth(NamedTuple):
    """Each sensor by itself, both together, and their last samples."""

    field: Watch = Watch()
    sun: Watch = Watch()
    pair: Pair = Pair()
    memory: Memory = Memory()
    cells: CellsHealth = ()


class SensorConfig(NamedTuple):
    """The weights of evidence, what is credible, and the filter."""

    weights: EvidenceWeights
    credibility: CredibilityConfig
    mekf: MekfConfig


def faults(health: SensorHealth) -> tuple[int, ...]:
    """The fault of each sensor and cell."""
    return (health.field.fault, health.sun.fault, *[one.watch.fault for one in health.cells])


def suspected(health: SensorHealth) -> bool:
    """Whether there is evidence against a sensor in use."""
    watches = (health.field, health.sun, *[one.watch for one in health.cells])
    return any(watch.nats > 0.0 and not watch.fault for watch in watches)


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
        refused_sun=_sun_compared(used, config.mekf)
        and _refused(findings.sun, findings.sun_cause or sun.fault, used.sun, estimate),
        isolated=bool(field.fault or sun.fault),
        untold=bool((field.fault and b_fits is None) or (sun.fault and s_fits is None)),
        shown=min([watch.nats for watch in (field, sun) if watch.fault], default=0.0),
        sound=estimate is None or credible(estimate, config.credibility),
    )
    both = pair.judge(health.pair, seen, weights, config.credibility)
    trusted = pair.valid(health.pair)  # an estimate that lags may have been misled
    sure = trusted and pair.proven(health.pair, weights)
    by_cell = _cells(health, seen, reference, sure, config)
    if cells.contradicted(by_cell):
        both = Pair(ended=True)
    if both.accord >= weights.threshold:
        return SensorHealth(Watch(), Watch(), both._replace(accord=0.0), findings.memory, by_cell)
    alone = trusted and findings.sun is None  # dynamics do not jump
    b_refused = seen.refused_field and (alone or (sure and used.sun))
    s_refused = seen.refused_sun and sure and used.field
    common = findings.field_cause and findings.sun_cause and not seen.isolated
    ambiguous = seen.refused and not (b_refused or s_refused)  # says nothing of one that a check accuses
    if field.fault:
        field = readmitted(field, b_fits, weights)
    else:
        cause = findings.field_cause or (SensorFault.REFUSED if b_refused else 0)
        field = accused(field, cause, common or (ambiguous and not findings.field_cause), weights)
    if sun.fault:
        sun = readmitted(sun, s_fits, weights)
    else:
        cause = findings.sun_cause or (SensorFault.REFUSED if s_refused else 0)
        sun = accused(sun, cause, common or (ambiguous and not findings.sun_cause), weights)
    return SensorHealth(field, sun, both, findings.memory, by_cell)


def _cells(
    health: SensorHealth, seen: Observed, reference: Reference, sure: bool, config: SensorConfig
) -> CellsHealth:
    """Each Sun cell after the samples of this tick."""
    if config.mekf.cells is None:
        return ()
    evidence = CellEvidence(
        seen.findings.currents,
        seen.used.cells,
        seen.estimate,
        light(reference.r_eci_m, reference.sun_eci, config.mekf.cells.albedo),
        seen.findings.shadow,
        sure and seen.used.field,
        seen.estimate is None or seen.begun,
    )
    return cells.judge(health.cells, evidence, config.weights, config.mekf)


def _refused(sample: Vec3 | None, fault: int, taken: bool, estimate: Estimate | None) -> bool:
    """Whether the filter had a sample of a sensor in use, against which nothing spoke, and refused it."""
    return not (estimate is None or sample is None or fault or taken)


def _sun_compared(used: Used, mekf: MekfConfig) -> bool:
    """Whether the filter looked at the Sun: of cells it leaves out those that it cannot predict well."""
    return mekf.cells is None or used.cells != NO_CELLS


def _field_fits(
    findings: Findings, estimate: Estimate | None, reference: Reference, mekf: MekfConfig
) -> bool | None:
    sample = findings.field
    if sample is None or estimate is None:
        return None
    b_eci_t = field_sampled(estimate.parameters, reference.b_eci_t, reference.b_rate_eci_tps)
    prediction = field_prediction(*estimate[:3], b_eci_t, mekf)
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
