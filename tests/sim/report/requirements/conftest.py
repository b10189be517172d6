"""Flights made up for their requirements, by the bits that matter."""

from fractions import Fraction

import numpy as np
import pytest

from fsw.wire.messages import Mode
from sim.audit.auditor import AuditLimits, AuditReport
from sim.record.estimates import Estimates
from sim.report.figures.performance import blocks
from sim.report.requirements.judge import Judgement
from sim.scenario.schema import load, orbit_period_s


@pytest.fixture(scope="session")
def report_of():
    """An audit with these pulses of a flight of so many seconds."""

    def make(pulses=(), span_s=6000, **limits):
        return AuditReport(AuditLimits(**limits), tuple(pulses), (), (), 1, Fraction(span_s), None, True)

    return make


@pytest.fixture(scope="session")
def judge_made(report_of):
    """Judges a made-up flight of microsat: turns about axis 3 by tick, deg; an estimate off by a constant."""

    def judge(requirement, turn_deg, pulses=(), wrong_deg=0.1, settings=None, lit=1.0, rate_radps=0.0):
        scenario = load("microsat", {**(settings or {}), "requirement": requirement})
        ticks, half = len(turn_deg), np.radians(turn_deg) / 2.0
        q = np.stack((np.cos(half), 0.0 * half, 0.0 * half, np.sin(half)), axis=1)
        off = half - np.radians(wrong_deg) / 2.0
        truth = {
            "t_s": np.arange(ticks, dtype=float),
            "q_body_from_orbit": q,
            "omega_body_orbit_radps": np.tile([rate_radps, 0.0, 0.0], (ticks, 1)),
            "lit": np.full(ticks, lit) if np.isscalar(lit) else lit,
            "m_body_am2": np.zeros((ticks, 3)),
        }
        estimates = Estimates(
            q_body_from_orbit=np.stack((np.cos(off), 0.0 * off, 0.0 * off, np.sin(off)), axis=1),
            omega_body_orbit_radps=truth["omega_body_orbit_radps"],
            omega_body_radps=truth["omega_body_orbit_radps"],
            covariance=np.tile(np.eye(6) * 1e-4, (ticks, 1, 1)),
            valid=np.ones(ticks, dtype=bool),
            mode=np.full(ticks, int(Mode.POINT)),
        )
        judgement = Judgement(scenario, ticks)
        for block in blocks(truth, estimates):
            judgement.take(*block)
        return judgement.outcomes(report_of(pulses, ticks), {})

    return judge


@pytest.fixture(scope="session")
def orbit_ticks():
    """Ticks of an orbit of microsat."""
    return round(orbit_period_s(load("microsat")))
