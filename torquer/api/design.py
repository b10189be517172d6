"""``torquer.design``: gains of the PD law by Floquet theory."""

from dataclasses import dataclass
from functools import cached_property
from math import log, pi
from os import PathLike
from pathlib import Path
from typing import Annotated

from pydantic import Field, Strict

from fsw.input.schema import Section
from sim.design.command import GainDesign
from sim.design.command import design as design_gains
from sim.design.render import NOISE, as_json, as_text
from sim.progress import shown
from sim.value_types import Json
from torquer.api.arguments import (
    ScenarioLike,
    Settings,
    checked,
    chosen_scenario,
    optional_path,
    path_text,
    warn_of,
)
from torquer.api.errors import one_sentence
from torquer.api.printed import PrintedResult

_Gain = Annotated[float, Field(allow_inf_nan=True)]
"""Judged with the natural gains of the body."""


class _GivenGains(Section):
    gains: Annotated[tuple[_Gain, _Gain], Strict(False)] | None


@dataclass(frozen=True)
class Design(PrintedResult):
    """Gains for a satellite, and how stable it is with them; ``print`` shows what the command prints.

    Attributes:
        found: the whole analysis as ``sim.design`` gives it.
    """

    found: GainDesign

    @cached_property
    def values(self) -> Json:
        """Everything, as ``torquer design --json`` prints it."""
        return as_json(self.found.analysis)

    @property
    def gains(self) -> dict[str, float]:
        """``k_w`` [N m s/T^2] and ``k_a`` [N m/T^2]: the best, or those given."""
        gains = self.found.analysis.chosen.gains
        return {"k_w": float(gains.k_w), "k_a": float(gains.k_a)}

    @property
    def degree_of_stability(self) -> float:
        """The largest of the exponents [1/rad]; negative is stable."""
        return float(self.found.analysis.chosen.degree)

    @property
    def exponents(self) -> tuple[float, ...]:
        """ln|multiplier| / (2 pi) of each characteristic multiplier above rounding noise [1/rad]."""
        moduli = abs(self.found.analysis.multipliers).tolist()
        return tuple(log(modulus) / (2.0 * pi) for modulus in moduli if modulus > NOISE)

    @property
    def ok(self) -> bool:
        """Gains were given, or the search has found some that stabilise."""
        return self.found.ok

    @property
    def pictures(self) -> tuple[Path, ...]:
        """The pictures that were drawn."""
        return self.found.pictures

    @property
    def written(self) -> Path | None:
        """The scenario file that has the gains now."""
        return self.found.written

    def __str__(self) -> str:
        return as_text(self.found.analysis, self.found.scenario)

    def __repr__(self) -> str:
        gains = ", ".join(f"{name}={gain:.6g}" for name, gain in self.gains.items())
        return f"<Design of {self.found.scenario.name}: {gains}>"


@one_sentence
def design(
    scenario: ScenarioLike,
    *,
    gains: tuple[float, float] | None = None,
    set: Settings | None = None,
    write: bool = False,
    out: str | PathLike[str] | None = None,
    progress: bool = False,
) -> Design:
    """Gains of the PD law m = -b x (k_w Omega + k_a S) by Floquet theory, as ``torquer design`` gives them.

    Args:
        scenario: name of a shipped scenario, path of a file, or a scenario.
        gains: k_w [N m s/T^2] and k_a [N m/T^2] that are to be judged; None: the best are searched.
        set: values laid over the scenario by key.
        write: write the gains into the scenario, which must be a file.
        out: folder of pictures and ``design.json``; None: nothing is drawn.
        progress: show progress on stderr.

    Raises:
        InputError: the scenario, a key, the gains or the folder.
    """
    given = checked(_GivenGains, "design", gains=gains).gains
    chosen = chosen_scenario(scenario, set)
    warn_of(chosen)
    file = path_text(scenario, "write: scenario") if write else None
    with shown(progress):
        return Design(design_gains(chosen, given, optional_path(out, "out"), file))
