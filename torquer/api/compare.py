"""``torquer.compare``: control laws side by side."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fsw.input.own_code import refuse_while_loading
from fsw.input.schema import TableError
from sim.compare import command
from sim.compare.command import ComparedLaws, CompareOptions
from sim.compare.score import Score
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
from torquer.api.errors import one_sentence, required
from torquer.api.laws import LawLike, law_given
from torquer.api.printed import PrintedResult

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Comparison(PrintedResult):
    """Control laws that were flown side by side; ``print`` shows what the command prints.

    Attributes:
        found: the whole of it, as ``sim.compare`` gives it.
    """

    found: ComparedLaws

    @property
    def path(self) -> Path:
        """The folder of the files."""
        return self.found.folder

    @property
    def page(self) -> Path:
        """The page with the errors over time."""
        return self.found.folder / command.PAGE

    @property
    def rows(self) -> tuple[Score, ...]:
        """The lines of the table, best first."""
        return tuple(self.found.scores)

    @cached_property
    @one_sentence
    def table(self) -> "pd.DataFrame":
        """A row a flight, best first, with the columns of ``compare.csv``. Needs ``torquer[data]``."""
        table: pd.DataFrame = required("pandas", "comparison.table").DataFrame(map(asdict, self.rows))
        return table

    @property
    def values(self) -> Mapping[str, Any]:
        """Everything, as in ``compare.json``."""
        return self.found.values

    @property
    def failures(self) -> tuple[str, ...]:
        """Limits that were broken, and laws that were asked for and could not be flown, a sentence each."""
        return tuple(self.found.complaints)

    @property
    def ok(self) -> bool:
        """There are no failures; how well a law does is none."""
        return not self.failures

    def __str__(self) -> str:
        return str(self.found)

    def __repr__(self) -> str:
        return f"<Comparison {self.path}: {len(self.rows)} flights>"


@one_sentence
def compare(
    scenario: ScenarioLike = "microsat",
    *,
    laws: str | Sequence[str] | None = None,
    driver: str = "both",
    gains: str | PathLike[str] = command.BEST,
    orbits: float | None = None,
    seed: int = 1,
    set: Settings | None = None,
    law: LawLike | None = None,
    workers: int | None = None,
    out: str | PathLike[str] | None = None,
    progress: bool = False,
) -> Comparison:
    """Fly control laws on a scenario, all else the same, as ``torquer compare`` does.

    Args:
        scenario: name of a shipped scenario, path of a file, or a scenario.
        laws: names of laws or aims, or ``all``; None: all that are meant for the body.
        driver: of the coils: ``pulsed``, ``continuous`` or ``both``.
        gains: ``best``, those found for the body that ship; ``scenario``, the scenario's; or a file of
            ``torquer design --laws``.
        orbits: of each flight; None: as the scenario says.
        seed: of all random streams.
        set: values laid over the scenario by key.
        law: a user law that is flown too: ``FILE.py:NAME``, an installed one by its name, or the
            law itself, a function or a ``ControlLaw``, which flies in this process, others beside it.
        workers: processes; None: one a core.
        out: folder of the files; None: ``compare/<scenario>-<UTC time>``.
        progress: show progress on stderr.

    Raises:
        InputError: an argument, the scenario, a key, or the folder; nothing was flown.
    """
    options = checked(
        CompareOptions,
        "compare",
        laws=_text_of(laws),
        driver=driver,
        gains=path_text(gains, "gains"),
        orbits=orbits,
        seed=seed,
        workers=workers,
    )
    refuse_while_loading("torquer.compare")
    with shown(progress), law_given(law) as named:
        return Comparison(
            command.compare(
                scenario_source(scenario), laid_over(set, named), options, optional_path(out, "out")
            )
        )


def _text_of(laws: str | Sequence[str] | None) -> str | None:
    """Names with commas between.

    Raises:
        TableError: they are no texts.
    """
    if laws is None or isinstance(laws, str):
        return laws
    if not isinstance(laws, Sequence) or not laws or not all(isinstance(law, str) for law in laws):
        raise TableError(f"compare: laws = {laws!r:.80}: give names such as ['pd', 'mpc']")
    return ",".join(laws)
