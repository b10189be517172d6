"""One case: a row, a phase and a seed, flown and judged. Same case, same flight."""

import time
import warnings
from math import inf
from random import Random

from sim.fault_rig import currents
from sim.fault_rig.clock_rig import ClockRig
from sim.fault_rig.processes import ProcessRig, strikes
from sim.fault_rig.record import Record
from sim.fault_rig.rig import Rig, prepared
from sim.fault_table import checks
from sim.fault_table.naming import isolated
from sim.fault_table.row import CaseResult, Row, When
from sim.faults.kinds import KINDS, make
from sim.scenario.schema import Scenario

SCENARIO = "microsat"
ARMED_S = 180.0
"""Before that the flight settles: boot, first lockout, filter."""
BEFORE_ECLIPSE = 'time.epoch_utc="2015-03-27T03:13:11Z"'
"""An eclipse begins 600 s later."""
ECLIPSE_S = 500.0
CYCLE_S = 103.0
ORDER = (1.0, 0.0, 2.0, 3.0, 102.0, 50.0, 4.0, 101.0, 99.0, 25.0, 100.0, 75.0)
"""Phases of a pulse and its back-off that come first [s]; beyond them any."""
SPACING_S = 37.0
TURNED = ("initial.axis=[0.9, 0.3, -0.2]", "initial.rate_degps=[0.05, -0.07, 0.04]")
FIRST_DEG, STEP_DEG = 75.0, 47.0
"""Attitude from which a flight begins that is faulty from its first tick on."""


def settings_of(row: Row, phase: int) -> tuple[str, ...]:
    """Settings of the scenario for this row."""
    if row.when is When.BOOT:
        return (*row.settings, *TURNED, f"initial.angle_deg={(FIRST_DEG + phase * STEP_DEG) % 180.0}")
    return (*row.settings, BEFORE_ECLIPSE) if row.when is When.ECLIPSE else row.settings


def fly(row: Row, phase: int, seed: int) -> CaseResult:
    """Fly one case and judge it."""
    began = time.perf_counter()
    scenario, config = prepared(SCENARIO, settings_of(row, phase))
    bounds = checks.bounds_of(scenario)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the algebra's, of a state whose bits have flipped
        if KINDS[row.kind].by_signal:
            record = _struck(row, phase, seed, scenario)
        else:
            rig = ClockRig if KINDS[row.kind].by_clock else Rig
            record = _flown(row, phase, seed, rig(scenario, config, seed), bounds.orbit_s)
    outcomes = checks.judge(row, record, bounds)
    return CaseResult(row.name, phase, seed, outcomes, _measured(row, record), time.perf_counter() - began)


def _struck(row: Row, phase: int, seed: int, scenario: Scenario) -> Record:
    times = round(row.parameters["times"])
    planned = strikes(times, Random(f"{row.name}/{phase}/{seed}"))
    rig = ProcessRig(scenario, seed, stop=row.kind == "sigstop")
    return rig.fly(planned)


def _flown(row: Row, phase: int, seed: int, rig: Rig, orbit_s: float) -> Record:
    rng = Random(f"{row.name}/{phase}/{seed}")
    fault = make(row.kind, row.parameters, rng)
    hz, record = rig.record.tick_hz, rig.record
    offset_s = phase_s(row.when, phase, rng)
    anchor = _anchor(row.when, rig, hz)
    onset = anchor + round(offset_s * hz)
    end = None if row.stays else onset + max(1, round(row.lasts_s * hz))
    rig.inject(fault, onset, end)
    watched = (end if end is not None else onset) + round(row.watch_s * hz)
    latest = watched
    if "recovers" in row.expect:
        latest = max(watched, onset + round((min(row.lasts_s, 1e9) + orbit_s + checks.GOOD_FOR_S) * hz) + 2)
    good = 0
    while rig.plant.tick < latest:
        rig.tick()
        error_deg = record.error_deg[-1]
        good = good + 1 if error_deg is not None and error_deg < checks.GOOD_DEG else 0
        if end is None or rig.plant.tick <= end:
            good = 0
        if rig.plant.tick >= watched and good >= checks.GOOD_FOR_S * hz:
            break
    return rig.finish()


def phase_s(when: When, phase: int, rng: Random) -> float:
    """When the fault comes, from what its phases are counted from."""
    if when is When.PULSE:
        return ORDER[phase] if phase < len(ORDER) else rng.uniform(0.0, CYCLE_S)
    return 0.0 if when is When.BOOT else phase * SPACING_S


def _anchor(when: When, rig: Rig, hz: int) -> int:
    """Fly until the tick that phases are counted from: the next one to be flown, or one before."""
    if when is When.BOOT:
        until_s = 0.0
    elif when is When.SUNLIT:
        until_s = ARMED_S
    elif when is When.ECLIPSE:
        until_s = ECLIPSE_S
    else:
        until_s = inf
    while rig.plant.tick < until_s * hz:
        rig.tick()
        tick = rig.plant.tick
        if when is When.PULSE and tick > ARMED_S * hz and any(rig.record.coil_drives[-1].current_a):
            return tick - 1
    return rig.plant.tick


def _measured(row: Row, record: Record) -> dict[str, float]:
    """Figures for the table."""
    onset = record.onset or 0
    found = {
        "pulses": float(len(currents.pulses(record.coil_drives, record.tick_hz))),
        "refused": float(record.refused),
        "rejected": float(record.rejected),
        "worst step ms": record.worst_step_s * 1000.0,
    }
    errors = [error for error in record.error_deg[onset:] if error is not None]
    if errors:
        found["worst error deg"] = max(errors)
    after_s = checks.recovered_s(record)
    if after_s is not None and "recovers" in row.expect:
        found["recovered s"] = after_s
    right = [tick for tick, unit in isolated(record) if unit == row.unit and tick >= onset]
    if right:
        found["named s"] = (right[0] - onset) / record.tick_hz
    return found
