"""The command line of a board: kind, bus, limits and stimulus."""

import os
import time
from collections.abc import Callable
from importlib.metadata import version
from math import isfinite
from platform import python_version
from typing import Any, TextIO

import click

from fsw.bus.interface import Bus, BusError
from fsw.bus.open_bus import KINDS, open_bus, resolve
from fsw.input.error_text import error_text
from fsw.input.near import did_you_mean
from fsw.wire.coil_current import MOST_MA
from fsw.wire.messages import MagField, SunCells, SunVector
from hil_stub.bench import (
    DEADMAN_MS,
    LEVEL_A,
    Bench,
    BenchBoard,
    CellsBoard,
    CoilBoard,
    DipoleBoard,
    MagnetometerBoard,
    SunBoard,
)
from hil_stub.coils.coil_driver import CoilLimits, Pin
from hil_stub.process.stimulus_option import stimulus_of, stimulus_words
from hil_stub.sensors.stimulus import StimulusError, currents, direction, scaled, three
from hil_stub.sensors.sun_cells import CELLS

# --- Runs a board on a bus, and logs the state of its pins

POLL_S = 0.5
"""How often Ctrl-C is noticed on a silent bus, where waiting cannot be interrupted."""


def now_ms() -> int:
    """A clock that never runs back [ms]."""
    return time.monotonic_ns() // 1_000_000


class PinLog:
    """Each change of the coil outputs as a line: what a logic analyser would show of a real board.

    ``1234 on 2 -3 until 4234``: since 1234 ms of this machine's monotonic clock coil 2 is on at level -3, and
    the timer that was armed with it ends that at 4234 ms. ``2345 off``: it has ended earlier, for another
    reason.

    Args:
        file: where the lines go; each is flushed at once.
    """

    def __init__(self, file: TextIO) -> None:
        self._file = file
        self._shown: Pin | None = None

    def note(self, at_ms: int, pin: Pin | None) -> None:
        """What is on at this instant."""
        if pin == self._shown:
            return
        output = "off" if pin is None else f"on {pin.coil} {pin.level}"
        timer = "" if pin is None or pin.until_ms is None else f" until {pin.until_ms}"
        self._file.write(f"{at_ms} {output}{timer}\n")
        self._file.flush()
        self._shown = pin


def run(bench: Bench, bus: Bus, pins: PinLog | None = None, parent: int | None = None) -> None:
    """Serve the bus until the process is ended.

    Args:
        bench: the board.
        bus: the bus it is on.
        pins: receives each change of the outputs.
        parent: process that started this one; when it is gone the board ends.
    """
    bus.send(bench.switch_on(now_ms=now_ms()))
    while parent is None or os.getppid() == parent:
        frame = bus.receive(_patience_s(bench.due_ms()))
        at_ms = now_ms()
        if frame is None:
            bench.watch(at_ms)
        elif answer := bench.receive(frame, at_ms):
            bus.send(answer)
        if pins is not None:
            pins.note(at_ms, bench.pin)


def _patience_s(due_ms: int | None) -> float:
    """How long to wait for a frame: until ``watch`` is due at the latest."""
    return POLL_S if due_ms is None else min(POLL_S, max(0.0, (due_ms - now_ms()) / 1000.0))


# --- The command line

NT = 1e-9
LEAST_DEADMAN_S = 0.001
"""The board's clock counts milliseconds."""


def _finite(ctx: click.Context, param: click.Parameter, seconds: float) -> float:
    """A time that is a number: NaN is on no side of the bounds of its range."""
    if not isfinite(seconds):
        raise click.BadParameter(f"{seconds} is not a finite number.", ctx, param)
    return seconds


_bus = click.option("--bus", "spec", required=True, help=f"auto, {KINDS}.")
_tick_hz = click.option(
    "--tick-hz", type=click.IntRange(1, 1000), default=1, show_default=True, help="Ticks a second."
)
_WITH_STIMULUS = {"ignore_unknown_options": True}  # so that --stimulus takes negative numbers


EXAMPLES = """\b
Examples:
  torquer board coil --bus socketcan:vcan0
  torquer board magnetometer --bus loop --stimulus 20000 0 -30000
  torquer board sun --bus loop --tick-hz 10"""


class Boards(click.Group):
    """The boards by name."""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """The board that the arguments begin with.

        Raises:
            UsageError: there is no such board.
        """
        if args and not ctx.resilient_parsing and args[0] not in self.commands and args[0][:1] != "-":
            hint = did_you_mean(args[0], self.commands)
            raise click.UsageError(
                f"there is no board {args[0]!r}{hint}: choose from {', '.join(self.commands)}"
            )
        return super().resolve_command(ctx, args)


@click.group(cls=Boards, epilog=EXAMPLES)
@click.option("--parent", type=int, hidden=True)
@click.option("-q", "--quiet", is_flag=True, help="Print failures only.")
@click.option("-v", "--verbose", is_flag=True, help="Say on stderr what runs, of which version.")
def board(parent: int | None, quiet: bool, verbose: bool) -> None:
    """Run one board on a bus, until Ctrl-C; PLANT_END does not end it."""
    if verbose:
        click.echo(f"board: torquer {version('torquer')}, Python {python_version()}", err=True)


@board.command()
@_bus
@_tick_hz
@click.option(
    "--backoff",
    type=click.Choice(["shared", "per_coil"]),
    default="shared",
    show_default=True,
    help="What a pulse locks out: all coils, or its own.",
)
@click.option(
    "--pulse-s",
    type=click.FloatRange(0.001, 3.0),
    callback=_finite,
    default=3.0,
    show_default=True,
    help="Longest pulse.",
)
@click.option(
    "--backoff-s",
    type=click.FloatRange(0.0, 160.0),
    callback=_finite,
    default=100.0,
    show_default=True,
    help="From the end of a pulse to the next start.",
)
@click.option(
    "--levels-ma",
    type=(float, float, float),
    default=tuple(1000.0 * level_a for level_a in LEVEL_A),
    show_default=True,
    help="Currents at levels 1, 2, 3.",
)
@click.option(
    "--deadman-s",
    type=click.FloatRange(0.0, 3600.0),
    callback=_finite,
    default=DEADMAN_MS / 1000.0,
    show_default=True,
    help="Silence of SYNC after which all is off and locked out in full; 0: no dead-man.",
)
@click.option(
    "--clock",
    type=click.Choice(["own", "ticks"]),
    default="own",
    show_default=True,
    help="own: a clock beside the ticks of the bus; ticks: none, where ticks are not real time.",
)
@click.option(
    "--pins",
    type=click.File("w", lazy=False),
    help="Write each change of the coil outputs here, with its time (-: stdout).",
)
def coil(
    spec: str,
    tick_hz: int,
    backoff: str,
    pulse_s: float,
    backoff_s: float,
    levels_ma: tuple[float, float, float],
    deadman_s: float,
    clock: str,
    pins: TextIO | None,
) -> None:
    """The coil driver with its interlock, locked out at the start."""
    limits = CoilLimits(tick_hz, round(1000.0 * pulse_s), round(1000.0 * backoff_s), backoff == "shared")
    if not 0.0 < levels_ma[0] < levels_ma[1] < levels_ma[2] <= MOST_MA:
        raise click.UsageError(f"--levels-ma must be three rising currents above 0, at most {MOST_MA:g}")
    if 0.0 < deadman_s < LEAST_DEADMAN_S:
        raise click.UsageError(f"--deadman-s must be 0, for no dead-man, or at least {LEAST_DEADMAN_S:g}")
    level_a = three(scaled(levels_ma, 1e-3))
    _serve(spec, lambda: CoilBoard(limits, level_a), deadman_s, clock, pins)


@board.command()
@_bus
@_tick_hz
def dipole(spec: str, tick_hz: int) -> None:
    """The continuous driver: all three coils at once, for a tick at a time."""
    _serve(spec, lambda: DipoleBoard(tick_hz))


@board.command(context_settings=_WITH_STIMULUS)
@_bus
@_tick_hz
@click.option("--stimulus", help="Field in body axes [nT]. Default: 20000 0 -30000.")
@click.argument("rest", nargs=-1, type=click.UNPROCESSED, metavar="")
def magnetometer(spec: str, tick_hz: int, stimulus: str | None, rest: tuple[str, ...]) -> None:
    """The magnetometer, with a field as its stimulus.

    --stimulus X Y Z is a constant; RUN or LOG replays its samples, tick by tick; FILE.toml is a script.
    """
    sample_at = stimulus_of(
        stimulus_words(stimulus, rest, "20000 0 -30000"),
        "field_nt",
        MagField,
        tick_hz,
        NT,
        lambda v: scaled(v, NT),
    )
    _serve(spec, lambda: MagnetometerBoard(tick_hz, sample_at))


@board.command(context_settings=_WITH_STIMULUS)
@_bus
@_tick_hz
@click.option("--stimulus", help="Direction of the Sun in body axes. Default: 1 0 0.")
@click.argument("rest", nargs=-1, type=click.UNPROCESSED, metavar="")
def sun(spec: str, tick_hz: int, stimulus: str | None, rest: tuple[str, ...]) -> None:
    """The Sun sensor, with a direction as its stimulus.

    --stimulus X Y Z is a constant; RUN or LOG replays its samples, tick by tick; FILE.toml is a script.
    """
    sample_at = stimulus_of(
        stimulus_words(stimulus, rest, "1 0 0"), "sun", SunVector, tick_hz, 1.0, direction
    )
    _serve(spec, lambda: SunBoard(tick_hz, sample_at))


@board.command(context_settings=_WITH_STIMULUS)
@_bus
@_tick_hz
@click.option("--stimulus", help="Currents of six Sun cells, of full sunlight. Default: 0.8 0 0.6 0 0 0.")
@click.argument("rest", nargs=-1, type=click.UNPROCESSED, metavar="")
def cells(spec: str, tick_hz: int, stimulus: str | None, rest: tuple[str, ...]) -> None:
    """The Sun cells, with their currents as the stimulus; in place of the Sun sensor.

    --stimulus C1 C2 C3 C4 C5 C6 is a constant, 0 where there is no cell; RUN or LOG replays its samples, tick
    by tick; FILE.toml is a script.
    """
    words = stimulus_words(stimulus, rest, "0.8 0 0.6 0 0 0")
    sample_at = stimulus_of(words, "cells", SunCells, tick_hz, 1.0, currents, CELLS)
    _serve(spec, lambda: CellsBoard(tick_hz, sample_at))


def _serve(
    spec: str,
    make_board: Callable[[], BenchBoard],
    deadman_s: float = 0.0,
    clock: str = "ticks",
    pins: TextIO | None = None,
) -> None:
    deadman_ms = round(1000.0 * deadman_s) or None
    bench = Bench(make_board, deadman_ms, has_clock=clock == "own")
    try:
        bus = open_bus(spec)
    except BusError as error:
        raise click.UsageError(str(error)) from error
    group = _group()
    if not group["quiet"]:
        click.echo(f"on {error_text(resolve(spec))}", err=True)
    try:
        parent: int | None = group["parent"]
        run(bench, bus, PinLog(pins) if pins is not None else None, parent)
    except BusError as error:
        raise click.ClickException(str(error)) from error
    except StimulusError as error:
        raise click.UsageError(f"--stimulus -: {error}") from None
    except KeyboardInterrupt:
        pass
    finally:
        bus.close()


def _group() -> dict[str, Any]:
    """The options of the group of commands."""
    group = click.get_current_context().parent
    return {"parent": None, "quiet": False} if group is None else group.params
