"""Runs on an existing Dask cluster, which does all the distribution.

A task is a chunk of runs, and only some chunks are handed out at a time, so that the graph stays small
however many runs there are. A future is released as soon as its rows are stored.
"""

import logging
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from sim.campaign.code_digest import code_digest
from sim.campaign.one_run import RunTask, lost_run
from sim.campaign.results.store import RunRow
from sim.errors import FlightError, HarnessError, needing

CHUNKS_A_THREAD = 4
"""Handed out at a time, so that no worker waits for the next."""
LARGEST_CHUNK = 32
CONNECT_S = 10.0
WORKERS_S = 60.0


class ClusterLostError(FlightError):
    """The scheduler ended before the campaign did."""


@dataclass(frozen=True, slots=True)
class Cluster:
    """The workers of a Dask scheduler, given by its address or by its scheduler file."""

    scheduler: str

    def rows(self, task: RunTask, runs: Sequence[int]) -> Iterator[RunRow]:
        """The rows of the runs, chunk by chunk as they come.

        Raises:
            HarnessError: the package is missing, there is no scheduler, or a worker has other code.
            ClusterLostError: the scheduler ended.
        """
        with needing("--scheduler", "distributed", "cluster"):
            from distributed import Client  # noqa: PLC0415  an extra
        logging.getLogger("distributed.client").setLevel(logging.CRITICAL)  # a loss is a sentence here
        where = (
            {"scheduler_file": self.scheduler}
            if Path(self.scheduler).is_file()
            else {"address": self.scheduler}
        )
        try:
            client = Client(**where, timeout=CONNECT_S, set_as_default=False)
        except (OSError, ValueError) as error:
            raise HarnessError(
                f"--scheduler {self.scheduler}: no scheduler answers: {_first_line(error)}"
            ) from None
        with _closing(client):
            threads = self._ready(client)
            yield from self._chunks(client, task, runs, threads)

    def _ready(self, client: Any) -> int:  # noqa: ANN401  (of an extra)
        """The number of worker threads; every worker has this code."""
        try:
            client.wait_for_workers(1, timeout=WORKERS_S)
            versions = client.run(version, "torquer")
            digests = client.run(code_digest)
        except TimeoutError:
            raise HarnessError(
                f"--scheduler {self.scheduler}: it has had no worker for {WORKERS_S:.0f} s"
            ) from None
        except ImportError as error:
            raise HarnessError(f"--scheduler {self.scheduler}: a worker lacks torquer: {error}") from None
        ours = version("torquer")
        for worker, theirs in versions.items():
            if theirs != ours:
                raise HarnessError(f"--scheduler: {worker} has torquer {theirs}, and this is {ours}")
        for worker, digest in digests.items():
            if digest != code_digest():
                raise HarnessError(
                    f"--scheduler: {worker} has other code of torquer {ours} or of its libraries, of digest "
                    f"{digest}, this is {code_digest()}"
                )
        return sum(client.nthreads().values())

    def _chunks(
        self,
        client: Any,  # noqa: ANN401  (of an extra)
        task: RunTask,
        runs: Sequence[int],
        threads: int,
    ) -> Iterator[RunRow]:
        from distributed import CancelledError, KilledWorker, as_completed  # noqa: PLC0415  an extra
        from distributed.comm import CommClosedError  # noqa: PLC0415  an extra

        size = max(1, min(LARGEST_CHUNK, len(runs) // (CHUNKS_A_THREAD * threads)))
        chunks = iter([runs[first : first + size] for first in range(0, len(runs), size)])
        done = 0
        flying: dict[Any, Sequence[int]] = {}
        arriving = as_completed(loop=client.loop)

        def hand_out(chunk: Sequence[int] | None) -> None:
            if chunk is not None:
                future = client.submit(task.fly_all, chunk, pure=False)
                flying[future] = chunk
                arriving.add(future)

        try:
            for _ in range(CHUNKS_A_THREAD * threads):
                hand_out(next(chunks, None))
            for future in arriving:
                chunk = flying.pop(future)
                try:
                    rows = future.result()
                except KilledWorker as error:
                    if len(chunk) > 1:  # one of them is the cause: each by itself
                        for run in chunk:
                            hand_out([run])
                        continue
                    rows = [lost_run(task.campaign, chunk[0], error.allowed_failures + 1)]
                future.release()
                yield from rows
                done += len(rows)
                hand_out(next(chunks, None))
        except (CancelledError, CommClosedError):
            raise ClusterLostError(
                f"the scheduler {self.scheduler} was lost after {done} of {len(runs)} runs; what is done is "
                "kept, and the same command flies the rest"
            ) from None


@contextmanager
def _closing(client: Any) -> Iterator[None]:  # noqa: ANN401  (of an extra)
    try:
        yield
    finally:
        client.close(timeout=1.0)


def _first_line(error: BaseException) -> str:
    return (str(error) or type(error).__name__).splitlines()[0]
