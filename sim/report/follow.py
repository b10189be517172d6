"""Replays a run in another process while it is being flown: on two processors that adds little time."""

import json
import os
import subprocess
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from fsw.input.own_code import given_as, is_running
from sim.errors import HarnessError
from sim.flight.sil import exit_text, start_node
from sim.record import run_dir
from sim.value_types import Json

Watch = Callable[[int], None]
Conclude = Callable[[Watch], Json]
"""Concludes the run, once it has been flown; called with what receives the number of replayed ticks."""

OVER = b"over\n"
"""Tells that process that the flight is over."""
LEAST_TICKS = 10_000
"""A shorter flight is replayed once it is over: a process takes a second to start."""


@contextmanager
def follow(path: Path, ticks: int, law: str | None = None) -> Iterator[Conclude]:
    """While a run that was begun is being flown, replay it in another process, where that pays.

    Args:
        path: the run directory.
        ticks: length of the flight.
        law: the user law that it flies; None: it flies one of the table.

    Yields:
        What concludes the run; it raises ``HarnessError`` as ``conclude`` does.
    """
    stays = law is not None and (given_as(law) is not None or is_running(law))  # no other process has it
    if stays or ticks < LEAST_TICKS or (os.cpu_count() or 1) < 2:
        from sim.report.conclude import conclude  # noqa: PLC0415 the flight does not need it

        yield lambda watch: conclude(path, watch, law)
        return
    pipe = subprocess.PIPE
    words = [str(path), *(() if law is None else ("--law", law))]
    process = start_node("sim.report.conclude_process", *words, stdin=pipe, stdout=pipe, stderr=pipe)
    try:
        yield lambda watch: _results(process, path, watch)
    finally:
        process.kill()
        process.communicate()


def _results(process: subprocess.Popen[bytes], path: Path, watch: Watch) -> Json:
    assert process.stdin is not None
    assert process.stdout is not None
    assert process.stderr is not None
    with suppress(BrokenPipeError):  # it has ended: its exit code says why
        process.stdin.write(OVER)
        process.stdin.flush()
    for line in process.stdout:
        watch(int(line))
    sentence = process.stderr.read().decode().strip()
    code = process.wait()
    if code:
        what = f"the process that replays the flight {exit_text(code)}: torquer report {path} concludes it"
        error = HarnessError(sentence.splitlines()[-1] if sentence else what)
        error.exit_code = max(code, 1)
        raise error
    summary: Json = json.loads((path / run_dir.SUMMARY).read_text(encoding="utf-8"))
    return summary
