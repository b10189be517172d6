"""The cases of a comparison: which laws are comparable on a scenario, and by which coil drivers."""

from dataclasses import dataclass
from enum import StrEnum

from fsw.core.laws.entry import Aim
from fsw.core.laws.table import LAWS
from fsw.input.near import did_you_mean
from fsw.input.own_code import given_as
from fsw.input.schema import Nested, merge
from fsw.table.own_law import declared
from fsw.table.sections import laws_by_aim
from fsw.table.table import lay_over
from sim.campaign.flight import Order
from sim.errors import HarnessError
from sim.scenario.schema import Scenario, load
from sim.tuning.applicable import aims_of, check_suited, coils_of, is_suited
from sim.tuning.kept import KeptGains


class Driver(StrEnum):
    """How the dipole that a law asks for gets to the coils."""

    PULSED = "pulsed"
    """By the scheduler, within the scenario's limits of pulse and back-off."""
    CONTINUOUS = "continuous"
    """Any dipole each tick, up to full scale."""


@dataclass(frozen=True, slots=True)
class ComparisonCase:
    """One flight of a comparison: a law, a driver, and the order to fly them.

    Attributes:
        law: its name.
        aim: of the law.
        driver: of the coils.
        order: to fly them.
        tuned: whether with the best gains that were found, not with the scenario's.
        here: whether this process alone has the law, which was given as an object.
    """

    law: str
    aim: Aim
    driver: Driver
    order: Order
    tuned: bool = False
    here: bool = False


@dataclass(frozen=True, slots=True)
class Candidates:
    """The laws that can be compared on a scenario: by name, the aim of each, and how a scenario names it."""

    aims: dict[str, Aim]
    references: dict[str, str]


def candidates(scenario: Scenario) -> Candidates:
    """The laws of the table, and the scenario's own.

    Raises:
        TableError: the scenario's own law cannot be loaded.
    """
    control = scenario.control
    aims, references = {name: row.aim for name, row in LAWS.items()}, {name: name for name in LAWS}
    if control.own:
        aims[control.law_name], references[control.law_name] = declared(control).aim, control.law
    return Candidates(aims, references)


def chosen_laws(scenario: Scenario, text: str | None) -> tuple[str, ...]:
    """The laws to compare, in the order of the table of laws, the scenario's own last.

    Args:
        scenario: without ``text``, all laws that are meant for its body, its own among them.
        text: names of laws or aims, or ``all``, with commas between; of an aim those that have their wheel.
            A law of the scenario's own is always among them.

    Raises:
        HarnessError: a name that is neither a law nor an aim.
    """
    known = candidates(scenario).aims
    if text is None:
        aimed = aims_of(scenario)
        return tuple(name for name, aim in known.items() if aim in aimed and is_suited(name, scenario))
    words = [word.strip() for word in text.split(",")]
    aims = [aim.value for aim in Aim]
    for word in words:
        if word not in {*known, *aims, "all"}:
            hint = did_you_mean(word, [*known, *aims])
            raise HarnessError(
                f"--laws {text}: there is no law '{word}'{hint}: give names (docs/laws.md), aims, whose laws "
                f"are flown, or all; {laws_by_aim(known)}"
            )
    named = {
        name for name, aim in known.items() if {aim.value, "all"} & set(words) and is_suited(name, scenario)
    }
    own = {scenario.control.law_name} if scenario.control.own else set()
    return tuple(name for name in known if name in {*named, *words, *own})


def cases(
    source: str | Scenario,
    settings: Nested,
    laws: tuple[str, ...],
    drivers: tuple[Driver, ...],
    seed: int,
    orbits: float | None,
    kept: KeptGains | None = None,
) -> tuple[ComparisonCase, ...]:
    """Every law by every driver that it has a use for, all else the same but the gains that are kept for it.

    What ``settings`` say stands before those gains.

    Raises:
        TableError: the scenario is not valid, or not with one of the drivers, or a law has not what it needs.
    """
    scenario = load(source, settings)
    known = candidates(scenario)
    check_suited(laws, source, settings)
    all_cases = []
    for driver in drivers:
        coils = coils_of(scenario, driver.value)
        suited = [law for law in laws if is_suited(law, scenario, driver.value)]
        for law in suited:
            found = None if kept is None else kept.control(driver.value, law)
            values = merge(merge({"control": found or {}}, settings), coils)
            overrides = lay_over(values, {"control": {"law": known.references[law]}})
            if law == suited[0]:
                load(source, overrides)
            order = Order(source, overrides, seed, orbits)
            untouched = merge(values, {"control": found or {}}) == values  # no setting lies over them
            here = given_as(known.references[law]) is not None
            all_cases.append(
                ComparisonCase(law, known.aims[law], driver, order, bool(found) and untouched, here)
            )
    return tuple(all_cases)
