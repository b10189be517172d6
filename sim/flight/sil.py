"""Software in the loop: plant and flight software as two processes on a bus."""

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory

from fsw.bus.hub_listener import listen
from fsw.bus.interface import Bus
from fsw.bus.link import LoopLink
from fsw.bus.open_bus import open_bus, resolve
from sim.errors import FlightError
from sim.flight.bus_in_use import ALL_NODES, refuse_bus_in_use
from sim.flight.flight_loop import ProgressCallback
from sim.flight.fsw_answers import ANSWER_TIMEOUT_S, Patience
from sim.flight.second_senders import describe_senders
from sim.record import run_dir
from sim.record.candump import last_lines
from sim.scenario.schema import Scenario
from sim.scenario.written import write_flight_table

# --- Detects a stalled flight from outside: its log does not grow


class StallDetector:
    """Observes a log that another process writes.

    Args:
        path: the run directory.
        first_s: longest time until its first line [s].
        next_s: longest time between two of its lines [s].
    """

    def __init__(self, path: Path, first_s: float, next_s: float) -> None:
        self._path = path
        self._first_s = first_s
        self._next_s = next_s
        self._size = -1
        self._since = time.monotonic()

    def stalled_s(self) -> float:
        """The time for which nothing has been written [s]; 0 while it is within the limit."""
        try:
            size = run_dir.bus_log(self._path).stat().st_size
        except OSError:
            size = -1
        now = time.monotonic()
        if size != self._size:
            self._size, self._since = size, now
        quiet_s = now - self._since
        return quiet_s if quiet_s > (self._next_s if size > 0 else self._first_s) else 0.0


PROJECT = str(Path(__file__).parents[2])
"""The folder that holds the packages of torquer."""
POLL_S = 0.1
GRACE_S = 5.0
PATIENCE = Patience(boot_s=60.0, answer_s=ANSWER_TIMEOUT_S, silence_s=ANSWER_TIMEOUT_S)
MARGIN_S = 5.0
"""Time beyond the plant's own deadlines after which the plant itself counts as stalled."""


@contextmanager
def serve_bus(bus: str, others: frozenset[str] = ALL_NODES) -> Iterator[tuple[str, socket.socket | None]]:
    """A bus for two processes: its full spec, and the listener of a loop bus that the plant is to host.

    Args:
        bus: as the user wrote it.
        others: nodes that must not be on it yet, where another process has opened it.

    Raises:
        BusError: the bus cannot be used, or is in use by another flight.
    """
    spec = resolve(bus)
    if not spec.startswith("loop:"):
        _refuse_in_use(open_bus(spec), spec, others)
        yield spec, None
        return
    port = int(spec.removeprefix("loop:"))
    try:
        listener = listen(0 if bus in ("loop", "auto") else port)
    except OSError:  # another process hosts it, or uses the port for something else
        _refuse_in_use(LoopLink(port, may_host=False), spec, others)
        yield spec, None
        return
    with listener:
        yield f"loop:{listener.getsockname()[1]}", listener


def _refuse_in_use(bus: Bus, spec: str, others: frozenset[str]) -> None:
    try:
        refuse_bus_in_use(bus, spec, others)
    finally:
        bus.close()


def fly_processes(
    path: Path,
    scenario: Scenario,
    spec: str,
    listener: socket.socket | None,
    watch: ProgressCallback,
    patience: Patience = PATIENCE,
) -> None:
    """Fly with plant and flight software as two processes on a bus, as ``serve_bus`` gives it.

    Raises:
        FlightError: one of the two ended too early or is stalled; both have been ended.
    """
    with TemporaryDirectory() as scratch:
        table = write_flight_table(Path(scratch), scenario)
        plant, fsw = _start_nodes(
            spec, listener, _plant_words(path, patience), ("fsw", "--table", str(table))
        )
        oversee(path, scenario, {"plant": plant, "flight software": fsw}, watch, patience)


def fly_against(
    path: Path,
    scenario: Scenario,
    spec: str,
    listener: socket.socket | None,
    watch: ProgressCallback,
    patience: Patience,
    start: Callable[[], subprocess.Popen[bytes]] | None,
) -> None:
    """Fly the plant as a process, against a flight software that ``start`` starts, or that runs already.

    Whatever it does once the flight has been flown is its own affair.

    Raises:
        FlightError: the plant or that process ended too early or is stalled; what was started has been ended.
        OSError: the flight software cannot be started.
    """
    words = (*_plant_words(path, patience), "--bus", spec, "--parent", str(os.getpid()))
    if listener is not None and os.name != "posix":
        listener.close()
        listener = None
    if listener is None:
        plant = start_node(*words)
    else:
        with listener:
            plant = start_node(*words, "--host", str(listener.fileno()), pass_fds=(listener.fileno(),))
    try:
        nodes = {"plant": plant} | ({} if start is None else {"flight software": start()})
    except OSError:
        _end((plant,))
        raise
    oversee(path, scenario, nodes, watch, patience, flown_is_enough=True)


def oversee(
    path: Path,
    scenario: Scenario,
    nodes: Mapping[str, subprocess.Popen[bytes]],
    watch: ProgressCallback,
    patience: Patience,
    flown_is_enough: bool = False,
) -> None:
    """Wait until the nodes of a flight have ended, and end those that do not.

    Args:
        path: the run directory, into which the plant writes.
        scenario: of the flight.
        nodes: the processes by their names.
        watch: called with the tick now and then.
        patience: of the plant.
        flown_is_enough: how the others end does not matter once the plant has flown.

    Raises:
        FlightError: one ended too early or is stalled.
    """
    processes = tuple(nodes.values())
    stall = _stall_detector(path, scenario, patience)
    stalled_s = 0.0
    try:
        while all(node.poll() is None for node in processes) and not (stalled_s := stall.stalled_s()):
            time.sleep(POLL_S)
            watch(last_tick(path, scenario))
        deadline = time.monotonic() + (0.0 if stalled_s else GRACE_S)
        while (
            any(node.poll() is None for node in processes)
            and time.monotonic() < deadline
            and _no_failure(*processes)
        ):
            time.sleep(POLL_S / 10.0)
    finally:
        failed = [(name, node) for name, node in nodes.items() if node.poll()]
        _end(processes)
    run = run_dir.read_run(path)
    if "flown" in run and (not failed or flown_is_enough):
        return
    tick = last_tick(path, scenario)
    name, process = failed[0] if failed else list(nodes.items())[-1]
    why = run.get("ended") or f"the {name} {exit_text(process.returncode)} at tick {tick}"
    if stalled_s:
        why = f"the plant is stalled: its log has not grown for {stalled_s:.0f} s after tick {tick}"
    if run.get("second_senders"):
        why += f"; {describe_senders(run['second_senders'])}"
    raise FlightError(f"{why}: the run is not complete, its files are in {path}")


def _plant_words(path: Path, patience: Patience) -> tuple[str, ...]:
    waits = (str(patience.boot_s), str(patience.answer_s))
    return ("sim.flight.plant_process", str(path), "--patience", *waits)


def _start_nodes(
    spec: str, listener: socket.socket | None, plant: Sequence[str], fsw: Sequence[str]
) -> tuple[subprocess.Popen[bytes], subprocess.Popen[bytes]]:
    """Start plant and flight software; the plant hosts the loop bus of ``listener``, which is closed here.

    Between the two is a pair of sockets: half as long a way as over TCP. Where no process inherits
    sockets, the first to open the bus hosts it.
    """
    common = ("--bus", spec, "--parent", str(os.getpid()))
    if listener is not None and os.name != "posix":
        listener.close()
        listener = None
    if listener is None:
        return start_node(*plant, *common), start_node(*fsw, *common)
    ends = socket.socketpair()
    with listener, ends[0], ends[1]:
        hosted, joined = (listener.fileno(), ends[0].fileno()), (ends[1].fileno(),)
        host, end = ("--host", str(hosted[0]), "--host", str(hosted[1])), ("--end", *map(str, joined))
        started = start_node(*plant, *common, *host, pass_fds=hosted)
        return started, start_node(*fsw, *common, *end, pass_fds=joined)


def _stall_detector(path: Path, scenario: Scenario, patience: Patience) -> StallDetector:
    factor = run_dir.read_run(path)["pace_factor"]
    two_ticks_s = 2.0 / (scenario.time.tick_hz * factor) if factor else 0.0
    longest_s = patience.answer_s + MARGIN_S + two_ticks_s
    return StallDetector(path, patience.boot_s + MARGIN_S, longest_s)


def last_tick(path: Path, scenario: Scenario) -> int:
    """The tick of the last line in the log so far; 0 while there is none."""
    stamps = [line[1:].partition(b")")[0] for line in last_lines(run_dir.bus_log(path))]
    if not stamps:
        return 0
    return round((float(stamps[-1]) - scenario.epoch_unix_s) * scenario.time.tick_hz)


def start_node(module: str, *arguments: str, **pipes: int | Sequence[int]) -> subprocess.Popen[bytes]:
    """Start a node as a process of the same code. Ctrl-C reaches this process only, which ends its nodes.

    Its packages are found where this process has found them, whatever the current directory holds.

    ``pipes``: of ``stdin``, ``stdout``, ``stderr`` and ``pass_fds``, as ``subprocess`` takes them.
    """
    words = [sys.executable, "-m", module, *arguments]
    folders = [*filter(None, sys.path), PROJECT]
    path = {"PYTHONPATH": os.pathsep.join(folders), "PYTHONSAFEPATH": "1"}
    environment = {**os.environ, **path, "OPENBLAS_NUM_THREADS": "1"}
    popen: subprocess.Popen[bytes] = subprocess.Popen(
        words,
        env=environment,
        start_new_session=True,
        **pipes,  # type: ignore[call-overload]  # one of four keys
    )
    return popen


def _no_failure(*processes: subprocess.Popen[bytes]) -> bool:
    return all(process.poll() in (None, 0) for process in processes)


def _end(processes: Sequence[subprocess.Popen[bytes]]) -> None:
    """Terminate processes that still run, with time to close their files; then kill them."""
    for process in processes:
        process.terminate()
    deadline = time.monotonic() + GRACE_S
    while any(process.poll() is None for process in processes) and time.monotonic() < deadline:
        time.sleep(POLL_S / 10.0)
    for process in processes:
        process.kill()
        process.wait()
        _end_group(process.pid)


def _end_group(pid: int) -> None:
    """End what a node has left behind in its group, such as the program that a shell has started."""
    if os.name == "posix":
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(pid, signal.SIGKILL)


def exit_text(code: int | None) -> str:
    """How a process ended, as the end of a sentence."""
    if code is not None and code < 0:
        return f"was ended by signal {-code}"
    return f"ended with exit code {code}"
