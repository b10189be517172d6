"""The limits of the coils by the currents that flowed, where a fault alters what the board reports.

What the board reports is then no evidence: a status may be lost, late or another's. The plant's truth has the
mean dipole m over each tick; with k_j the dipole of one ampere of coil j and the columns of A the axes of the
coils in the body, the mean current of coil j over the tick is (A^-1 m)_j / k_j. A pulse is seen to a tick at
either end, so that only what is beyond a limit by more than that counts.
"""

from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.plant.hardware.coils import body_from_coils
from sim.record.truth import Histories
from sim.scenario.assemble import coil_config
from sim.scenario.schema import Scenario
from sim.value_types import Array

LEAST_PART = 0.5
"""Of the current of level 1: what is below was not driven, but decays."""
SLACK = 1.01
"""By how much a current is beyond the highest level, as a part of it, before it counts."""
IN_COILS = frozenset(("coil_open", "coil_wired", "coil_stuck_on"))
"""Kinds of faults by which a coil conducts, or not, whatever its driver does."""
ALTER_REPORTS = frozenset(
    (
        *("loss", "bursts", "duplicates", "reordering", "delay", "corruption", "wrong_length", "unknown_id"),
        *("rtr", "extended_id", "error_frames", "random_frames", "flood", "queue_full"),
    )
)
"""Kinds of faults on the bus that lose, delay or alter what boards report: the log is not their word."""


class DrivenLimits(NamedTuple):
    """What the currents show of the limits.

    Attributes:
        broken: the first limit that is broken, a clause; empty: none is.
        unjudged: why nothing can be judged, a clause; empty: it can.
    """

    broken: str = ""
    unjudged: str = ""


class _CoilDriven(NamedTuple):
    """Ticks from the first to before the last in which a coil was driven; that of row k is [k - 1, k)."""

    first: int
    past: int
    coil: int


def alters_reports(scenario: Scenario) -> bool:
    """Whether a fault of the scenario alters what boards report."""
    return any(fault.kind in ALTER_REPORTS for fault in scenario.fault)


def limits_as_driven(scenario: Scenario, truth: Histories) -> DrivenLimits:
    """What the currents that flowed show of the limits of the coils.

    Args:
        scenario: that was flown.
        truth: the plant's histories.
    """
    if any(fault.kind in IN_COILS for fault in scenario.fault):
        return DrivenLimits(unjudged="the fault drives a coil, or opens it, whatever the board does")
    currents_a = np.abs(_currents_a(scenario, truth["m_body_am2"]))
    judge = _beyond_full_scale if scenario.coils.driver == "continuous" else _beyond_limits
    return DrivenLimits(next(judge(scenario, currents_a), ""))


def _currents_a(scenario: Scenario, m_body_am2: Array) -> Array:
    """The mean current of each coil over each tick, (n, 3) [A]; of a coil that makes no dipole 0."""
    config = coil_config(scenario)
    axes = body_from_coils(config.misalignment_rad, config.wiring)
    by_coil = m_body_am2 if axes is None else m_body_am2 @ np.linalg.inv(np.array(axes)).T
    k = config.dipole_per_ampere_am2 * np.array(config.dipole_scale)
    result: Array = np.divide(by_coil, k, out=np.zeros_like(by_coil), where=k != 0.0)
    return result


def _beyond_full_scale(scenario: Scenario, currents_a: Array) -> Iterator[str]:
    """Of a continuous driver: no more than full scale for its part of a tick."""
    coils = scenario.coils
    if coils.max_dipole_am2 is None:
        return
    most_a = coils.on_fraction * coils.max_dipole_am2 / coils.dipole_per_ampere_am2
    for row, coil in np.argwhere(currents_a > SLACK * most_a)[:1].tolist():
        yield f"coil {coil} was driven beyond full scale in tick {row - 1}"


def _beyond_limits(scenario: Scenario, currents_a: Array) -> Iterator[str]:
    """Of a pulsed driver: levels, length, back-off from boot and after a pulse, one coil at a time."""
    coils, hz = scenario.coils, scenario.time.tick_hz
    _, _, most_a = (level / coils.dipole_per_ampere_am2 for level in coils.levels_am2)
    for row, coil in np.argwhere(currents_a > SLACK * most_a)[:1].tolist():
        yield f"coil {coil} was driven beyond level 3 in tick {row - 1}"
    pulses = _pulses(currents_a > LEAST_PART * coils.levels_am2[0] / coils.dipole_per_ampere_am2)
    for one in pulses:
        if one.past - one.first > coils.pulse_s * hz + 1:
            yield f"coil {one.coil} was driven for {(one.past - one.first) / hz:g} s from tick {one.first} on"
        if one.first < coils.backoff_s * hz - 1:
            yield f"a pulse began {one.first / hz:g} s after the board's boot, in tick {one.first}"
    yield from _together(pulses)
    of_coils = [[one for one in pulses if one.coil == coil] for coil in range(3)]
    for together in [pulses] if coils.shared else of_coils:
        for before, after in pairwise(together):
            if after.first - before.past < coils.backoff_s * hz - 1:
                gap_s = max(0, after.first - before.past) / hz
                yield f"a pulse began {gap_s:g} s after the last, in tick {after.first}"


def _together(pulses: list[_CoilDriven]) -> Iterator[str]:
    for before, after in pairwise(pulses):
        if before.past - after.first > 2:
            yield f"coils {before.coil} and {after.coil} were driven at once in tick {after.first + 1}"


def _pulses(driven: NDArray[np.bool_]) -> list[_CoilDriven]:
    """The pulses of all coils by their begin, from whether each was driven in the tick that ends at a row."""
    found = []
    for coil in range(3):
        edges = np.flatnonzero(np.diff(driven[:, coil].astype(int), prepend=0, append=0))
        found += [
            _CoilDriven(int(first) - 1, int(past) - 1, coil)
            for first, past in zip(edges[::2], edges[1::2], strict=True)
        ]
    return sorted(found)
