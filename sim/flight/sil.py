"""Software in the loop: plant and flight software as two processes on a bus."""

import os
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from fsw.bus.hub import Hub
from fsw.bus.interface import Bus
from fsw.bus.link import LoopLink
from fsw.bus.open_bus import open_bus, resolve
from sim.errors import FlightError
from sim.flight.bus_in_use import refuse_bus_in_use
from sim.flight.flight_loop import ProgressCallback
from sim.flight.fsw_answers import ANSWER_TIMEOUT_S, Patience
from sim.flight.second_senders import describe_senders
from sim.flight.stall_detector import StallDetector
from sim.flight.table_file import write_flight_table
from sim.record import run_dir
from sim.record.candump import last_lines
from sim.scenario.schema import Scenario

HOUSE = str(Path(__file__).parents[2])
"""The folder that holds the packages of torquer."""
POLL_S = 0.1
GRACE_S = 5.0
PATIENCE = Patience(boot_s=60.0, answer_s=ANSWER_TIMEOUT_S, silence_s=ANSWER_TIMEOUT_S)
MARGIN_S = 5.0
"""Time beyond the plant's own deadlines after which the plant itself counts as stalled."""


@contextmanager
def serve_bus(bus: str) -> Iterator[tuple[str, Hub | None]]:
    """A bus for two processes: its full spec, and the hub if this process hosts a loop bus.

    Raises:
        BusError: the bus cannot be used, or is in use by another flight.
    """
    spec = resolve(bus)
    if not spec.startswith("loop:"):
        _refuse_in_use(open_bus(spec), spec)
        yield spec, None
        return
    port = int(spec.removeprefix("loop:"))
    try:
        hub = Hub(0 if bus in ("loop", "auto") else port)
    except OSError:  # another process hosts it, or uses the port for something else
        _refuse_in_use(LoopLink(port, timeout_s=1.0, may_host=False), spec)
        yield spec, None
        return
    try:
        yield f"loop:{hub.port}", hub
    finally:
        hub.close()


def _refuse_in_use(bus: Bus, spec: str) -> None:
    try:
        refuse_bus_in_use(bus, spec)
    finally:
        bus.close()


def fly_processes(
    path: Path,
    scenario: Scenario,
    spec: str,
    hub: Hub | None,
    watch: ProgressCallback,
    patience: Patience = PATIENCE,
) -> None:
    """Fly with plant and flight software as two processes on a bus, as ``serve_bus`` gives it.

    Raises:
        FlightError: one of the two ended too early or is stalled; both have been ended.
    """
    with TemporaryDirectory() as scratch:
        table = write_flight_table(Path(scratch), scenario)
        _fly_processes(path, scenario, table, spec, hub, watch, patience)


def _fly_processes(
    path: Path,
    scenario: Scenario,
    table: Path,
    spec: str,
    hub: Hub | None,
    watch: ProgressCallback,
    patience: Patience,
) -> None:
    common = ("--bus", spec, "--parent", str(os.getpid()))
    waits = (str(patience.boot_s), str(patience.answer_s))
    plant = start_node("sim.flight.plant_process", str(path), *common, "--patience", *waits)
    fsw = start_node("fsw", "--table", str(table), *common)
    stall = _stall_detector(path, scenario, patience)
    stalled_s = 0.0
    try:
        while plant.poll() is None and fsw.poll() is None and not (stalled_s := stall.stalled_s()):
            _serve(hub, POLL_S)
            watch(last_tick(path, scenario))
        deadline = time.monotonic() + (0.0 if stalled_s else GRACE_S)
        while (
            (plant.poll() is None or fsw.poll() is None)
            and time.monotonic() < deadline
            and _no_failure(plant, fsw)
        ):
            _serve(hub, POLL_S / 10.0)
    finally:
        failed = [
            (name, process)
            for name, process in (("plant", plant), ("flight software", fsw))
            if process.poll()
        ]
        _end((plant, fsw), hub)
    run = run_dir.read_run(path)
    if not failed and "flown" in run:
        return
    tick = last_tick(path, scenario)
    name, process = failed[0] if failed else ("flight software", fsw)
    why = run.get("ended") or f"the {name} {exit_text(process.returncode)} at tick {tick}"
    if stalled_s:
        why = f"the plant is stalled: its log has not grown for {stalled_s:.0f} s after tick {tick}"
    if run.get("second_senders"):
        why += f"; {describe_senders(run['second_senders'])}"
    raise FlightError(f"{why}: the run is not complete, its files are in {path}")


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


def start_node(module: str, *arguments: str, **pipes: int) -> subprocess.Popen[bytes]:
    """Start a node as a process of the same code. Ctrl-C reaches this process only, which ends its nodes.

    Its packages are found where this process has found them, whatever the current directory holds.

    ``pipes``: of ``stdin``, ``stdout`` and ``stderr``, as ``subprocess`` takes them.
    """
    words = [sys.executable, "-m", module, *arguments]
    folders = [*filter(None, sys.path), HOUSE]
    path = {"PYTHONPATH": os.pathsep.join(folders), "PYTHONSAFEPATH": "1"}
    environment = {**os.environ, **path, "OPENBLAS_NUM_THREADS": "1"}
    popen: subprocess.Popen[bytes] = subprocess.Popen(
        words,
        env=environment,
        start_new_session=True,
        **pipes,  # type: ignore[call-overload]  # one of three keys
    )
    return popen


def _serve(hub: Hub | None, seconds: float) -> None:
    """Wait; meanwhile serve the bus if this process hosts it."""
    if hub is None:
        time.sleep(seconds)
        return
    deadline = time.monotonic() + seconds
    while (remaining_s := deadline - time.monotonic()) > 0.0:
        hub.poll(remaining_s)


def _no_failure(*processes: subprocess.Popen[bytes]) -> bool:
    return all(process.poll() in (None, 0) for process in processes)


def _end(processes: Sequence[subprocess.Popen[bytes]], hub: Hub | None) -> None:
    """Terminate processes that still run, with time to close their files; then kill them."""
    for process in processes:
        process.terminate()
    deadline = time.monotonic() + GRACE_S
    while any(process.poll() is None for process in processes) and time.monotonic() < deadline:
        _serve(hub, POLL_S / 10.0)
    for process in processes:
        process.kill()
        process.wait()


def exit_text(code: int | None) -> str:
    """How a process ended, as the end of a sentence."""
    if code is not None and code < 0:
        return f"was ended by signal {-code}"
    return f"ended with exit code {code}"
