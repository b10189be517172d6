"""User effects in a scenario: ``[[effect]]`` names their source and gives their parameters."""

import re
from collections.abc import Sequence
from dataclasses import is_dataclass
from pathlib import Path
from typing import Annotated

from pydantic import Field, Strict

from fsw.input import own_code
from fsw.input.quantities import with_values
from fsw.input.schema import Nested, Section, TableError
from sim.plant.own_effects import ACTIONS, NO_EFFECTS, OwnEffect, OwnEffects

GROUP = "torquer.effects"
"""Group of the entry points by which installed packages offer effects."""


class EffectSection(Section):
    """One effect: ``FILE.py:NAME`` or an entry point, the digest of its source, its parameters."""

    use: str = Field(max_length=1000)
    sha256: str | None = Field(default=None, pattern="^[0-9a-f]{64}$")
    parameters: dict[str, float] = Field(default_factory=dict)


MOST = 8
LONGEST_NAME = 30

Effects = Annotated[tuple[EffectSection, ...], Strict(False), Field(max_length=MOST)]


def with_digests(values: Nested, folder: Path) -> Nested:
    """The values of a scenario in which effects have absolute paths and digests; nothing is executed.

    Raises:
        TableError: a source cannot be read, or is not installed.
    """
    entries = values.get("effect")
    if not isinstance(entries, list | tuple):
        return values
    return {**values, "effect": [_with_digest(entry, folder) for entry in entries]}


def own_effects(sections: Sequence[EffectSection] | None, with_cells: bool = False) -> OwnEffects:
    """The effects of a scenario; their sources are executed.

    Args:
        sections: of the scenario.
        with_cells: its satellite has Sun cells in place of the Sun sensor.

    Raises:
        TableError: one cannot be loaded, is not an effect, acts on a sensor that is not there, or a parameter
            is not allowed.
    """
    if not sections:
        return NO_EFFECTS
    return OwnEffects(
        [
            OwnEffect(
                f"own_{number}_{_snake(own_code.short_name(section.use))}",
                own_code.display(section.use),
                _effect(section, f"effect.{number}.parameters", with_cells),
            )
            for number, section in enumerate(sections)
        ]
    )


def _snake(name: str) -> str:
    """A name as the histories have it: ``GasLeak`` becomes ``gas_leak``."""
    words = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()
    return re.sub(r"[^a-z0-9_]", "_", words)[:LONGEST_NAME]


def _effect(section: EffectSection, key: str, with_cells: bool) -> object:
    kind = own_code.load(section.use, section.sha256, GROUP)
    if not isinstance(kind, type) or not is_dataclass(kind):
        raise TableError(f"{section.use} is no effect: not a frozen dataclass")
    if not any(callable(getattr(kind, action, None)) for action in ACTIONS):
        raise TableError(f"{section.use} is no effect: it has none of {', '.join(ACTIONS)}")
    if with_cells and callable(getattr(kind, "sun_body", None)):
        raise TableError(
            f"{section.use}: its sun_body acts on the Sun sensor, in whose place there is sensors.cells"
        )
    return with_values(kind, section.parameters, key, section.use)


def _with_digest(entry: object, folder: Path) -> object:
    use = entry.get("use") if isinstance(entry, dict) else None
    if not isinstance(entry, dict) or not isinstance(use, str) or "sha256" in entry:
        return entry
    found = own_code.find(use, folder, GROUP)
    if found is None:
        raise TableError(f"effect: {use!r} is neither FILE.py:NAME nor the entry point of a package")
    return {**entry, "use": found.reference, "sha256": found.sha256}
