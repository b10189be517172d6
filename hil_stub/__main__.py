"""Run one board by hand on a named bus: ``python -m hil_stub coil|dipole|magnetometer|sun --bus BUS``."""

import sys
from math import hypot, isfinite

import click

from fsw.io.bus import Bus, BusError
from fsw.io.open_bus import open_bus, resolve
from hil_stub.bench import Bench, CoilBoard, DipoleBoard, MagnetometerBoard, SunBoard, Vec3
from hil_stub.coil_driver import CoilLimits

EXIT_BAD_INPUT = 2
POLL_S = 0.5
"""How often a silent bus lets Ctrl-C in, where waiting cannot be interrupted."""


def run(bench: Bench, bus: Bus) -> None:
    """Serve the bus until the plant says that the run is over."""
    bus.send(bench.switch_on())
    while not bench.ended:
        frame = bus.receive(POLL_S)
        if frame is not None and (answer := bench.receive(frame)):
            bus.send(answer)


def _serve(spec: str, bench: Bench) -> None:
    try:
        bus = open_bus(spec)
    except BusError as error:
        raise click.UsageError(str(error)) from error
    click.echo(f"on {resolve(spec)}", err=True)
    try:
        run(bench, bus)
    except BusError as error:
        raise click.ClickException(str(error)) from error
    except KeyboardInterrupt:
        pass
    finally:
        bus.close()


_bus = click.option(
    "--bus", "spec", required=True, help="socketcan:NAME, loop, loop:PORT, slcan:PORT or auto."
)
_tick_hz = click.option(
    "--tick-hz", type=click.IntRange(1, 1000), default=1, show_default=True, help="Ticks a second."
)


@click.group()
def cli() -> None:
    """Run one board on a bus, with a fixed stimulus. Ends when the plant does, or on Ctrl-C."""


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
def coil(spec: str, tick_hz: int, backoff: str) -> None:
    """The coil driver with its interlock: pulses of 3 s, 100 s back-off, locked out at the start."""
    limits = CoilLimits(tick_hz, shared=backoff == "shared")
    _serve(spec, Bench(lambda: CoilBoard(limits)))


@cli.command()
@_bus
@_tick_hz
def dipole(spec: str, tick_hz: int) -> None:
    """The continuous driver: all three coils at once, for a tick at a time."""
    _serve(spec, Bench(lambda: DipoleBoard(tick_hz)))


@cli.command()
@_bus
@_tick_hz
@click.option(
    "--stimulus",
    type=(float, float, float),
    default=(20_000.0, 0.0, -30_000.0),
    show_default=True,
    help="Field in body axes [nT].",
)
def magnetometer(spec: str, tick_hz: int, stimulus: Vec3) -> None:
    """The magnetometer, in a constant field."""
    x_nt, y_nt, z_nt = _finite(stimulus)
    b_body_t = (x_nt * 1e-9, y_nt * 1e-9, z_nt * 1e-9)
    _serve(spec, Bench(lambda: MagnetometerBoard(tick_hz, b_body_t)))


@cli.command()
@_bus
@_tick_hz
@click.option(
    "--stimulus",
    type=(float, float, float),
    default=(1.0, 0.0, 0.0),
    show_default=True,
    help="Direction of the Sun in body axes.",
)
def sun(spec: str, tick_hz: int, stimulus: Vec3) -> None:
    """The Sun sensor, before a lamp that stands still."""
    x, y, z = _finite(stimulus)
    length = hypot(x, y, z)
    if length == 0.0:
        raise click.UsageError("--stimulus is no direction: give three numbers that are not all 0")
    sun_body = (x / length, y / length, z / length)
    _serve(spec, Bench(lambda: SunBoard(tick_hz, sun_body)))


def _finite(stimulus: Vec3) -> Vec3:
    if not all(map(isfinite, stimulus)):
        raise click.UsageError("--stimulus must be three finite numbers")
    return stimulus


def main(arguments: list[str] | None = None) -> int:
    """Run the command line: the exit code, and one sentence on stderr when it is not 0."""
    try:
        cli.main(arguments, prog_name="python -m hil_stub", standalone_mode=False)
    except click.UsageError as error:
        click.echo(error.format_message(), err=True)
        return EXIT_BAD_INPUT
    except click.ClickException as error:
        click.echo(error.format_message(), err=True)
        return error.exit_code
    except click.Abort:
        pass
    return 0


if __name__ == "__main__":
    sys.exit(main())
