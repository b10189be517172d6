"""What ``torquer watch`` does: a source of frames, what they show, and one of three ways to show it."""

from dataclasses import dataclass
from pathlib import Path

from fsw.bus.interface import BusError
from sim.errors import HarnessError
from sim.progress import note
from sim.record.pace import Pace
from sim.scenario.schema import Scenario, load
from sim.watch.coil_torque import craft_of
from sim.watch.directions import onboard_around
from sim.watch.flight_view import FlightView
from sim.watch.source import BusSource, FrameSource, LogSource, batches


@dataclass(frozen=True, slots=True)
class WatchSession:
    """A source and what its frames have shown."""

    source: FrameSource
    view: FlightView


def watch(what: str, pace: Pace, scenario: str | None) -> WatchSession:
    """Open a bus or a log.

    Args:
        what: a run directory or a log, if there is one of that name; else a bus.
        pace: of a log.
        scenario: of the satellite, by whose orbit field and Sun are predicted; None: that of the run.

    Raises:
        BusError: there is no such bus.
        TableError: there is no such scenario.
        HarnessError: the log cannot be read.
    """
    flown: Scenario | None = None if scenario is None else load(scenario)
    if Path(what).exists() or "/" in what.partition(":")[0]:
        log = LogSource(Path(what), pace)
        flown = log.scenario() if flown is None else flown
        source: FrameSource = log
    else:
        source = _bus(what)
    if flown is None:
        return WatchSession(source, FlightView())
    return WatchSession(source, FlightView(onboard_around(flown), craft_of(flown)))


def _bus(what: str) -> BusSource:
    try:
        return BusSource(what)
    except BusError as error:
        if ":" in what:
            raise
        raise BusError(f"{error}; nor is there a run or a log of that name") from None


def show_on_terminal(watched: WatchSession) -> None:
    """Show it on standard output until there is no more.

    Raises:
        HarnessError: a log ends in the middle of a line.
    """
    from sim.watch.terminal import show  # noqa: PLC0415  rich loads when something is drawn

    show(watched.view, batches(watched.source, watched.view), watched.source.name)
    check_whole(watched.source)


def serve_page(watched: WatchSession, port: int) -> None:
    """Serve it as a page until Ctrl-C.

    Raises:
        HarnessError: a package is missing, the port is taken, or a log ends in the middle of a line.
    """
    from sim.watch.web import LiveView, serve  # noqa: PLC0415  an extra

    serve(LiveView(watched.source, watched.view), port, lambda address: note(f"{address} until Ctrl-C"))
    check_whole(watched.source)


def serve_foxglove(watched: WatchSession, port: int) -> None:
    """Serve it to Foxglove until there is no more, or Ctrl-C.

    Raises:
        HarnessError: the package is missing, the port is taken, or a log ends in the middle of a line.
    """
    from sim.watch.foxglove import foxglove_server  # noqa: PLC0415  an extra

    with foxglove_server(port) as publisher:
        note(f"Foxglove: open a connection to ws://127.0.0.1:{publisher.port}")
        for _ in batches(watched.source, watched.view):
            publisher.publish(watched.view)
    check_whole(watched.source)


def check_whole(source: FrameSource) -> None:
    """All of a source was shown.

    Raises:
        LogCutError: it is a log that ends in the middle of a line.
    """
    if isinstance(source, LogSource) and source.cut_short:
        raise LogCutError(f"{source.path}: the log was cut short: its last line is incomplete")


class LogCutError(HarnessError):
    """All of a log was shown, but it has no end."""

    exit_code = 1
