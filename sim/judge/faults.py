"""The rows of the fault table that a user's flight software can fly, and why it cannot fly the others.

A row is flown as a scenario with the faults of the row: those that the plant's process injects, on the bus to
the flight software, in sensors, coils and boards. What the rig alone can do, or what reaches into the flight
software of this project, does not apply. Times are counted from fixed ones, as no pulse is sure to come.
"""

from collections.abc import Iterator, Sequence
from math import inf
from random import Random

from fsw.input.schema import TableError, merge
from sim.fault_table.case import ARMED_S, BEFORE_ECLIPSE, ECLIPSE_S, phase_s
from sim.fault_table.row import SCENARIO, FaultRow, Unseen, When
from sim.fault_table.wrong_estimates import ALONE_DEG, WRONG_DEG
from sim.faults.kinds import KINDS
from sim.judge.series import SeriesCase
from sim.scenario.schema import Scenario, orbit_period_s, parse_settings, scenario_of
from sim.scenario.written import values_of

OF_THE_PROCESS = ("killed", "stopped", "storm", "all_restart", "sigkill", "sigstop")
OF_MEMORY = ("bit_flip",)
_HONEST_DEG = {Unseen.NEVER: WRONG_DEG, Unseen.AT_FIRST: None, Unseen.ALWAYS: None}
"""How wrong a valid attitude may be; three times its sigma where nothing on board shows it for a while."""


def fault_cases(scenario: Scenario, rows: Sequence[FaultRow], phases: int, seed: int) -> Iterator[SeriesCase]:
    """A case for each row and phase; one for a row that does not apply.

    Args:
        scenario: what the rows are flown with.
        rows: of the fault table.
        phases: of each row.
        seed: of the first phase; each further one has the next.
    """
    for row in rows:
        if why_not := not_applicable(row, scenario):
            yield SeriesCase(row.name, None, why_not=why_not)
            continue
        for phase in range(phases):
            name = row.name if phases == 1 else f"{row.name}-{phase}"
            try:
                flown = _with_faults(row, scenario, phase)
            except TableError as error:
                yield SeriesCase(name, None, why_not=f"it does not fit the satellite: {_last_clause(error)}")
                break
            honest_deg = _HONEST_DEG.get(row.unseen, ALONE_DEG)
            yield SeriesCase(name, flown, seed + phase, "", _in_words(row), honest_deg)


def not_applicable(row: FaultRow, scenario: Scenario) -> str:
    """Why a row cannot be flown by a user's flight software, a clause; empty where it can."""
    kinds = [fault.kind for fault in row.faults]
    elsewhere = row.when is When.ECLIPSE and scenario.name != SCENARIO
    reasons = {
        "it reaches into the memory of this project's flight software": any(k in OF_MEMORY for k in kinds),
        "it kills or stops the process of the flight software": any(k in OF_THE_PROCESS for k in kinds),
        "only this project's rig loses, holds or repeats SYNC": not all(KINDS[k].in_plant for k in kinds),
        "it changes the onboard table of this project's flight software": any(
            setting.startswith("flight.") for setting in row.settings
        ),
        f"it is of the satellite {row.scenario}": row.scenario not in (SCENARIO, scenario.name),
        f"it begins at an eclipse of the satellite {SCENARIO}": elsewhere,
    }
    return next((why for why, holds in reasons.items() if holds), "")


def _with_faults(row: FaultRow, scenario: Scenario, phase: int) -> Scenario:
    """The scenario with the faults of a row, as long as they and what is watched after them take.

    Raises:
        TableError: the satellite does not have what the row acts on.
    """
    rng = Random(f"{row.name}/{phase}")
    begins_s = {When.BOOT: 0.0, When.ECLIPSE: ECLIPSE_S, When.ORBIT: orbit_period_s(scenario)}
    onset_s = begins_s.get(row.when, ARMED_S) + phase_s(row.when, phase, rng)
    end_s = onset_s + max((one.after_s + (one.lasts_s if one.lasts_s < inf else 0.0)) for one in row.faults)
    faults = [
        {
            "kind": one.kind,
            "at_s": onset_s + one.after_s,
            "parameters": one.parameters,
            **({"lasts_s": one.lasts_s} if one.lasts_s < inf else {}),
        }
        for one in row.faults
    ]
    settings = (*row.settings, BEFORE_ECLIPSE) if row.when is When.ECLIPSE else row.settings
    values = merge(values_of(scenario), parse_settings(settings))
    values["fault"], values["requirement"] = faults, []
    values = merge(values, {"time": {"orbits": (end_s + row.watch_s) / orbit_period_s(scenario)}})
    return scenario_of(values, f"row {row.name}")


def _in_words(row: FaultRow) -> str:
    return ", then ".join(one.kind.replace("_", " ") for one in row.faults)


def _last_clause(error: TableError) -> str:
    return str(error).partition(": ")[2]
