"""``torquer.phasing``: which way coils and magnetometer are wired."""

from collections.abc import Sequence
from os import PathLike
from typing import Annotated

from pydantic import Field, Strict

from fsw.input.schema import Section, Triple
from sim.commissioning.phasing.command import PhasingOptions, phase
from sim.progress import shown
from torquer.api.arguments import (
    ScenarioLike,
    Settings,
    checked,
    laid_over,
    optional_path,
    path_text,
    scenario_source,
)
from torquer.api.errors import one_sentence
from torquer.api.printed import CommissioningResult


class _GivenPhasing(Section):
    bus: str | None
    real: Annotated[tuple[str, ...], Strict(False)] | None
    arm: bool
    at_rest: bool
    rounds: int | None = Field(ge=1, le=100)
    field_nt: Triple | None
    offset_nt: float | None = Field(ge=0.0, le=1e5)
    coil_field_nt_per_am2: float | None
    seed: int | None = Field(ge=0, le=2**64 - 1)


class WiringVerdict(CommissioningResult):
    """How coils and magnetometer are wired; ok where that is determined, and is what the table says.

    Of a recorded bench log, which tells no axis, ok where a reading responds to a command.
    """

    @property
    def verdict(self) -> str | None:
        """What is wired how, or that it cannot be determined, in one sentence; None of a bench log."""
        sentence: str | None = self.values.get("verdict")
        return sentence

    @property
    def pairs(self) -> tuple[tuple[tuple[int, ...], tuple[int, ...]], ...]:
        """Wirings of magnetometer and coils, signed axes, that fit alike; one where the wiring is known."""
        found = self.values.get("pairs", ())
        return tuple((tuple(pair["magnetometer"]), tuple(pair["coils"])) for pair in found)


@one_sentence
def phasing(
    source: ScenarioLike,
    *,
    scenario: str | PathLike[str] | None = None,
    set: Settings | None = None,
    bus: str | None = None,
    real: str | Sequence[str] | None = None,
    arm: bool = False,
    at_rest: bool = False,
    rounds: int | None = None,
    field_nt: tuple[float, float, float] | None = None,
    offset_nt: float | None = None,
    coil_field_nt_per_am2: float | None = None,
    seed: int | None = None,
    out: str | PathLike[str] | None = None,
    progress: bool = False,
) -> WiringVerdict:
    """Which way coils and magnetometer are wired, from pulses of each coil, as ``torquer phasing`` tells it.

    Args:
        source: a scenario, in which the pulses are commanded; or a run, a log or a recorded bench log, CSV.
        scenario: of a log that has none beside it.
        set: values laid over the scenario by key.
        bus: of a bench, on which the scenario is run; None: it is flown in simulation.
        real: boards of the bench that are hardware: coil, magnetometer, sun.
        arm: let coils be driven on the bench.
        at_rest: a log is of a bench: the satellite did not move.
        rounds: pulses of each polarity; None: 1.
        field_nt: field around the bench [nT], body axes.
        offset_nt: largest offset of the magnetometer [nT], by axis; None: 1000.
        coil_field_nt_per_am2: field of each coil at the magnetometer, along its axis; None: the table's.
        seed: of the plant; None: 1.
        out: keep the run in this folder.
        progress: show progress on stderr.

    Raises:
        InputError: an argument that would do nothing, no such source, or a bus that cannot be used.
    """
    given = checked(
        _GivenPhasing,
        "phasing",
        bus=bus,
        real=real.split(",") if isinstance(real, str) else real,
        arm=arm,
        at_rest=at_rest,
        rounds=rounds,
        field_nt=field_nt,
        offset_nt=offset_nt,
        coil_field_nt_per_am2=coil_field_nt_per_am2,
        seed=seed,
    )
    options = PhasingOptions(
        None if scenario is None else path_text(scenario, "scenario"),
        laid_over(set),
        **given.model_dump(exclude={"real"}),
        real=None if given.real is None else ",".join(given.real),
        out=optional_path(out, "out"),
    )
    with shown(progress):
        return WiringVerdict(phase(scenario_source(source), options))
