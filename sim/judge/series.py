"""Many flights against one flight software: each judged, its files kept where something is wrong."""

import shutil
from collections.abc import Iterable, Iterator, Sequence
from enum import StrEnum
from pathlib import Path
from typing import NamedTuple

from sim.errors import HarnessError
from sim.fault_table.wrong_estimates import WRONG_DEG
from sim.judge.flight import JudgedFlight, SoftwareUnderTest, fly_and_judge
from sim.judge.render import failed_text, write_judgement
from sim.record.destination import check_folder
from sim.report.requirements.judge import Outcome
from sim.scenario.schema import Scenario
from sim.value_types import Json


class KeptFiles(StrEnum):
    """Of which flights of a series the run directories are kept."""

    FAILURES = "failures"
    ALL = "all"


class SeriesCase(NamedTuple):
    """A flight that is to be flown, or why it is not.

    Attributes:
        name: unique, the name of its run directory.
        scenario: what is flown; None: it does not apply.
        seed: of all random streams.
        why_not: why it does not apply.
        about: what is special in it, in words.
        honest_deg: as for ``fly_and_judge``.
    """

    name: str
    scenario: Scenario | None
    seed: int = 1
    why_not: str = ""
    about: str = ""
    honest_deg: float | None = WRONG_DEG


class JudgedCase(NamedTuple):
    """A case with what was judged; ``outcome`` is NOT_JUDGED where it does not apply."""

    case: SeriesCase
    outcome: Outcome
    text: str
    rules: dict[str, Outcome]
    requirements: Sequence[Json] = ()
    summary: Json | None = None
    path: Path | None = None

    @property
    def name(self) -> str:
        """Of the case."""
        return self.case.name


def fly_series(
    software: SoftwareUnderTest, cases: Iterable[SeriesCase], folder: Path, keep: KeptFiles
) -> Iterator[JudgedCase]:
    """Fly the cases one after the other, and judge each.

    Args:
        software: the flight software.
        cases: what to fly.
        folder: of the series; each flight has a folder of its own in it.
        keep: of which flights the files are kept.

    Raises:
        HarnessError: nothing can be flown, or there is a run of that name already.
        BusError: the bus cannot be used.
    """
    check_folder(folder)
    for case in cases:
        if case.scenario is None:
            yield JudgedCase(case, Outcome.NOT_JUDGED, case.why_not, {})
            continue
        path = folder / case.name
        if path.exists():
            raise HarnessError(f"{path} already holds a run: choose another --out")
        flight = fly_and_judge(software, case.scenario, case.seed, path, honest_deg=case.honest_deg)
        yield _judged(case, flight)
        if flight.ok and keep is KeptFiles.FAILURES:
            shutil.rmtree(path)
        else:
            write_judgement(flight)


def _judged(case: SeriesCase, flight: JudgedFlight) -> JudgedCase:
    return JudgedCase(
        case,
        Outcome.MET if flight.ok else Outcome.FAILED,
        failed_text(flight).removeprefix("the flight software failed: ") or _rates(flight),
        {one.name: one.outcome for one in flight.invariants},
        flight.requirements,
        flight.record.summary,
        flight.path,
    )


def _rates(flight: JudgedFlight) -> str:
    """How fast the body turned before and after, by the plant's truth."""
    rate = flight.record.summary.get("rate_degps")
    if rate is None:
        return "nothing is broken or missed"
    return f"{rate['start']:.3g} deg/s at the start, {rate['final']:.3g} at the end"
