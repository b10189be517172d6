"""The columns of a run: the keys of its summary with underscores for dots and numbers for elements."""

from collections.abc import Iterator, Mapping
from typing import Any

from fsw.core.estimation.parameters import NAMES, SIZES
from sim.report.requirements.judge import Outcome
from sim.statistics.indices import INDICES

Cell = int | float | str | None

_LAST = ("rms_last_orbit", "max_last_orbit")


def _three(name: str) -> tuple[str, ...]:
    return tuple(f"{name}_{coil}" for coil in range(3))


def _parameters() -> Iterator[str]:
    for name in NAMES:
        for column in ("value", "sigma", "truth"):
            yield from (f"parameters_{name}_{column}_{place}" for place in range(SIZES[name]))


INDEX_FIGURES = tuple(f"{name}_deg_{figure}" for name in INDICES for figure in ("rms", "max"))
"""Of the counted part of a run, in addition to its summary."""

NUMBERS: tuple[str, ...] = (
    *("sim_seconds", "ticks", "slips", "orbits"),
    *("pulses_total", *_three("pulses_per_coil"), "pulses_refused"),
    *(*_three("duty_per_coil"), "duty_total"),
    *(*_three("min_gap_s_per_coil"), "min_gap_s_any", "min_gap_s_limited", "max_pulse_s", "limits_ok"),
    *(f"controlled_{figure}" for figure in (*_LAST, "settle_orbits")),
    *(f"pointing_deg_{figure}" for figure in ("final", *_LAST)),
    *(f"axis1_deg_{figure}" for figure in ("final", *_LAST, "mean_last_orbit", "settle_orbits_5deg")),
    *(f"rate_degps_{figure}" for figure in ("start", "final", "under_1_s", "under_0_1_s")),
    *INDEX_FIGURES,
    *(f"estimate_deg_{figure}" for figure in ("rms_sunlit", "rms_eclipse", "max", "within_3sigma")),
    *("converged_at_s", "nees_mean"),
    *(f"spin_radps_{figure}" for figure in ("reference", "mean_last_orbit", "max_dev_last_orbit")),
    *("spin_radps_settle_s_1e-3", "spin_radps_pulses_to_settle"),
    *("requirements_failed", "isolated_units", "event_count"),
    *_parameters(),
)
"""Figures of a run; NULL where a flight has none."""
TEXTS = ("mode_final", "isolated", "unsettled_causes", "unsettled_why")
"""Besides them: the causes for which it has not settled, by name, and in words; empty where it has."""
_OF_REQUIREMENTS = {"verdict": "TEXT", "measured": "REAL", "limit": "REAL"}
"""What a row holds of each requirement of the scenario, with its type in SQLite."""


def cells(summary: Mapping[str, Any]) -> dict[str, Cell]:
    """The figures of a summary by column; those that it does not have are absent."""
    flat = dict(_flat(summary))
    known = {name: flat[name] for name in (*NUMBERS, *TEXTS) if name in flat}
    units, outcomes = summary["isolated"], [one["verdict"] for one in summary["requirements"]]
    reasons = summary.get("diagnosis", {}).get("reasons", ())
    return {
        **known,
        # Without a judgement of each, nobody knows how many are missed: no limit on it is met then.
        "requirements_failed": None if Outcome.NOT_JUDGED in outcomes else outcomes.count(Outcome.FAILED),
        "isolated": ", ".join(units),
        "isolated_units": len(units),
        "unsettled_causes": ", ".join(reason["cause"] for reason in reasons),
        "unsettled_why": "; ".join(reason["text"] for reason in reasons),
    }


def requirement_kinds(count: int) -> dict[str, str]:
    """The columns of a scenario with so many requirements, each with its type in SQLite."""
    return {
        f"requirements_{number}_{key}": kind
        for number in range(count)
        for key, kind in _OF_REQUIREMENTS.items()
    }


def requirement_cells(summary: Mapping[str, Any], count: int) -> dict[str, Cell]:
    """Verdict, figure and limit of the first requirements of the scenario, by column."""
    return {
        f"requirements_{number}_{key}": one[key]
        for number, one in enumerate(summary["requirements"][:count])
        for key in _OF_REQUIREMENTS
    }


def input_cells(inputs: Mapping[str, Any]) -> dict[str, Cell]:
    """The drawn values by column, ``input_`` before the key."""
    return {f"input_{name}": value for name, value in _flat(inputs)}


def input_keys(inputs: Mapping[str, Any]) -> dict[str, str]:
    """The key of each drawn value by its column, elements as further parts of the key."""
    return {f"input_{key.replace('.', '_')}": key for key in _keys(inputs)}


def _keys(values: Mapping[Any, Any], prefix: str = "") -> Iterator[str]:
    for key, value in values.items():
        if isinstance(value, dict | list | tuple):
            below = value if isinstance(value, dict) else dict(enumerate(value))
            yield from _keys(below, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}"


def _flat(values: Mapping[Any, Any], prefix: str = "") -> Iterator[tuple[str, Cell]]:
    for key, value in values.items():
        name = prefix + str(key).replace(".", "_")
        if isinstance(value, dict):
            yield from _flat(value, f"{name}_")
        elif isinstance(value, list | tuple):
            yield from _flat(dict(enumerate(value)), f"{name}_")
        else:
            yield name, int(value) if isinstance(value, bool) else value
