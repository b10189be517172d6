"""Run one board on a named bus: ``python -m hil_stub coil|dipole|magnetometer|sun --bus BUS``."""

import os
import select
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TextIO

import click

from fsw.bus.interface import Bus, BusError
from fsw.bus.open_bus import open_bus, resolve
from fsw.input.regular_file import check_regular
from fsw.input.sentence import sentence
from fsw.input.toml_text import load_toml
from fsw.wire.messages import MagField, SunVector
from hil_stub.bench import (
    DEADMAN_MS,
    LEVEL_A,
    Bench,
    Board,
    CoilBoard,
    DipoleBoard,
    MagnetometerBoard,
    SunBoard,
)
from hil_stub.coils.coil_driver import CoilLimits, Pin
from hil_stub.sensors.stimulus import (
    NOTHING,
    Reading,
    Stimulus,
    StimulusError,
    Vec3,
    constant,
    direction,
    recorded,
    scaled,
    scripted,
    three_numbers,
)

EXIT_BAD_INPUT = 2
POLL_S = 0.5
"""How often a silent bus lets Ctrl-C in, where waiting cannot be interrupted."""
PIPE_PATIENCE_S = 1.0
"""How long a sensor waits for what it is shown over stdin; after that it reads nothing."""
LONGEST_LINE = 256
NT = 1e-9


def now_ms() -> int:
    """A clock that never runs back [ms]."""
    return time.monotonic_ns() // 1_000_000


class PinLog:
    """Each change of the coil outputs as a line: what a logic analyser would show of a real board.

    ``1234 on 2 -3 until 4234``: since 1234 ms of this machine's monotonic clock coil 2 is on at level -3, and
    the timer that was armed with it ends that at 4234 ms. ``2345 off``: something else has ended it before.

    Args:
        file: where the lines go; each is handed over at once.
    """

    def __init__(self, file: TextIO) -> None:
        self._file = file
        self._shown: Pin | None = None

    def note(self, at_ms: int, pin: Pin | None) -> None:
        """What is on at this instant."""
        if pin == self._shown:
            return
        said = "off" if pin is None else f"on {pin.coil} {pin.level}"
        timer = "" if pin is None or pin.until_ms is None else f" until {pin.until_ms}"
        self._file.write(f"{at_ms} {said}{timer}\n")
        self._file.flush()
        self._shown = pin


def run(bench: Bench, bus: Bus, pins: PinLog | None = None, parent: int | None = None) -> None:
    """Serve the bus until the process is ended.

    Args:
        bench: the board.
        bus: where it lives.
        pins: takes each change of the outputs.
        parent: process that started this one; when it is gone there is nobody to serve.
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
    """How long to wait for a frame: no longer than until something is due without one."""
    return POLL_S if due_ms is None else min(POLL_S, max(0.0, (due_ms - now_ms()) / 1000.0))


def _serve(
    spec: str,
    make_board: Callable[[], Board],
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
    click.echo(f"on {resolve(spec)}", err=True)
    try:
        parent = click.get_current_context().find_root().params["parent"]
        run(bench, bus, PinLog(pins) if pins is not None else None, parent)
    except BusError as error:
        raise click.ClickException(str(error)) from error
    except KeyboardInterrupt:
        pass
    finally:
        bus.close()


class PipedStimulus:
    """Readings as lines on stdin, ``tick x y z valid``: waits for the tick asked for, but not for ever.

    Args:
        scale: from the numbers of the lines to the reading.
        descriptor: where the lines come from.
    """

    def __init__(self, scale: float, descriptor: int = 0) -> None:
        self._scale = scale
        self._descriptor = descriptor
        self._torn = b""
        self._readings: dict[int, Reading] = {}

    def __call__(self, tick: int) -> Reading:
        """The reading at ``tick``; nothing, if it does not come."""
        deadline = time.monotonic() + PIPE_PATIENCE_S
        while tick not in self._readings:
            left_s = deadline - time.monotonic()
            if left_s <= 0.0 or not self._fill(left_s):
                return NOTHING
        self._readings = {known: shown for known, shown in self._readings.items() if known >= tick}
        return self._readings[tick]

    def _fill(self, timeout_s: float) -> bool:
        if not select.select((self._descriptor,), (), (), timeout_s)[0]:
            return False
        text = os.read(self._descriptor, 65536)
        *lines, self._torn = (self._torn + text).split(b"\n")
        for line in lines:
            number, x, y, z, valid = line.split()
            vector = scaled((float(x), float(y), float(z)), self._scale)
            self._readings[int(number)] = Reading(vector, valid == b"1")
        return bool(text)


def _stimulus(
    words: tuple[str, ...],
    key: str,
    message: type[MagField] | type[SunVector],
    tick_hz: int,
    scale: float,
    convert: Callable[[Vec3], Vec3],
) -> Stimulus:
    """What ``--stimulus`` asks for: three numbers, a log or a run, a script, or ``-`` for stdin."""
    try:
        if len(words) == 3:
            return constant(convert(three_numbers([_number(word) for word in words])))
        if words == ("-",):
            return PipedStimulus(scale)
        if len(words) != 1:
            raise StimulusError("must be three numbers, a run, a log, a script that ends in .toml, or -")
        path = Path(words[0])
        if path.suffix == ".toml":
            return scripted(_toml(path).get("step"), key, tick_hz, convert)
        log = path / "bus.log" if os.path.isdir(path) else path
        check_regular(log)
        return recorded(_lines(log), message, scale)
    except StimulusError as error:
        raise click.UsageError(f"--stimulus {' '.join(words)}: {error}") from None
    except OSError as error:
        raise click.UsageError(f"--stimulus {' '.join(words)}: cannot be read: {error.strerror}") from None


def _words(first: str | None, rest: tuple[str, ...], default: str) -> tuple[str, ...]:
    """The words after ``--stimulus``; without it the default, and nothing may be left over."""
    if first is not None:
        return (first, *rest)
    if rest:
        raise click.UsageError(f"No such option or argument: {rest[0]}")
    return tuple(default.split())


def _number(word: str) -> float:
    try:
        return float(word)
    except ValueError:
        raise StimulusError("must be three finite numbers") from None


def _toml(path: Path) -> dict[str, object]:
    try:
        return load_toml(path)
    except ValueError as error:
        raise StimulusError(f"cannot be read as TOML: {error}") from None


def _lines(log: Path) -> Iterator[str]:
    """The lines of a log; what is longer than any frame's comes in pieces, which are none."""
    with log.open(encoding="ascii", errors="replace") as file:
        while line := file.readline(LONGEST_LINE):
            yield line


_bus = click.option(
    "--bus", "spec", required=True, help="socketcan:NAME, loop, loop:PORT, slcan:PORT or auto."
)
_tick_hz = click.option(
    "--tick-hz", type=click.IntRange(1, 1000), default=1, show_default=True, help="Ticks a second."
)
_SHOWN = {"ignore_unknown_options": True}  # so that --stimulus takes negative numbers


@click.group()
@click.option("--parent", type=int, hidden=True)
def cli(parent: int | None) -> None:
    """Run one board on a bus, until Ctrl-C: a bench is not over when a plant says so."""


@cli.command()
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
    "--pulse-s", type=click.FloatRange(0.001, 3.0), default=3.0, show_default=True, help="Longest pulse."
)
@click.option(
    "--backoff-s",
    type=click.FloatRange(0.0, 160.0),
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
    levels_ma: Vec3,
    deadman_s: float,
    clock: str,
    pins: TextIO | None,
) -> None:
    """The coil driver with its interlock, locked out at the start."""
    limits = CoilLimits(tick_hz, round(1000.0 * pulse_s), round(1000.0 * backoff_s), backoff == "shared")
    if not 0.0 < levels_ma[0] < levels_ma[1] < levels_ma[2]:
        raise click.UsageError("--levels-ma must be three rising currents above 0")
    level_a = scaled(levels_ma, 1e-3)
    _serve(spec, lambda: CoilBoard(limits, level_a), deadman_s, clock, pins)


@cli.command()
@_bus
@_tick_hz
def dipole(spec: str, tick_hz: int) -> None:
    """The continuous driver: all three coils at once, for a tick at a time."""
    _serve(spec, lambda: DipoleBoard(tick_hz))


@cli.command(context_settings=_SHOWN)
@_bus
@_tick_hz
@click.option("--stimulus", help="Field in body axes [nT]. Default: 20000 0 -30000.")
@click.argument("rest", nargs=-1, type=click.UNPROCESSED, metavar="")
def magnetometer(spec: str, tick_hz: int, stimulus: str | None, rest: tuple[str, ...]) -> None:
    """The magnetometer, shown a field.

    --stimulus X Y Z is a constant; RUN or LOG what it said then, tick by tick; FILE.toml a script.
    """
    shown = _stimulus(
        _words(stimulus, rest, "20000 0 -30000"), "field_nt", MagField, tick_hz, NT, lambda v: scaled(v, NT)
    )
    _serve(spec, lambda: MagnetometerBoard(tick_hz, shown))


@cli.command(context_settings=_SHOWN)
@_bus
@_tick_hz
@click.option("--stimulus", help="Direction of the Sun in body axes. Default: 1 0 0.")
@click.argument("rest", nargs=-1, type=click.UNPROCESSED, metavar="")
def sun(spec: str, tick_hz: int, stimulus: str | None, rest: tuple[str, ...]) -> None:
    """The Sun sensor, shown a lamp.

    --stimulus X Y Z is a constant; RUN or LOG what it said then, tick by tick; FILE.toml a script.
    """
    shown = _stimulus(_words(stimulus, rest, "1 0 0"), "sun", SunVector, tick_hz, 1.0, direction)
    _serve(spec, lambda: SunBoard(tick_hz, shown))


def main(arguments: list[str] | None = None) -> int:
    """Run the command line: the exit code, and one sentence on stderr when it is not 0."""
    try:
        cli.main(arguments, prog_name="python -m hil_stub", standalone_mode=False)
    except click.UsageError as error:
        click.echo(sentence(error.format_message()), err=True)
        return EXIT_BAD_INPUT
    except click.ClickException as error:
        click.echo(sentence(error.format_message()), err=True)
        return error.exit_code
    except click.Abort:
        pass
    return 0


if __name__ == "__main__":
    sys.exit(main())
