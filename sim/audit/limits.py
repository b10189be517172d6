"""The auditor's own reading of a scenario's limits.

Scheduler and boards take theirs from the checked table (``fsw.table.config``, ``sim.scenario.assemble``).
The auditor reads the plain keys again, on purpose by code of its own: a mistake in either reading shows as a
violation and is not shared.
"""

from collections.abc import Mapping

from sim.audit.findings import AuditLimits
from sim.errors import HarnessError


def limits_in(tables: Mapping[str, object], source: str) -> AuditLimits:
    """The limits in the tables ``coils`` and ``time`` of a scenario; default ones for keys without a value.

    Args:
        tables: the scenario as it stands in its TOML file, unchecked.
        source: where it is from, for the sentence of an error.

    Raises:
        HarnessError: one of the limits makes no sense.
    """
    coils, time = _table(tables, "coils", source), _table(tables, "time", source)
    return AuditLimits(
        pulse_us=_microseconds(coils.get("pulse_s", 3.0), f"{source}: coils.pulse_s"),
        backoff_us=_microseconds(coils.get("backoff_s", 100.0), f"{source}: coils.backoff_s"),
        shared=is_shared(coils.get("backoff", "shared"), f"{source}: coils.backoff"),
        tick_hz=_tick_hz(time.get("tick_hz"), f"{source}: time.tick_hz"),
        on_fraction=_on_fraction(coils, source),
    )


def is_shared(backoff: object, where: str) -> bool:
    """Whether a pulse of any coil begins the back-off of all.

    Raises:
        HarnessError: it is neither ``"shared"`` nor ``"per_coil"``; the sentence begins with ``where``.
    """
    if backoff not in ("shared", "per_coil"):
        raise HarnessError(f"{where} is {backoff!r}, not 'shared' or 'per_coil'")
    return backoff == "shared"


def _table(tables: Mapping[str, object], name: str, source: str) -> dict[str, object]:
    table = tables.get(name, {})
    if not isinstance(table, dict):
        raise HarnessError(f"{source}: {name} is not a table")
    return table


def _microseconds(value: object, where: str) -> int:
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0 <= value < 1e9:
        raise HarnessError(f"{where} is {value!r}, not a time in seconds")
    return round(value * 1_000_000)


def _on_fraction(coils: dict[str, object], source: str) -> float | None:
    """The part of a tick for which a continuous driver drives; None of a pulsed driver."""
    driver, value = coils.get("driver", "pulsed"), coils.get("on_fraction", 0.8)
    if driver not in ("pulsed", "continuous"):
        raise HarnessError(f"{source}: coils.driver is {driver!r}, not 'pulsed' or 'continuous'")
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0 < value <= 1:
        raise HarnessError(f"{source}: coils.on_fraction is {value!r}, not a part of a tick")
    return float(value) if driver == "continuous" else None


def _tick_hz(value: object, where: str) -> int | None:
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= 1_000_000:
        raise HarnessError(f"{where} is {value!r}, not a whole number of ticks a second")
    return value
