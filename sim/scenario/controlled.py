"""The quantity that a scenario's modes and law control, and the error below which it has settled."""

from typing import NamedTuple

from fsw.core.laws.entry import Aim
from fsw.core.laws.table import LAWS
from fsw.table.own_law import declared
from fsw.table.sections import ControlTable
from sim.scenario.schema import Scenario, flight_table

SETTLED_DEG = 5.0
SLOW_DEGPS, SLOWEST_DEGPS = 1.0, 0.1
"""Rates under which a tumble counts as stopped: one that an estimate can follow, and one to point from."""


class Controlled(NamedTuple):
    """What is controlled: its name in requirements, in words, and the error below which it has settled."""

    what: str
    words: str
    unit: str
    threshold: float


def controlled(scenario: Scenario) -> Controlled:
    """Body axis 1 or the whole attitude, as the modes judge; the rate under a law that does not point."""
    table = flight_table(scenario)
    modes = table.modes
    if modes.axis_only:
        return Controlled("axis", "axis 1", "deg", SETTLED_DEG)
    if _aim(table.control) in (Aim.THREE_AXIS, Aim.AXIS):
        return Controlled("attitude", "whole attitude", "deg", SETTLED_DEG)
    return Controlled("rate", "rate", "deg/s", modes.slow_degps)


def _aim(control: ControlTable) -> Aim:
    """Of the law that flies; one whose source is withheld is taken to point."""
    if control.own:
        return Aim.THREE_AXIS if control.law_withheld else declared(control).aim
    return LAWS[control.law].aim
