"""The ``torquer`` command. Errors are one sentence and exit code 2; a failed verdict is exit code 1.

Each kind of input is checked where it enters, and told of there. What comes out of a command as any other
exception is a defect of this program: it stays a traceback (exit code 1), which says where to look.
"""

import sys
from collections.abc import Callable
from functools import wraps
from io import TextIOWrapper
from pathlib import Path
from typing import Any, ParamSpec

import click

from fsw.bus.interface import BusError
from fsw.input.schema import TableError
from fsw.input.sentence import sentence
from sim.harness.errors import DISK_FULL, HarnessError
from sim.harness.signals import EndedBySignal, endings_raised
from sim.plant.errors import PlantError

Parameters = ParamSpec("Parameters")

SEEDS = click.IntRange(0, 2**64 - 1)
BUSES = "auto, loop[:PORT], socketcan:NAME, slcan:PORT"
RUN_OR_LOG = click.argument("run_or_log", metavar="RUN|LOG", type=click.Path(path_type=Path))
SETTINGS = click.option(
    "--set", "settings", multiple=True, metavar="KEY=VALUE", help="Override a key of the scenario."
)

SIGN = click.option(
    "--sign",
    metavar="KEY",
    type=click.Path(path_type=Path),
    help="Sign the run: a private Ed25519 key in PEM. Needs torquer[sign].",
)
VERIFY = click.option(
    "--verify",
    metavar="PUBLIC_KEY",
    type=click.Path(path_type=Path),
    help="The run must be signed: its public Ed25519 key in PEM. Needs torquer[sign].",
)


def sentences(command: Callable[Parameters, int | None]) -> Callable[Parameters, None]:
    """Turn what a user can mend into one sentence on stderr and an exit code."""

    @wraps(command)
    def run(*args: Parameters.args, **kwargs: Parameters.kwargs) -> None:
        try:
            with endings_raised():
                code = command(*args, **kwargs)
        except (TableError, BusError, HarnessError, PlantError) as error:
            click.echo(f"torquer: {sentence(error)}", err=True)
            code = getattr(error, "exit_code", 2)
        except KeyboardInterrupt:
            click.echo("torquer: interrupted; what was done so far is kept", err=True)
            code = 130
        except EndedBySignal as end:
            click.echo(f"torquer: {end}", err=True)
            code = end.exit_code
        sys.exit(code or 0)

    return run


class Commands(click.Group):
    """The commands; a wrong option, like any other error, is one sentence, without the usage before it."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """No name of anything holds a NUL."""
        if any("\0" in word for word in args):
            raise click.UsageError("an argument holds a NUL character")
        return super().parse_args(ctx, args)

    def main(self, *args: Any, **kwargs: Any) -> Any:  # noqa: ANN401  (as in click)
        """Run a command line and exit."""
        if isinstance(sys.stdout, TextIOWrapper):
            sys.stdout.reconfigure(errors="backslashreplace")  # a path may hold what is no text
        try:
            code = super().main(*args, **{**kwargs, "standalone_mode": False})
        except click.ClickException as error:
            click.echo(f"torquer: {sentence(error.format_message())}", err=True)
            code = error.exit_code
        except OSError as error:
            if error.errno not in DISK_FULL:
                raise
            click.echo(f"torquer: the disk takes no more ({error.strerror}); what was done is kept", err=True)
            code = 1
        except click.Abort:
            code = 130
        sys.exit(code)


@click.group(
    cls=Commands, invoke_without_command=True, context_settings={"help_option_names": ["-h", "--help"]}
)
@click.version_option(package_name="torquer", prog_name="torquer")
@click.pass_context
def main(context: click.Context) -> None:
    """Magnetic attitude control as flight software: fly it, replay it, audit it."""
    if context.invoked_subcommand is None:
        click.echo(context.get_help())


@main.command()
@sentences
def scenarios() -> None:
    """The scenarios that ship, one line each."""
    from sim.harness.scenario import shipped

    for scenario in shipped():
        click.echo(f"{scenario.name:<14} {scenario.summary}")


@main.command()
@click.argument("scenario", default="microsat")
@click.option("--bus", default="auto", show_default=True, help=BUSES + " or virtual.")
@click.option("--pace", default="lockstep", show_default=True, help="lockstep or realtime[:FACTOR].")
@click.option(
    "--orbits", type=click.FloatRange(min=0.0, min_open=True), help="Default: as the scenario says."
)
@click.option("--seed", default=1, show_default=True, type=SEEDS, help="Of all random streams.")
@click.option("--out", type=click.Path(path_type=Path), help="Default: runs/<scenario>-<UTC time>.")
@SIGN
@SETTINGS
@sentences
def sil(
    scenario: str,
    bus: str,
    pace: str,
    orbits: float | None,
    seed: int,
    out: Path | None,
    sign: Path | None,
    settings: tuple[str, ...],
) -> int:
    """Fly SCENARIO: plant and flight software as two processes on a bus (virtual: in one)."""
    from sim.harness import run_dir
    from sim.harness.pace import parse_pace
    from sim.harness.progress import progress
    from sim.harness.scenario import load, parse_settings
    from sim.harness.signature import private_key
    from sim.harness.sil import check_flyable, fly_processes, served, ticks_of

    key = None if sign is None else private_key(sign)
    chosen, chosen_pace = load(scenario, parse_settings(settings)), parse_pace(pace)
    ticks, path = ticks_of(chosen, orbits), out or run_dir.default_path(chosen)
    check_flyable(chosen, seed)
    flying = f"flying {chosen.name}"
    if bus == "virtual":
        from sim.harness.virtual import fly_virtual

        run_dir.begin(path, chosen, seed, ticks, bus, chosen_pace)
        with progress(flying, ticks) as watch:
            fly_virtual(path, chosen, watch)
    else:
        with served(bus) as (spec, hub):
            kind = spec.partition(":")[0]
            run_dir.begin(path, chosen, seed, ticks, kind, chosen_pace)
            if bus == "auto":
                click.echo(f"bus: {kind} (auto)", err=True)
            with progress(flying, ticks) as watch:
                fly_processes(path, chosen, spec, hub, watch)
    from sim.harness.binding import sign_run  # the flight does not wait for what it does not need
    from sim.harness.conclude import conclude
    from sim.harness.summary import summary_text

    with progress("replaying", ticks) as watch:
        summary = conclude(path, watch)
    if key is not None:
        sign_run(path, key)
    click.echo(summary_text(summary))
    click.echo(f"report: {path / run_dir.REPORT}")
    return _told(summary.get("failures", {}))


@main.command()
@RUN_OR_LOG
@click.option("--scenario", help="What a bare log was flown with; default the scenario.toml beside it.")
@click.option("--plant", is_flag=True, help="Put the recorded commands through the plant instead.")
@click.option("--onto", metavar="BUS", help="Play the log on a bus instead, at its own pace.")
@VERIFY
@SETTINGS
@sentences
def replay(
    run_or_log: Path,
    scenario: str | None,
    plant: bool,
    onto: str | None,
    verify: Path | None,
    settings: tuple[str, ...],
) -> int:
    """Refly a log through the flight software and compare byte for byte."""
    from sim.harness import replay_command as commands
    from sim.harness.signature import public_key

    key = None if verify is None else public_key(verify)
    log, chosen = commands.locate(run_or_log, scenario, settings, key)
    with chosen.binding.beside_errors():
        if onto is not None:
            return commands.play(log, chosen, onto)
        if plant:
            return commands.through_plant(log, chosen)
        return commands.through_flight_software(log, chosen)


@main.command()
@RUN_OR_LOG
@click.option("--backoff", type=click.Choice(["shared", "per_coil"]), help="Limits of a bare log.")
@VERIFY
@sentences
def check(run_or_log: Path, backoff: str | None, verify: Path | None) -> int:
    """Audit the actuator limits in a candump log, independently of the controller."""
    from sim.harness.audit.check import check, render
    from sim.harness.signature import public_key

    report = check(run_or_log, backoff, None if verify is None else public_key(verify))
    click.echo(render(report))
    return report.exit_code


@main.command()
@click.argument("run", type=click.Path(path_type=Path))
@SIGN
@VERIFY
@sentences
def report(run: Path, sign: Path | None, verify: Path | None) -> int:
    """Rebuild summary.json and report.html of a run; that it was cut short is said, and no failure."""
    from sim.harness import run_dir
    from sim.harness.binding import require_sources, sign_run
    from sim.harness.conclude import conclude
    from sim.harness.progress import progress
    from sim.harness.signature import private_key, public_key, signature_of
    from sim.harness.summary import summary_text
    from sim.harness.verdict import Verdict

    key = None if sign is None else private_key(sign)
    binding = require_sources(run, None if verify is None else public_key(verify))
    bound_before = (run / run_dir.RUN).read_bytes()
    with progress("replaying", run_dir.read_run(run)["ticks"]) as watch:
        summary = conclude(run, watch)
    if key is not None:
        sign_run(run, key)
    elif signature_of(run / run_dir.RUN).exists() and (run / run_dir.RUN).read_bytes() != bound_before:
        click.echo(f"note: {run_dir.RUN} is not what was signed any more: --sign KEY signs it anew", err=True)
    for line in binding.lines:
        click.echo(line)
    click.echo(summary_text(summary))
    click.echo(f"report: {run / run_dir.REPORT}")
    failed: dict[str, str] = summary.get("failures", {})
    flown_badly = {name: clause for name, clause in failed.items() if name != Verdict.COMPLETE}
    return _told(flown_badly) or int(not binding.holds)


def _told(failures: dict[str, str]) -> int:
    """Say what failed, in one sentence; the exit code."""
    from sim.harness.verdict import flight_failed

    if failures:
        click.echo(f"torquer: {flight_failed(failures)}", err=True)
    return int(bool(failures))


@main.command()
@click.option(
    "--reference",
    metavar="DIR",
    type=click.Path(path_type=Path),
    help="Check against the reference files in this folder alone.",
)
@click.option(
    "--only", multiple=True, metavar="ID", help="These claims alone, by the first words of their ids."
)
@click.option("--quick", is_flag=True, help="Leave out flights.")
@click.option("--workers", type=click.IntRange(min=1), help="Processes. Default: one a core.")
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    help="The page. Default, if all is run: docs/validation.md of the repository, else validation.md.",
)
@sentences
def validate(
    reference: Path | None, only: tuple[str, ...], quick: bool, workers: int | None, out: Path | None
) -> int:
    """Every published figure and reference check: claim, source, ours, verdict."""
    from sim.harness.validate.command import validate

    return validate(reference, only, out, quick, workers)


@main.command()
@click.argument("scenario")
@click.option("--gains", nargs=2, type=float, metavar="K_W K_A", help="Evaluate these instead of searching.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON alone; pictures only with --out.")
@click.option("--write", is_flag=True, help="Put the gains into SCENARIO, a file.")
@click.option("--out", type=click.Path(path_type=Path), help="Of pictures; default: runs/design-<scenario>.")
@SETTINGS
@sentences
def design(
    scenario: str,
    gains: tuple[float, float] | None,
    as_json: bool,
    write: bool,
    out: Path | None,
    settings: tuple[str, ...],
) -> int:
    """Gains of the PD law for SCENARIO by Floquet theory: exponents, margins, maps, best gains."""
    from sim.harness.design import command

    return command.design(scenario, settings, gains, as_json, write, out)


@main.command()
@click.argument("scenario", default="microsat")
@click.option("--laws", metavar="A,B", help="Laws, aims or all. Default: all with the aim of the scenario's.")
@click.option(
    "--driver", default="both", show_default=True, type=click.Choice(["pulsed", "continuous", "both"])
)
@click.option(
    "--orbits", type=click.FloatRange(min=0.0, min_open=True), help="Default: as the scenario says."
)
@click.option("--seed", default=1, show_default=True, type=SEEDS, help="Of all random streams.")
@click.option("--workers", type=click.IntRange(min=1), help="Processes. Default: one a core.")
@click.option(
    "--out", type=click.Path(path_type=Path), help="Folder. Default: compare/<scenario>-<UTC time>."
)
@SETTINGS
@sentences
def compare(
    scenario: str,
    laws: str | None,
    driver: str,
    orbits: float | None,
    seed: int,
    workers: int | None,
    out: Path | None,
    settings: tuple[str, ...],
) -> int:
    """Fly every applicable control law on SCENARIO, all else the same: table and picture."""
    from sim.harness.compare import command

    return command.compare(scenario, settings, laws, driver, orbits, seed, workers, out)


@main.command()
@click.option("--row", "rows", multiple=True, metavar="NAME", help="These rows alone, by their first words.")
@click.option("--phases", default=1, show_default=True, type=click.IntRange(min=1), help="Of each row.")
@click.option("--seeds", default=1, show_default=True, type=click.IntRange(min=1), help="Of each phase.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON alone.")
@click.option("--list", "listing", is_flag=True, help="Print the rows and what they expect.")
@click.option("--out", type=click.Path(path_type=Path), help="Folder of faults.xml (JUnit), .html and .json.")
@click.option("--workers", type=click.IntRange(min=1), help="Processes. Default: one a core.")
@click.option("--slow", is_flag=True, help="Also rows that fly real processes: minutes.")
@click.option("--keep", type=click.Path(path_type=Path), help="Rows not flown now: from this faults.json.")
@click.option("--write-docs", is_flag=True, help="Write docs/faults.md of the repository.")
@sentences
def faults(
    rows: tuple[str, ...],
    phases: int,
    seeds: int,
    as_json: bool,
    listing: bool,
    out: Path | None,
    workers: int | None,
    slow: bool,
    keep: Path | None,
    write_docs: bool,
) -> int:
    """Inject every fault of the table, in several phases and seeds: verdict per row."""
    from sim.harness.faults import command

    if listing:
        return command.list_rows(rows)
    return command.faults(rows, phases, seeds, as_json, out, workers, write_docs, slow, keep)


@main.command()
@click.argument("scenario", default="microsat")
@click.option("--bus", default="auto", show_default=True, help=BUSES)
@click.option("--real", metavar="A,B", help="Boards that are hardware: of coil, magnetometer, sun.")
@click.option("--arm", is_flag=True, help="Let coils be driven; without it no request reaches the bus.")
@click.option(
    "--seconds",
    default=60.0,
    show_default=True,
    type=click.FloatRange(0.0, 1e6, min_open=True),
    help="How long.",
)
@click.option("--tick-hz", type=click.IntRange(1, 100), help="Ticks a second. Default: the scenario's.")
@click.option(
    "--stimulus", default="plant", show_default=True, help="What sensors see: plant, RUN, LOG or FILE.toml."
)
@click.option("--jitter-ms", default=10.0, show_default=True, help="Budget of SYNC's jitter, p99.")
@click.option("--latency-ms", type=float, help="Budget of SYNC to TICK_DONE, p99. Default: half a tick.")
@click.option("--slips", default=0, show_default=True, help="Budget of ticks without answer or sample.")
@click.option("--load-percent", default=50.0, show_default=True, help="Budget of the bus load, mean.")
@click.option(
    "--memory-percent", default=2.0, show_default=True, help="Budget of each process' growth once warm."
)
@click.option(
    "--warm-s",
    default=60.0,
    show_default=True,
    type=click.FloatRange(0.0),
    help="Memory is judged from then on, if the run is longer.",
)
@click.option(
    "--deadman-s",
    default=5.0,
    show_default=True,
    type=click.FloatRange(0.1, 3600.0),
    help="The coil board's dead-man.",
)
@click.option(
    "--conformance",
    type=click.Choice(["coil", "magnetometer", "sun"]),
    help="Instead, check one board, alone on the bus, against docs/icd.md; its limits are SCENARIO's.",
)
@click.option("--seed", default=1, show_default=True, type=SEEDS, help="Of the plant.")
@click.option("--out", type=click.Path(path_type=Path), help="Keep log and numbers in this folder.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON alone.")
@SETTINGS
@sentences
def hil(
    scenario: str,
    bus: str,
    real: str | None,
    arm: bool,
    seconds: float,
    tick_hz: int | None,
    stimulus: str,
    jitter_ms: float,
    latency_ms: float | None,
    slips: int,
    load_percent: float,
    memory_percent: float,
    warm_s: float,
    deadman_s: float,
    conformance: str | None,
    seed: int,
    out: Path | None,
    as_json: bool,
    settings: tuple[str, ...],
) -> int:
    """SCENARIO in real time: flight software against boards, each its own process or real hardware."""
    from sim.harness.scenario import load, parse_settings

    rate = (f"time.tick_hz={tick_hz}",) if tick_hz is not None else ()
    chosen = load(scenario, parse_settings((*settings, *rate)))
    if conformance is not None and out is not None:
        raise HarnessError("--out: a conformance run keeps no log")
    if conformance is not None:
        from sim.harness.hil.conformance_command import conformance as conform

        return conform(chosen, conformance, bus, arm, deadman_s, as_json)
    from sim.harness.hil import command
    from sim.harness.hil.verdict import Budgets

    half_ms = 500.0 / chosen.time.tick_hz
    latency = half_ms if latency_ms is None else latency_ms
    budgets = Budgets(jitter_ms, latency, slips, load_percent, memory_percent)
    boards = command.real_boards(real)
    bench = command.Bench(chosen, bus, boards, arm, seconds, stimulus, deadman_s, budgets, warm_s, seed, out)
    return command.hil(bench, as_json)


if __name__ == "__main__":
    main()
