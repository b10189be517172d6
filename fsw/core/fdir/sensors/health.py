"""Which sensor is faulty, and when it is trusted again.

The evidence of a tick against one sensor is what a check finds, or that a proven filter refuses it while it
takes the other. A refusal of both, or of the Sun sensor while there is no field, does not show which is
wrong, the sensors or the estimate; nor do checks that speak against both at once, as after a loss on the bus
or with a wrong clock.

An isolated sensor is readmitted if it shows what the estimate predicts, where that is certain enough; or if
both sensors have agreed for long, in which case the estimate is given up, since it did not agree.
"""

import dataclasses
from dataclasses import dataclass
from typing import final

import numpy as np

from fsw.core.algebra.vector import Vec3, sub
from fsw.core.estimation.cells.cell_set import light
from fsw.core.estimation.estimator import Used
from fsw.core.estimation.kalman import Matrix, inverse
from fsw.core.estimation.measurement import (
    Prediction,
    deflected_sun,
    field_prediction,
    field_sampled,
    sun_prediction,
)
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.fdir.evidence import INFLATION, EvidenceWeights
from fsw.core.fdir.faults import SensorFault
from fsw.core.fdir.sensors.cell_evidence import CellEvidence
from fsw.core.fdir.sensors.cells import (
    CellsHealth,
    disproves,
    forget_accusations,
    is_contradicted,
    judge_cells,
)
from fsw.core.fdir.sensors.certainty import is_linear
from fsw.core.fdir.sensors.credibility import CredibilityConfig, is_credible
from fsw.core.fdir.sensors.memory import Memory
from fsw.core.fdir.sensors.observed import Observed, is_new
from fsw.core.fdir.sensors.pair import Pair, end_estimate, is_proven, is_valid, judge_pair
from fsw.core.fdir.sensors.plausibility import Findings
from fsw.core.fdir.sensors.watch import Watch, accuse, readmit, reset_watch
from fsw.core.orbit.ephemeris import Reference


@final
@dataclass(slots=True)
class SensorHealth:
    """Each sensor by itself, both together, and their last samples."""

    field: Watch = dataclasses.field(default_factory=Watch)
    sun: Watch = dataclasses.field(default_factory=Watch)
    pair: Pair = dataclasses.field(default_factory=Pair)
    memory: Memory = dataclasses.field(default_factory=Memory)
    cells: CellsHealth = dataclasses.field(default_factory=list)


@dataclass(frozen=True, slots=True)
class SensorConfig:
    """The weights of evidence, what is credible, and the filter."""

    weights: EvidenceWeights
    credibility: CredibilityConfig
    mekf: MekfConfig


def is_suspected(health: SensorHealth) -> bool:
    """Whether there is evidence against a sensor in use."""
    accused = _is_accused(health.field) or _is_accused(health.sun)
    for one in health.cells:
        accused = accused or _is_accused(one.watch)
    return accused


def _is_accused(watch: Watch) -> bool:
    return watch.nats > 0.0 and not watch.fault


def judge_sensors(
    health: SensorHealth,
    findings: Findings,
    used: Used,
    estimate: Estimate | None,
    reference: Reference,
    config: SensorConfig,
) -> None:
    """Judge the sensors by the samples of this tick.

    Args:
        health: of the tick before.
        findings: what the samples show by themselves.
        used: what the filter took.
        estimate: of this tick.
        reference: field and Sun as modelled.
        config: limits.
    """
    weights, field, sun, both = config.weights, health.field, health.sun, health.pair
    b_fits = _field_fits(findings, estimate, reference, config.mekf) if field.fault else None
    s_fits = _sun_fits(findings, estimate, reference, config.mekf) if sun.fault else None
    observed = Observed(
        findings,
        used,
        estimate,
        refused_field=_refused(findings.field, findings.field_cause or field.fault, used.field, estimate),
        refused_sun=_sun_compared(used, config.mekf)
        and _refused(findings.sun, findings.sun_cause or sun.fault, used.sun, estimate),
        isolated=bool(field.fault or sun.fault),
        inconclusive=bool((field.fault and b_fits is None) or (sun.fault and s_fits is None)),
        in_favour=_in_favour(field, sun),
        credible=estimate is None or is_credible(estimate, config.credibility),
    )
    trusted = is_valid(both)  # as before this tick: an estimate that lags may have been misled
    sure = trusted and is_proven(both, weights)
    was_unsure = both.unsure
    judge_pair(both, observed, weights, config.credibility)
    if both.unsure and not was_unsure:
        forget_accusations(health.cells)
    _judge_cells(health, observed, reference, sure, config)
    disproven = both.unsure and disproves(health.cells, weights)
    if disproven:
        forget_accusations(health.cells)
    if disproven or is_contradicted(health.cells):
        end_estimate(both)
    if both.accord >= weights.threshold:
        reset_watch(field)
        reset_watch(sun)
        both.accord = 0.0
        return
    alone = trusted and findings.sun is None  # dynamics do not jump
    b_refused = observed.refused_field and (alone or (sure and used.sun))
    b_refused = b_refused and _is_field_linear(estimate, reference, config.mekf)
    s_refused = (
        observed.refused_sun and sure and used.field and _is_sun_linear(estimate, reference, config.mekf)
    )
    common = findings.field_cause != 0 and findings.sun_cause != 0 and not observed.isolated
    ambiguous = observed.refused and not (b_refused or s_refused)  # not of one that a check accuses
    if field.fault:
        readmit(field, b_fits, weights)
    else:
        cause = findings.field_cause or (SensorFault.REFUSED if b_refused else 0)
        accuse(field, cause, common or (ambiguous and not findings.field_cause), weights)
    if sun.fault:
        readmit(sun, s_fits, weights)
    else:
        cause = findings.sun_cause or (SensorFault.REFUSED if s_refused else 0)
        accuse(sun, cause, common or (ambiguous and not findings.sun_cause), weights)


def _in_favour(field: Watch, sun: Watch) -> float:
    """What estimates have shown in favour of the isolated sensors, nats; of the one with less."""
    if field.fault and sun.fault:
        return min(field.nats, sun.nats)
    if field.fault:
        return field.nats
    return sun.nats if sun.fault else 0.0


def _judge_cells(
    health: SensorHealth, observed: Observed, reference: Reference, sure: bool, config: SensorConfig
) -> None:
    """Judge the Sun cells, if there are any, by the samples of this tick."""
    if config.mekf.cells is None:
        return
    findings, used, estimate = observed.findings, observed.used, observed.estimate
    evidence = CellEvidence(
        findings.currents,
        used.cells,
        estimate,
        light(reference.r_eci_m, reference.sun_eci, config.mekf.cells.albedo),
        findings.shadow,
        sure and used.field,
        estimate is None or is_new(estimate, used),
        health.pair.unsure and used.field,
    )
    judge_cells(health.cells, evidence, config.weights, config.mekf)


def _refused(sample: Vec3 | None, fault: int, taken: bool, estimate: Estimate | None) -> bool:
    """Whether the filter had a sample of a sensor in use, against which nothing spoke, and refused it."""
    return not (estimate is None or sample is None or fault or taken)


def _sun_compared(used: Used, mekf: MekfConfig) -> bool:
    """Whether the filter looked at the Sun: of cells it leaves out those that it cannot predict well."""
    return mekf.cells is None or bool(used.cells.taken or used.cells.refused)


def _field_fits(
    findings: Findings, estimate: Estimate | None, reference: Reference, mekf: MekfConfig
) -> bool | None:
    sample = findings.field
    if sample is None or estimate is None:
        return None
    prediction = _field_predicted(estimate, reference, mekf)
    return not findings.field_cause and _fits(estimate, sample, prediction, mekf.field_noise, mekf)


def _sun_fits(
    findings: Findings, estimate: Estimate | None, reference: Reference, mekf: MekfConfig
) -> bool | None:
    sample = findings.sun
    if sample is None or estimate is None:
        return None
    prediction = _sun_predicted(estimate, reference, mekf)
    return not findings.sun_cause and _fits(estimate, sample, prediction, mekf.sun_noise, mekf)


def _is_field_linear(estimate: Estimate | None, reference: Reference, mekf: MekfConfig) -> bool:
    if estimate is None:
        return False
    return is_linear(estimate, _field_predicted(estimate, reference, mekf), mekf.field_noise)


def _is_sun_linear(estimate: Estimate | None, reference: Reference, mekf: MekfConfig) -> bool:
    if estimate is None:
        return False
    return is_linear(estimate, _sun_predicted(estimate, reference, mekf), mekf.sun_noise)


def _field_predicted(estimate: Estimate, reference: Reference, mekf: MekfConfig) -> Prediction:
    q, omega, parameters = estimate.q_body_from_eci, estimate.omega_body_radps, estimate.parameters
    b_eci_t = field_sampled(parameters, reference.b_eci_t, reference.b_rate_eci_tps)
    return field_prediction(q, omega, parameters, b_eci_t, mekf)


def _sun_predicted(estimate: Estimate, reference: Reference, mekf: MekfConfig) -> Prediction:
    q, omega, parameters = estimate.q_body_from_eci, estimate.omega_body_radps, estimate.parameters
    s_eci, slope_eci = deflected_sun(parameters, reference, mekf)
    return sun_prediction(q, omega, parameters, s_eci, mekf, slope_eci)


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
