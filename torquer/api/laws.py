"""The argument ``law``: the name of a user law, or the law itself."""

from collections.abc import Iterator
from contextlib import contextmanager
from os import PathLike

from fsw.input import own_code
from fsw.input.schema import TableError
from fsw.own_law import GROUP, ControlLaw, Law
from fsw.table.given_law import standing
from fsw.table.own_law import flown
from sim.scenario.schema import Scenario, flight_table
from torquer.api.arguments import path_text

LawLike = str | PathLike[str] | Law | ControlLaw
"""``FILE.py:NAME``, an installed law by its name, a function, or a ``ControlLaw``."""


@contextmanager
def law_given(law: LawLike | None) -> Iterator[str | None]:
    """A block in which the law can be executed.

    Yields:
        The reference by which a table names it; None: there is none.

    Raises:
        TableError: it is no law.
    """
    if law is None:
        yield None
    elif isinstance(law, str | PathLike):
        yield path_text(law, "law")
    else:
        with standing(law) as reference:
            yield reference


def checked_law(law: LawLike | None) -> LawLike | None:
    """The law, kept for later calls.

    Raises:
        TableError: it is no law.
    """
    with law_given(law) as reference:
        return law if law is None or callable(law) or isinstance(law, ControlLaw) else reference


def check_two_processes(scenario: Scenario, bus: str) -> None:
    """Check that a process on this bus can execute the scenario's own law too.

    Raises:
        TableError: it was given as an object, or its file cannot be executed there.
    """
    control = flight_table(scenario).control
    if own_code.given_as(control.law) is not None:
        raise TableError(
            f"fly: bus = {bus!r}: the law ({flown(control)}) flies in this process only: write it to a file, "
            'or use bus="virtual"'
        )
    if own_code.is_running(control.law):
        own_code.load(control.law, control.law_sha256, GROUP, afresh=True)
