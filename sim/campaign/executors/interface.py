"""What flies the runs of a campaign."""

from collections.abc import Iterator, Sequence
from typing import Protocol

from sim.campaign.one_run import RunTask
from sim.campaign.results.row import RunRow


class Executor(Protocol):
    """Flies runs somewhere. A run may be flown again when its worker is lost; its row comes once."""

    def rows(self, task: RunTask, runs: Sequence[int]) -> Iterator[RunRow]:
        """The rows of the runs, each as it is done, in any order.

        Raises:
            HarnessError: the executor itself is lost; runs without a row can be flown by another.
        """
