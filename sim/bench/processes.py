"""The processes of a bench: hub, flight software and boards, started and ended together."""

import os
import select
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from tempfile import TemporaryFile
from types import TracebackType
from typing import IO, NamedTuple, Self

from fsw.bus.interface import BusError
from fsw.bus.link import LoopLink
from fsw.bus.open_bus import resolve

GRACE_S = 3.0
HUB_S = 30.0


@dataclass
class Node:
    """One process, and where its errors go."""

    name: str
    process: subprocess.Popen[bytes]
    errors: IO[bytes]

    @property
    def alive(self) -> bool:
        """Whether it still runs."""
        return self.process.poll() is None

    def said(self) -> str:
        """The last line of its errors."""
        self.errors.seek(0)
        lines = self.errors.read().decode(errors="replace").strip().splitlines()
        return lines[-1] if lines else "it said nothing"


class Nodes:
    """Starts nodes by name, and ends those that have not ended by themselves."""

    def __init__(self) -> None:
        self.by_name: dict[str, Node] = {}

    def start(self, name: str, *words: str, piped: bool = False) -> Node:
        """``python -m`` words, in the environment of this process; ``piped``: standard input is a pipe."""
        errors = TemporaryFile()  # noqa: SIM115  (open as long as the node)
        process = subprocess.Popen(
            [sys.executable, "-m", *words],
            env=_environment(),
            stdin=subprocess.PIPE if piped else subprocess.DEVNULL,
            stderr=errors,
            start_new_session=True,  # Ctrl-C is for this process, which ends its nodes itself
        )
        if process.stdin is not None:
            os.set_blocking(process.stdin.fileno(), False)
        self.by_name[name] = Node(name, process, errors)
        return self.by_name[name]

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for node in self.by_name.values():
            node.process.terminate()
        for node in self.by_name.values():
            wait_or_kill(node.process)
            if node.process.stdin is not None:
                node.process.stdin.close()
            node.errors.close()


class Served(NamedTuple):
    """A bus in full, and the process that serves it, if that was started for it."""

    spec: str
    hub_pid: int | None


@contextmanager
def hub_of(bus: str) -> Iterator[Served]:
    """The bus; a loop bus that nobody serves is served by a process of its own meanwhile.

    Raises:
        BusError: something else listens on the port of the loop bus.
    """
    spec = resolve(bus)
    if not spec.startswith("loop:"):
        yield Served(spec, None)
        return
    port = "0" if bus in ("loop", "auto") else spec.removeprefix("loop:")
    words = [sys.executable, "-m", "sim.bench.hub_process", port]
    hub = subprocess.Popen(
        words, env=_environment(), stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True
    )
    assert hub.stdin is not None
    assert hub.stdout is not None
    try:
        if not select.select((hub.stdout,), (), (), HUB_S)[0]:
            raise BusError(f"the hub of {bus} does not start: it has said nothing for {HUB_S:.0f} s")
        served = hub.stdout.readline().strip()
        if not served:  # somebody else serves it, or keeps the port for something else
            LoopLink(int(port), timeout_s=1.0, may_host=False).close()
        yield Served(f"loop:{served.decode()}", hub.pid) if served else Served(spec, None)
    finally:
        hub.stdin.close()  # it hands over what it has, and ends
        hub.stdout.close()
        wait_or_kill(hub)


def wait_or_kill(process: subprocess.Popen[bytes]) -> None:
    """Wait for a process that has been told to end; one that stands still is killed."""
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
