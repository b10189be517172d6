"""``torquer.fly`` and ``torquer.report``: a flight, and what is made of it."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from os import PathLike
from pathlib import Path
from typing import Annotated

from pydantic import Field, Strict

from fsw.input.own_code import display, given_as, refuse_while_loading
from fsw.input.schema import Section, TableError
from fsw.table.own_law import ONLY_ITS_OWNER, LawError
from sim.audit.findings import AuditReport
from sim.errors import FlightError
from sim.flight.record_flight import check_can_fly, ticks_of
from sim.flight.sil import fly_processes, serve_bus
from sim.flight.virtual import fly_virtual
from sim.progress import Watch, note, shown
from sim.progress import progress as progress_of
from sim.record import run_dir
from sim.record.binding import require_sources, sign_run
from sim.record.pace import parse_pace
from sim.record.run_dir import FigureKind, figure_folder
from sim.record.signature import private_key, signature_path
from sim.report.charts.lines import Lines
from sim.report.conclude import conclude
from sim.report.follow import follow
from sim.scenario.schema import Scenario, expecting, orbit_period_s
from torquer.api.arguments import (
    ScenarioLike,
    Settings,
    checked,
    chosen_scenario,
    optional_path,
    path_text,
    warn_of,
)
from torquer.api.audit import optional_key
from torquer.api.errors import one_sentence
from torquer.api.laws import LawLike, check_two_processes, checked_law, law_given
from torquer.api.run import Run

Flight = Callable[[Path, Watch], None]
"""Flies a run that was begun; called with its directory and what shows the ticks."""


class _FlightOptions(Section):
    orbits: float | None = Field(allow_inf_nan=True)  # judged with the length of an orbit
    seed: int = Field(ge=0, le=2**64 - 1)
    bus: str
    pace: str
    compress: bool
    expect: Annotated[tuple[str, ...], Strict(False)]


@one_sentence
def fly(
    scenario: ScenarioLike = "realsat",
    *,
    orbits: float | None = None,
    seed: int = 1,
    bus: str = "virtual",
    pace: str = "lockstep",
    set: Settings | None = None,
    law: LawLike | None = None,
    expect: Sequence[str] = (),
    out: str | PathLike[str] | None = None,
    compress: bool = False,
    sign: str | PathLike[str] | None = None,
    progress: bool = False,
) -> Run:
    """Fly a scenario, as ``torquer sil`` does, which flies as two processes where no bus is given.

    The same scenario and seed give the same log on every bus, byte for byte. A flight that fails raises
    nothing: ``ok`` and ``failures`` of the run tell. What is most likely wrong in the scenario is said on
    stderr before. Flights may run in several threads at once.

    Args:
        scenario: name of a shipped scenario, path of a file, or a scenario.
        orbits: how long; None: as the scenario says.
        seed: of all random streams.
        bus: ``virtual``: in this process; ``loop``, ``auto``, ``socketcan:NAME``, ``slcan:PORT``: as two.
        pace: ``lockstep``, or ``realtime[:FACTOR]``.
        set: values laid over the scenario by key: ``{"time.tick_hz": 10}`` or ``{"time": {"tick_hz": 10}}``.
        law: ``FILE.py:NAME``, a user law, or an installed one by its name; or the law itself, a
            function or a ``ControlLaw``, which flies on the virtual bus alone; None: the scenario's.
        expect: requirements beside those of the scenario, such as ``ape<2``, judged at the end of the flight.
        out: directory of the run; None: a new one, ``runs/<scenario>-<UTC time>``.
        compress: write the log as ``bus.log.gz``.
        sign: private Ed25519 key in PEM with which the run is signed.
        progress: show progress on stderr.

    Raises:
        InputError: an argument, the scenario, a key of it, or the directory; nothing was flown.
        Error: the flight cannot be concluded.
    """
    options = checked(
        _FlightOptions, "fly", orbits=orbits, seed=seed, bus=bus, pace=pace, compress=compress, expect=expect
    )
    refuse_while_loading("torquer.fly")
    if options.orbits is not None and options.orbits <= 0.0:
        raise TableError(f"fly: orbits = {options.orbits:g} is not allowed: allowed is a number above 0")
    key = None if sign is None else private_key(Path(path_text(sign, "sign")))
    with shown(progress), law_given(law) as named:
        run = _fly(chosen_scenario(scenario, set, named), options, optional_path(out, "out"))
    if key is not None and not run.ended:
        sign_run(run.path, key)
    held = run.law is not None and given_as(str(run.law)) is not None
    return replace(run, law=law) if held else run


def _fly(scenario: Scenario, options: _FlightOptions, folder: Path | None) -> Run:
    """The flight of a scenario whose law can be executed here."""
    pace, ticks = parse_pace(options.pace), ticks_of(scenario, options.orbits)
    scenario = expecting(scenario, options.expect, ticks / scenario.time.tick_hz / orbit_period_s(scenario))
    law = scenario.own_law
    if options.bus != "virtual":
        check_two_processes(scenario, options.bus)
    check_can_fly(scenario, options.seed)
    warn_of(scenario, ticks)
    notes = _notes(law)
    with _flight_on(options.bus, scenario) as (kind, flight):
        path = run_dir.begin(folder, scenario, options.seed, ticks, kind, pace, options.compress)
        if options.bus == "auto":
            note(f"bus: {kind} (auto)")
        for line in notes:
            note(f"note: {line}")
        with follow(path, ticks, law) as conclude_flight:
            try:
                with progress_of(f"flying {scenario.name}", ticks) as watch:
                    flight(path, watch)
            except (FlightError, LawError) as error:
                return Run(path, law, ended=str(error), notes=notes)
            with progress_of("replaying", ticks) as watch:
                conclude_flight(watch)
    return Run(path, law, notes=notes)


def _notes(law: str | None) -> tuple[str, ...]:
    """What a run of this law says of it."""
    if law is None or given_as(law) is None:
        return ()
    return (f"the law is {display(law)}: {ONLY_ITS_OWNER}",)


@contextmanager
def _flight_on(bus: str, scenario: Scenario) -> Iterator[tuple[str, Flight]]:
    """The kind of a bus, and what flies on it."""
    if bus == "virtual":
        yield bus, lambda path, watch: fly_virtual(path, scenario, watch)
        return
    with serve_bus(bus) as (spec, listener):
        yield spec.partition(":")[0], lambda path, watch: fly_processes(path, scenario, spec, listener, watch)


class _ReportOptions(Section):
    figures: FigureKind | None


@one_sentence
def report(
    run: str | PathLike[str],
    *,
    law: LawLike | None = None,
    sign: str | PathLike[str] | None = None,
    verify: str | PathLike[str] | None = None,
    figures: str | None = None,
    progress: bool = False,
) -> Run:
    """Make summary and report of a run again, as ``torquer report`` does; also of one that was cut short.

    Args:
        run: its directory.
        law: the user law that the run flew, named or given again; without it none is executed.
        sign: private Ed25519 key in PEM with which the run is signed.
        verify: public Ed25519 key in PEM; the run must be signed by its private half.
        figures: ``pdf`` or ``svg``: draw the figures of ``run.plot`` into its folder ``figures`` too.
        progress: show progress on stderr.

    Returns:
        The run; its ``notes`` say what of its files does not agree with its digests.

    Raises:
        InputError: the directory holds no run, or one of its files is damaged.
        Error: one of its files is not its own.
    """
    path = Path(path_text(run, "run"))
    kind = checked(_ReportOptions, "report", figures=figures).figures
    drawn: list[Path] = []
    key = None if sign is None else private_key(Path(path_text(sign, "sign")))
    with shown(progress), law_given(law) as named:
        binding = require_sources(path, optional_key(verify))
        before = (path / run_dir.RUN).read_bytes()
        if kind is not None:
            figure_folder(path)
        with progress_of("replaying", run_dir.read_run(path)["ticks"]) as watch:
            conclude(path, watch, named, None if kind is None else partial(_draw, path, kind, drawn))
        if key is not None:
            sign_run(path, key)
        elif signature_path(path / run_dir.RUN).exists() and (path / run_dir.RUN).read_bytes() != before:
            note(f"note: {run_dir.RUN} is no longer what was signed: --sign KEY signs it again")
    notes = tuple(binding.lines)
    return Run(path, checked_law(law), mismatched=not binding.holds, notes=notes, figures=tuple(drawn))


def _draw(
    path: Path, kind: FigureKind, drawn: list[Path], scenario: Scenario, lines: Lines, audit: AuditReport
) -> None:
    from sim.report.charts.drawn_flight import DrawnFlight  # noqa: PLC0415  matplotlib
    from sim.report.paper import write_figures  # noqa: PLC0415  as that

    drawn += write_figures(path, DrawnFlight.of(scenario, lines, audit), kind)
