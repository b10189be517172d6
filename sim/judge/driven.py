"""The limits of the coils by the dipole that flowed, where a fault alters what the board reports."""

import numpy as np

from sim.record.truth import Histories
from sim.scenario.schema import Scenario

LEAST_PART = 0.5
"""Of the dipole of level 1: what is below was not driven, but decays."""
OF_COILS = "coil_"
"""Kinds of faults by which a coil conducts, or not, whatever its driver does."""
ALTER_REPORTS = frozenset(
    (
        *("loss", "bursts", "duplicates", "reordering", "delay", "corruption", "wrong_length", "unknown_id"),
        *("rtr", "extended_id", "error_frames", "random_frames", "flood", "queue_full"),
    )
)
"""Kinds of faults on the bus that lose, delay or alter what boards report: the log is not their word."""


def limits_as_driven(scenario: Scenario, truth: Histories) -> str:
    """What the dipole that flowed shows of a broken limit, to a tick; empty: nothing.

    Args:
        scenario: with a pulsed driver and a shared back-off, or none of this is judged.
        truth: the plant's histories.
    """
    coils, hz = scenario.coils, scenario.time.tick_hz
    touched = any(fault.kind.startswith(OF_COILS) for fault in scenario.fault)
    if coils.driver == "continuous" or not coils.shared or touched:
        return ""
    driven = np.linalg.norm(truth["m_body_am2"], axis=1) > LEAST_PART * coils.levels_am2[0]
    edges = np.flatnonzero(np.diff(driven.astype(int), prepend=0, append=0))
    begins, ends = edges[::2], edges[1::2]
    long = np.flatnonzero(ends - begins > coils.pulse_s * hz + 1)
    early = np.flatnonzero(begins[1:] - ends[:-1] < coils.backoff_s * hz - 1)
    if len(long):
        first = int(long[0])
        seconds = (ends[first] - begins[first]) / hz
        return f"a coil was driven for {seconds:g} s from tick {begins[first]} on"
    if len(early):
        first = int(early[0])
        seconds = (begins[first + 1] - ends[first]) / hz
        return f"a pulse began {seconds:g} s after the last, in tick {begins[first + 1]}"
    return ""
