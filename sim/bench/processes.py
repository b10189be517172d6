"""The processes of a bench: hub, flight software and boards, started and ended together."""

import os
import select
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryFile
from types import TracebackType
from typing import IO, NamedTuple, Self

from fsw.bus.interface import BusError
from fsw.bus.link import LoopLink
from fsw.bus.open_bus import resolve

GRACE_S = 3.0
HUB_S = 30.0


@dataclass
class BenchProcess:
    """One process, and the file that its errors go to.

    ``may_end``: the end of the flight is near, which a user's flight software ends with.
    """

    name: str
    popen: subprocess.Popen[bytes]
    errors: IO[bytes]
    may_end: bool = False

    @property
    def alive(self) -> bool:
        """Whether it still runs."""
        return self.popen.poll() is None

    @property
    def is_lost(self) -> bool:
        """Whether it has ended, but for one that may and has no error."""
        return not self.alive and not (self.may_end and self.popen.returncode == 0)

    def last_error(self) -> str:
        """Why it has ended: a signal, which leaves no error, else the last line of its errors."""
        code = self.popen.poll()
        if code is not None and code < 0:
            return f"by signal {-code} ({signal.strsignal(-code)})"
        self.errors.seek(0)
        lines = self.errors.read().decode(errors="replace").strip().splitlines()
        return lines[-1] if lines else "without an error message"


class BenchProcesses:
    """Starts processes by name, and ends those that have not ended by themselves."""

    def __init__(self) -> None:
        self.by_name: dict[str, BenchProcess] = {}

    def start(self, name: str, *arguments: str, piped: bool = False) -> BenchProcess:
        """Start ``python -m`` with these arguments; ``piped``: standard input is a pipe."""
        errors = TemporaryFile()  # noqa: SIM115  (open as long as the process)
        popen = subprocess.Popen(
            [sys.executable, "-m", *arguments],
            env=_environment(),
            stdin=subprocess.PIPE if piped else subprocess.DEVNULL,
            stderr=errors,
            start_new_session=True,  # Ctrl-C is for this process, which ends its nodes itself
        )
        if popen.stdin is not None:
            os.set_blocking(popen.stdin.fileno(), False)
        self.by_name[name] = BenchProcess(name, popen, errors)
        return self.by_name[name]

    def take(self, name: str, popen: subprocess.Popen[bytes], output: Path) -> BenchProcess:
        """Take a process that was started elsewhere, and writes into a file, among these."""
        self.by_name[name] = BenchProcess(name, popen, output.open("rb"))
        return self.by_name[name]

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for process in self.by_name.values():
            process.popen.terminate()
        for process in self.by_name.values():
            wait_or_kill(process.popen)
            if process.popen.stdin is not None:
                process.popen.stdin.close()
            process.errors.close()


class ServedBus(NamedTuple):
    """A bus in full, and the process that serves it, if that was started for it."""

    spec: str
    hub_pid: int | None


@contextmanager
def hub_of(bus: str) -> Iterator[ServedBus]:
    """The bus; a loop bus without a hub is served by a process of its own meanwhile.

    Raises:
        BusError: something else listens on the port of the loop bus.
    """
    spec = resolve(bus)
    if not spec.startswith("loop:"):
        yield ServedBus(spec, None)
        return
    port = "0" if bus in ("loop", "auto") else spec.removeprefix("loop:")
    arguments = [sys.executable, "-m", "sim.bench.hub_process", port]
    hub = subprocess.Popen(
        arguments, env=_environment(), stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True
    )
    assert hub.stdin is not None
    assert hub.stdout is not None
    try:
        if not select.select((hub.stdout,), (), (), HUB_S)[0]:
            raise BusError(f"the hub of {bus} does not start: no answer for {HUB_S:.0f} s")
        port_text = hub.stdout.readline().strip()
        if not port_text:  # another hub serves it, or something else listens on the port
            LoopLink(int(port), timeout_s=1.0, may_host=False).close()
        yield ServedBus(f"loop:{port_text.decode()}", hub.pid) if port_text else ServedBus(spec, None)
    finally:
        hub.stdin.close()  # it forwards what it has, and ends
        hub.stdout.close()
        wait_or_kill(hub)


def wait_or_kill(process: subprocess.Popen[bytes]) -> None:
    """Wait for a process that was asked to end; one that does not react is killed."""
    try:
        process.wait(GRACE_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def _environment() -> dict[str, str]:
    return {
        **os.environ,
        "PYTHONPATH": os.pathsep.join(sys.path),
        "PYTHONSAFEPATH": "1",  # not what lies in this directory
        "OPENBLAS_NUM_THREADS": "1",
    }
