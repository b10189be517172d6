"""A made-up flight with given figures, and the case that it belongs to."""

from math import cos, radians, sin

import numpy as np
import pytest

from fsw.core.laws.table import LAWS
from fsw.wire.messages import Mode
from sim.audit.auditor import AuditLimits, audit
from sim.campaign.flight import Order, RecordedFlight
from sim.compare.case import ComparisonCase, Driver
from sim.record.estimates import EstimateRecorder
from sim.report.summary import BusTally
from sim.scenario.schema import load


@pytest.fixture
def plant_record(bus_log, fired):
    """A record with these errors about an axis, a tick each; its pulses as (coil, tick)."""

    def plant(
        errors_deg,
        overrides=None,
        axis=(0.0, 1.0, 0.0),
        rate_radps=(0.0, 0.0, 0.0),
        dipole_am2=None,
        pulses=((0, 110), (2, 240)),
    ):
        ticks = len(errors_deg)
        turns = [(cos(radians(a) / 2), *(sin(radians(a) / 2) * np.array(axis))) for a in errors_deg]
        truth = {
            "t_s": np.arange(ticks, dtype=float),
            "q_body_from_orbit": np.array(turns),
            "omega_body_orbit_radps": np.tile(np.array(rate_radps), (ticks, 1)),
            "lit": (np.arange(ticks) % 200 < 120).astype(float),
            "m_body_am2": np.zeros((ticks, 3)) if dipole_am2 is None else np.array(dipole_am2),
        }
        estimates = EstimateRecorder(ticks).estimates()
        estimates.mode[:] = Mode.DETUMBLE
        estimates.mode[-1] = Mode.ACQUIRE
        log = bus_log(ticks=ticks, pulses=[fired(coil, tick) for coil, tick in pulses])
        audited = audit(log.entries(), AuditLimits(tick_hz=1))
        return RecordedFlight(load("microsat", overrides or {}), {}, truth, estimates, audited, BusTally(0))

    return plant


@pytest.fixture
def case_of():
    """The case of a law and a driver, of no flight in particular."""
    return lambda law="pd", driver=Driver.PULSED: ComparisonCase(
        law, LAWS[law].aim, driver, Order("microsat")
    )
