"""Which laws are meant for a body, by their aim and what the scenario has; its coils with either driver."""

from collections.abc import Sequence

from fsw.core.laws.entry import Aim
from fsw.core.laws.table import LAWS
from fsw.input.schema import Nested
from fsw.table.own_law import declared
from fsw.table.table import lay_over
from sim.scenario.schema import Scenario, flight_table, load


def aims_of(scenario: Scenario) -> frozenset[Aim]:
    """The aim of the scenario's own law; with a boom or a wheel all laws that hold the whole attitude too.

    Raises:
        TableError: the scenario's own law cannot be loaded.
    """
    control = scenario.control
    own = declared(control).aim if control.own else LAWS[control.law].aim
    held = flight_table(scenario).modes.axis_only or any(scenario.body.wheel_nms)
    return frozenset({own, Aim.THREE_AXIS} if held and own is not Aim.SPIN else {own})


def laws_for(scenario: Scenario) -> tuple[str, ...]:
    """The laws of the table that are meant for the body and can fly on it, in the order of the table.

    Raises:
        TableError: the scenario's own law cannot be loaded.
    """
    aims = aims_of(scenario)
    return tuple(name for name, entry in LAWS.items() if entry.aim in aims and is_suited(name, scenario))


def is_suited(law: str, scenario: Scenario, driver: str = "pulsed") -> bool:
    """Whether a law has what it needs with that driver of the coils; one of the user's own always has."""
    if law not in LAWS:
        return True
    return flight_table(scenario).meets(LAWS[law], driver)


def check_suited(laws: Sequence[str], source: str | Scenario, over: Nested) -> None:
    """Refuse a law that has not what it needs on a scenario, whatever drives its coils.

    Raises:
        TableError: there is one; the sentence says what it needs.
    """
    scenario = load(source, over)
    for law in laws:
        if not is_suited(law, scenario):
            load(source, lay_over(over, {"control": {"law": law}}))


def coils_of(scenario: Scenario, driver: str) -> Nested:
    """The keys of a driver; full scale of a continuous one is the highest level if the scenario has none."""
    if driver == "pulsed":
        return {"coils": {"driver": driver}}
    coils = scenario.coils
    return {"coils": {"driver": driver, "max_dipole_am2": coils.max_dipole_am2 or max(coils.levels_am2)}}
