"""A user law in a run that was flown before: its source is executed only where it is named again."""

from pathlib import Path

from fsw.input import own_code
from fsw.own_law import GROUP
from fsw.table.given_law import given_law
from fsw.table.own_law import flown, withheld
from fsw.table.sections import ControlTable
from sim.errors import HarnessError
from sim.scenario.schema import Scenario, flight_table


def with_law_named(scenario: Scenario, law: str | None, of_run: bool = True) -> tuple[Scenario, str]:
    """The scenario of a run with the source that is to be executed in place of the recorded one.

    Args:
        scenario: as the run has it.
        law: the law named on the command line, relative to the current directory, or given as an object by
            a program; None: none.
        of_run: the source must be that of the run.

    Returns:
        The scenario, and a sentence if the source is not that of the run; otherwise empty.

    Raises:
        HarnessError: the run flew a user law that is not named, or not the one that is.
        TableError: the source cannot be read.
    """
    control = flight_table(scenario).control
    if not control.own:
        if law is not None:
            raise HarnessError(f"--law {law}: the run flew {control.law!r}, a law of the table")
        return scenario, ""
    if law is None:
        raise HarnessError(withheld(control))
    if own_code.given_as(control.law) is not None:
        return _with_object(scenario, control, law, of_run)
    if own_code.given_as(law) is not None:
        raise HarnessError(f"law = {own_code.display(law)}: {withheld(control)}")
    found = own_code.find(law, Path(), GROUP)
    if found is None:
        raise HarnessError(f"--law {law}: neither FILE.py:NAME nor an installed law")
    if own_code.short_name(law) != control.law_name:
        raise HarnessError(f"--law {law}: the run flew another law ({flown(control)})")
    changed = _with(scenario, law=found.reference, law_sha256=found.sha256, law_withheld=None)
    if found.sha256 == control.law_sha256:
        return changed, ""
    return changed, _another(found.reference, found.sha256, control, of_run)


def _with_object(scenario: Scenario, control: ControlTable, law: str, of_run: bool) -> tuple[Scenario, str]:
    """The same where the run flew an object; it flies under the name of then, whatever holds it now."""
    given = given_law()
    if given is None or given.reference != law:
        raise HarnessError(f"--law {law}: {withheld(control)}")
    changed = _with(scenario, law_sha256=given.sha256, law_withheld=None)
    if given.sha256 == control.law_sha256:  # of neither, perhaps: the replay tells whether it is the same
        return changed, ""
    return changed, _another(own_code.display(law), given.sha256, control, of_run)


def _another(law: str, sha256: str | None, control: ControlTable, of_run: bool) -> str:
    """The sentence that the source is not that of the run.

    Raises:
        HarnessError: it must be.
    """
    its, that = (
        "unknown" if digest is None else f"{digest[:16]}..." for digest in (sha256, control.law_sha256)
    )
    sentence = f"{law} is not the source that the run flew: its SHA-256 is {its}, that of the run {that}"
    if of_run:
        raise HarnessError(sentence)
    return sentence


def with_law_withheld(scenario: Scenario) -> Scenario:
    """The scenario of a run, of which no flight software can be made until its own law is named."""
    return scenario if scenario.own_law is None else _with(scenario, law_withheld=True)


def _with(scenario: Scenario, **values: object) -> Scenario:
    """The scenario with these values where it names the law, in ``[flight]`` or for all."""
    below = scenario.flight.get("control")
    if isinstance(below, dict) and "law" in below:
        control = {key: value for key, value in {**below, **values}.items() if value is not None}
        return scenario.model_copy(update={"flight": {**scenario.flight, "control": control}})
    return scenario.model_copy(update={"control": scenario.control.model_copy(update=values)})
