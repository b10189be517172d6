"""One case of the table: a row, a phase and a seed. The same case gives the same flight."""

import time
import warnings
from datetime import UTC, datetime, timedelta
from functools import lru_cache
from math import inf
from random import Random

from fsw.core.config import FlightConfig
from fsw.input.schema import merge
from fsw.table.config import flight_config
from sim.campaign import population
from sim.fault_rig import currents
from sim.fault_rig.process_rig import ProcessRig, random_strikes
from sim.fault_rig.record import FaultFlightRecord
from sim.fault_rig.rig import ClockRig, Rig
from sim.fault_table import checks
from sim.fault_table.isolation import isolation_s
from sim.fault_table.row import SCENARIO, CaseResult, FaultRow, When
from sim.faults.kinds import KINDS, make
from sim.scenario.schema import Scenario, flight_table, load, parse_settings

POPULATION = "50kg"
ARMED_S = 180.0
"""Time in which the flight settles before a fault: boot, first lockout, filter [s]."""
BEFORE_ECLIPSE = 'time.epoch_utc="2015-03-27T03:13:11Z"'
"""Start of a flight 600 s before an eclipse."""
ECLIPSE_S = 500.0
PLACE_DEG = 36.0
CYCLE_S = 103.0
ORDER = (1.0, 0.0, 2.0, 3.0, 102.0, 50.0, 4.0, 101.0, 99.0, 25.0, 100.0, 75.0)
"""First phases in a pulse and its back-off [s]; further ones are random."""
PATIENCE_S = ARMED_S + 40.0 * CYCLE_S
"""By when there is a first pulse, if there ever is one [s]."""
SPACING_S = 37.0
INITIAL_TURN = ("initial.axis=[0.9, 0.3, -0.2]", "initial.rate_degps=[0.05, -0.07, 0.04]")
FIRST_DEG, STEP_DEG = 75.0, 47.0
"""Initial attitudes of flights that are faulty from their first tick on."""
FIRST_UTC, PLACE_S = datetime(2015, 3, 27, 2, 46, 57, tzinfo=UTC), 604.0
"""Start of flights that begin at one of ten places of the orbit; the time between two of them [s]."""


@lru_cache(maxsize=8)
def prepare(
    settings: tuple[str, ...] = (), satellite: int | None = None, name: str = SCENARIO
) -> tuple[Scenario, FlightConfig]:
    """The scenario and its onboard table, with settings over those of a satellite of the population."""
    drawn = {} if satellite is None else population.satellite(POPULATION, satellite)
    scenario = load(name, merge(drawn, parse_settings(settings)))
    return scenario, flight_config(flight_table(scenario))


def satellite_of(phase: int, seed: int) -> int | None:
    """The satellite of the population that a case flies, a new one in each; None: the scenario's own.

    Every second case has one, in each phase and with each seed.
    """
    return (phase << 16) + seed if (phase + seed) % 2 == 0 else None


def settings_of(row: FaultRow, phase: int) -> tuple[str, ...]:
    """Settings of the scenario for this row."""
    if row.when is When.BOOT:
        return (*row.settings, *INITIAL_TURN, f"initial.angle_deg={(FIRST_DEG + phase * STEP_DEG) % 180.0}")
    if row.when is When.ORBIT and row.scenario != SCENARIO:  # whose orbit is a circle
        return (*row.settings, f"orbit.u0_deg={phase * PLACE_DEG % 360.0}")
    if row.when is When.ORBIT:
        start = FIRST_UTC + timedelta(seconds=phase * PLACE_S)
        return (*row.settings, f'time.epoch_utc="{start:%Y-%m-%dT%H:%M:%SZ}"')
    return (*row.settings, BEFORE_ECLIPSE) if row.when is When.ECLIPSE else row.settings


def fly(row: FaultRow, phase: int, seed: int) -> CaseResult:
    """Fly one case and judge it."""
    began = time.perf_counter()
    satellite = satellite_of(phase, seed) if row.scenario == SCENARIO else None
    scenario, config = prepare(settings_of(row, phase), satellite, row.scenario)
    bounds = checks.bounds_of(scenario)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # from the algebra, on a state with a flipped bit
        if KINDS[row.kind].by_signal:
            record = _fly_strikes(row, phase, seed, scenario)
        else:
            rig = ClockRig if KINDS[row.kind].by_clock else Rig
            record = _fly_fault(row, phase, seed, rig(scenario, config, seed), bounds.orbit_s)
    outcomes = checks.judge(row, record, bounds)
    return CaseResult(row.name, phase, seed, outcomes, _figures(row, record), time.perf_counter() - began)


def _fly_strikes(row: FaultRow, phase: int, seed: int, scenario: Scenario) -> FaultFlightRecord:
    times = round(row.parameters["times"])
    planned = random_strikes(times, Random(f"{row.name}/{phase}/{seed}"))
    rig = ProcessRig(scenario, seed, stop=row.kind == "sigstop")
    return rig.fly(planned)


def _fly_fault(row: FaultRow, phase: int, seed: int, rig: Rig, orbit_s: float) -> FaultFlightRecord:
    rng = Random(f"{row.name}/{phase}/{seed}")
    faults = [make(fault.kind, fault.parameters, rng) for fault in row.faults]
    hz, record = rig.record.tick_hz, rig.record
    offset_s = phase_s(row.when, phase, rng)
    reference = _fly_to_reference(row.when, rig, orbit_s)
    if reference is None:
        return rig.finish()
    onset = reference + round(offset_s * hz)
    for fault, planned in zip(faults, row.faults, strict=True):
        first = onset + round(planned.after_s * hz)
        rig.inject(
            fault, first, None if planned.lasts_s == inf else first + max(1, round(planned.lasts_s * hz))
        )
    end = record.end
    watched = (end if end is not None else onset) + round(row.watch_s * hz)
    latest = watched
    if "recovers" in row.expect:
        latest = max(watched, (end or onset) + round((orbit_s + checks.GOOD_FOR_S) * hz) + 2)
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
    """The start of the fault after the reference tick of its phases [s]."""
    if when is When.PULSE:
        return ORDER[phase] if phase < len(ORDER) else rng.uniform(0.0, CYCLE_S)
    return 0.0 if when in (When.BOOT, When.ORBIT) else phase * SPACING_S


def _fly_to_reference(when: When, rig: Rig, orbit_s: float) -> int | None:
    """Fly until the reference tick of the phases: the next tick, or the one before.

    None: there is none, since a step raised an exception or no pulse came.
    """
    hz, record = rig.record.tick_hz, rig.record
    after_s = {When.BOOT: 0.0, When.SUNLIT: ARMED_S, When.ECLIPSE: ECLIPSE_S, When.ORBIT: orbit_s}
    until_s = after_s.get(when, PATIENCE_S)
    while rig.plant.tick < until_s * hz:
        rig.tick()
        tick = rig.plant.tick
        if record.crash is not None:
            return None
        if when is When.PULSE and tick > ARMED_S * hz and any(record.coil_drives[-1].current_a):
            return tick - 1
    if when is When.PULSE:
        record.unfired_s = until_s
        return None
    return rig.plant.tick


def _figures(row: FaultRow, record: FaultFlightRecord) -> dict[str, float]:
    """Figures for the table."""
    onset = record.onset or 0
    figures = {
        "pulses": float(len(currents.pulses(record.coil_drives, record.tick_hz))),
        "refused": float(record.refused),
        "rejected": float(record.rejected),
        "worst step ms": record.worst_step_s * 1000.0,
    }
    errors = [error for error in record.error_deg[onset:] if error is not None]
    if errors:
        figures["worst error deg"] = max(errors)
    after_s = checks.recovery_s(record)
    if after_s is not None and "recovers" in row.expect:
        figures["recovered s"] = after_s
    named_s = [after_s for fault in row.faults if (after_s := isolation_s(fault, record)) is not None]
    if named_s:
        figures["named s"] = max(named_s)
    return figures
