"""Values of a scenario by dotted key, as in ``--set``; a number picks an element of a list."""

from collections.abc import Sequence
from copy import deepcopy
from typing import Any

from fsw.input.schema import Nested, merge
from sim.scenario.schema import Scenario, flight_table


def nominal_values(scenario: Scenario) -> Nested:
    """All values of a scenario, ``flight`` being its whole onboard table; without keys that are not set."""
    values = scenario.model_dump(mode="json", exclude_none=True)
    return {**values, "flight": flight_table(scenario).model_dump(mode="json", exclude_none=True)}


def value_at(values: Any, key: str) -> Any:  # noqa: ANN401  (any value of a scenario)
    """The value at a key; None where there is none."""
    for part in key.split("."):
        if isinstance(values, dict):
            values = values.get(part)
        elif isinstance(values, list) and part.isdigit() and int(part) < len(values):
            values = values[int(part)]
        else:
            return None
    return values


def with_value(overrides: Nested, nominal: Nested, key: str, value: object) -> Nested:
    """Overrides that set a key too; the other elements of a list that it picks from keep their values.

    Raises:
        ValueError: there is no such element.
    """
    parts = key.split(".")
    if not all(parts):
        raise ValueError(f"'{key}' is not a key: write for instance sensors.magnetometer.bias_nt")
    names = next((place for place, part in enumerate(parts) if part.isdigit()), len(parts))
    if names < len(parts):
        whole = ".".join(parts[:names])
        found = value_at(overrides, whole)
        found = deepcopy(value_at(nominal, whole) if found is None else found)
        _replace(found, parts[names:], value, key)
        value = found
    for part in reversed(parts[:names]):
        value = {part: value}
    assert isinstance(value, dict)
    return merge(overrides, value)


def _replace(within: Any, parts: Sequence[str], value: object, key: str) -> None:  # noqa: ANN401  (any value of a scenario)
    *way, last = parts
    for part in way:
        within = value_at(within, part)
    if value_at(within, last) is None:
        raise ValueError(f"the scenario has no element {key}")
    within[int(last) if isinstance(within, list) else last] = value
