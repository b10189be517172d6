"""``python -m sim.report.conclude_process RUN``: the process that replays a run while it is being flown.

Its standard input receives ``OVER`` once the flight is over, or ends if the process that flies has ended.
From then on it writes to its standard output how many ticks it has replayed, a line every ``REPORT_S``.
"""

import os
import signal
import sys
import time
from pathlib import Path
from threading import Event, Thread

import click

from fsw.input import command_line
from fsw.input.error_text import error_text
from fsw.input.schema import TableError
from sim.errors import HarnessError
from sim.report.conclude import conclude_flight
from sim.report.follow import OVER

POLL_S = 0.02
REPORT_S = 0.2
"""How often the progress is written."""


class _Flight:
    """The flight that is followed."""

    def __init__(self) -> None:
        self._over = Event()
        self._last_look = False
        self._reported_s = 0.0
        Thread(target=self._await_end, daemon=True).start()

    def _await_end(self) -> None:
        # not by sys.stdin: a thread that waits in its buffer aborts the end of the process
        if os.read(sys.stdin.fileno(), len(OVER)) != OVER:
            os.kill(os.getpid(), signal.SIGTERM)
        self._over.set()

    def more(self) -> bool:
        """Whether to look for more in the log: while the flight goes on, and once after it."""
        if self._over.is_set():
            first, self._last_look = not self._last_look, True
            return first
        time.sleep(POLL_S)
        return True

    def tell(self, tick: int) -> None:
        """Write the tick, if it is waited for."""
        now_s = time.monotonic()
        if self._over.is_set() and now_s - self._reported_s > REPORT_S:
            self._reported_s = now_s
            click.echo(tick)


@click.command()
@click.argument("path", metavar="RUN", type=click.Path(path_type=Path))
@click.option("--law", help="The user law that the run flies.")
def main(path: Path, law: str | None) -> None:
    """Replay the run while it is being flown, and conclude it."""
    flight = _Flight()
    try:
        conclude_flight(path, flight.more, flight.tell, law)
    except (HarnessError, TableError) as error:
        click.echo(error_text(error), err=True)
        sys.exit(getattr(error, "exit_code", 2))


if __name__ == "__main__":
    sys.exit(command_line.run(main, "sim.report.conclude_process"))
