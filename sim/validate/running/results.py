"""The page and the file of outcomes: of a run, or of all, with each study that is done."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from sim.campaign.claim import Claim
from sim.campaign.runner import StudyResult
from sim.console import say
from sim.result_files import write_result
from sim.validate.outcomes import Judges, Record, as_text, outdated, with_record
from sim.validate.page import render


@dataclass(slots=True)
class ResultFiles:
    """What is written of a run.

    Attributes:
        page: None: not written.
        figures: the file of outcomes; None: not written.
        studies: ids of all studies.
        judges: digests of the code that judges flights.
        claimed: claims that are made, by all studies that tell them beforehand, by their ids.
        before: what ``figures`` held of all studies, where the outcomes are put among those; None: it is to
            hold those of this run alone.
        done: the studies of this run that are done.
    """

    page: Path | None
    figures: Path | None
    studies: frozenset[str]
    judges: Judges
    claimed: Mapping[str, Claim] = field(default_factory=dict)
    before: Record | None = None
    done: list[StudyResult] = field(default_factory=list)

    def take(self, study: StudyResult, wall_s: float) -> None:
        """A study is done; where there are outcomes before, both files now have its own too.

        Raises:
            HarnessError: a file cannot be written.
        """
        self.done.append(study)
        if self.before is not None:
            known = with_record(self.before, self.done, self.studies, self.judges)
            outcomes, unknown = (
                [one.outcome for one in known.values()],
                sorted(self.claimed.keys() - known.keys()),
            )
            # no details: those of a part would stand for the whole
            self._write(
                known, render(outcomes, [], wall_s, outdated(known, self.claimed, self.judges), unknown)
            )

    def finish(self, finished: Sequence[StudyResult], wall_s: float) -> None:
        """All studies are done; say which files there are.

        Raises:
            HarnessError: a file cannot be written.
        """
        if self.before is None:
            known = with_record({}, finished, self.studies, self.judges)
            outcomes = [outcome for study in finished for outcome in study.outcomes]
            self._write(known, render(outcomes, finished, wall_s, outdated(known, self.claimed, self.judges)))
        for name, file in (("figures", self.figures), ("page", self.page)):
            if file is not None:
                say(f"{name}: {file}")

    def _write(self, known: Record, text: str) -> None:
        for file, content in ((self.figures, as_text(known)), (self.page, text)):
            if file is not None:
                write_result(file, content)  # outcomes of hours are not lost by a kill
