"""A law of one's own in a run that was flown before: its source is executed only where it is named again."""

from pathlib import Path

from fsw.input import own_code
from fsw.input.own_code import display
from fsw.own_law import GROUP
from sim.errors import HarnessError
from sim.scenario.schema import Scenario, flight_table


def with_law_named(scenario: Scenario, law: str | None, of_run: bool = True) -> tuple[Scenario, str]:
    """The scenario of a run with the source that is to be executed in place of the recorded one.

    Args:
        scenario: as the run has it.
        law: the law named on the command line, against the current directory; None: none.
        of_run: the source must be that of the run.

    Returns:
        The scenario, and a sentence if the source is another one than that of the run; empty if not.

    Raises:
        HarnessError: the run flew a law of one's own which is not named, or another than the named.
        TableError: the source cannot be read.
    """
    control = flight_table(scenario).control
    if not control.own:
        if law is not None:
            raise HarnessError(f"--law {law}: the run flew {control.law!r}, a law of the table")
        return scenario, ""
    flown = f"{display(control.law)}, SHA-256 {str(control.law_sha256)[:16]}..."
    if law is None:
        raise HarnessError(
            f"the run flew a law of its own ({flown}), which is executed only where it is named again: "
            f"--law {control.law}"
        )
    found = own_code.find(law, Path(), GROUP)
    if found is None:
        raise HarnessError(f"--law {law}: neither FILE.py:NAME nor an installed law")
    if own_code.short_name(law) != control.law_name:
        raise HarnessError(f"--law {law}: the run flew another law ({flown})")
    changed = _with(scenario, found)
    if found.sha256 == control.law_sha256:
        return changed, ""
    sentence = (
        f"{found.reference} is not the source that the run flew: its SHA-256 is {found.sha256[:16]}..., "
        f"that of the run {str(control.law_sha256)[:16]}..."
    )
    if of_run:
        raise HarnessError(sentence)
    return changed, sentence


def _with(scenario: Scenario, found: own_code.Found) -> Scenario:
    """The scenario that names this source where it named the law, in ``[flight]`` or for all."""
    named = {"law": found.reference, "law_sha256": found.sha256}
    below = scenario.flight.get("control")
    if isinstance(below, dict) and "law" in below:
        return scenario.model_copy(update={"flight": {**scenario.flight, "control": {**below, **named}}})
    return scenario.model_copy(update={"control": scenario.control.model_copy(update=named)})
