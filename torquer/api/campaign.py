"""``torquer.campaign``: many runs of a scenario, dispersed."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fsw.input.own_code import refuse_while_loading
from sim.campaign import command
from sim.campaign.command import PAGE, CampaignOptions, FlownCampaign, campaign_run
from sim.campaign.report.documents import as_json
from sim.campaign.report.text import lines
from sim.progress import shown
from sim.scenario.settings import nested
from torquer.api.arguments import Settings, checked, optional_path, path_text
from torquer.api.errors import one_sentence
from torquer.api.flight import fly
from torquer.api.printed import PrintedResult
from torquer.api.run import Run

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class CampaignRuns(PrintedResult):
    """A campaign whose runs have been flown; ``print`` shows what the command prints.

    Attributes:
        flown: the whole of it, as ``sim.campaign`` gives it.
    """

    flown: FlownCampaign

    @property
    def path(self) -> Path:
        """The folder, with which ``torquer.campaign`` flies what is missing or more runs."""
        return self.flown.folder

    @property
    def page(self) -> Path:
        """The page with the statistics in pictures."""
        return self.flown.folder / PAGE

    @property
    def ok(self) -> bool:
        """Every run was flown and kept the limits of the coils; no requirement of the campaign is missed."""
        return self.flown.ok

    @property
    def failures(self) -> Mapping[int, str]:
        """Why runs have no result, by their number."""
        return self.flown.analysis.failures

    @cached_property
    def statistics(self) -> Mapping[str, Any]:
        """Part of the runs that succeed, percentiles of the figures, pointing indices, rank correlations.

        Each with its bounds, of the confidence that the campaign states; None where there are too few runs.
        """
        return as_json(self.flown.campaign, self.flown.analysis)

    @cached_property
    @one_sentence
    def results(self) -> "pd.DataFrame":
        """A row a run, with status, seed, drawn values as ``input_KEY``, figures. Needs ``torquer[data]``."""
        from torquer.api.datasets import results  # noqa: PLC0415  an extra

        return results(self.path)

    @one_sentence
    def fly(
        self,
        run: int,
        *,
        bus: str = "virtual",
        out: str | PathLike[str] | None = None,
        progress: bool = False,
    ) -> Run:
        """Fly a run again, equal bit for bit, into a directory with log, histories and report."""
        drawn = campaign_run(self.path, run)
        return fly(drawn.scenario, seed=drawn.seed, bus=bus, out=out, progress=progress)

    def __str__(self) -> str:
        return "\n".join(lines(self.flown.campaign, self.flown.analysis))

    def __repr__(self) -> str:
        return f"<CampaignRuns {self.path}: {self.flown.analysis.done} runs>"


@one_sentence
def campaign(
    source: str | PathLike[str],
    *,
    runs: int | None = None,
    orbits: float | None = None,
    seed: int | None = None,
    set: Settings | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    keep: str = "none",
    retry: bool = False,
    parquet: bool = False,
    out: str | PathLike[str] | None = None,
    progress: bool = False,
) -> CampaignRuns:
    """Fly many runs, as ``torquer campaign`` does; the same call with the same ``out`` flies what is missing.

    Args:
        source: a campaign file, a scenario whose runs differ by seed alone, or the folder of a campaign.
        runs: how many; None: those of the file, 100 of a scenario.
        orbits: of each run; None: as the file says.
        seed: of all random streams; None: as the file says, else 1.
        set: values laid over the scenario of all runs by key.
        workers: processes; None: one a core.
        scheduler: address or file of a Dask cluster to fly on instead.
        keep: the runs whose log and histories are kept in ``runs`` of the folder: none, failures or all.
        retry: fly runs that failed again.
        parquet: write ``results.parquet`` too.
        out: folder; None: ``campaigns/<name>-<UTC time>``.
        progress: show progress on stderr.

    Raises:
        InputError: an argument, the file, a key, or the folder.
        Error: the results can no longer be written.
    """
    refuse_while_loading("torquer.campaign")
    options = checked(
        CampaignOptions,
        "campaign",
        workers=workers,
        scheduler=scheduler,
        keep=keep,
        retry=retry,
        parquet=parquet,
    )
    given = nested({"runs": runs, "orbits": orbits, "seed": seed})
    over = {name: value for name, value in given.items() if value is not None}
    with shown(progress):
        flown = command.campaign(
            path_text(source, "source"),
            over,
            nested(set),
            options,
            optional_path(out, "out"),
        )
    return CampaignRuns(flown)
