"""A flight that is recorded: the plant on a bus, its log, histories and strangers kept in a run directory."""

from collections.abc import Callable
from pathlib import Path

from fsw.bus.interface import Bus
from fsw.wire.frame import Frame
from sim.errors import HarnessError
from sim.faults.section import make_plant
from sim.flight.answers import Patience
from sim.flight.flight import Watch, fly
from sim.flight.second_senders import SenderWatch
from sim.record import run_dir
from sim.record.bus_log import BusLog
from sim.record.pace import Pace
from sim.record.truth import TruthFile
from sim.scenario.assemble import plant_config
from sim.scenario.schema import Scenario, flight_table, orbit_period_s
from sim.scenario.telecommands import uplink

MOST_TICKS = 2**24 - 1
"""What PLANT_END can tell."""


def ticks_of(scenario: Scenario, orbits: float | None) -> int:
    """How many ticks a flight of so many orbits takes; None: as the scenario says. At least one.

    Raises:
        HarnessError: more than a run can have.
    """
    ticks_per_orbit = orbit_period_s(scenario) * scenario.time.tick_hz
    chosen = scenario.time.orbits if orbits is None else orbits
    if not chosen * ticks_per_orbit <= MOST_TICKS:  # not a number, either
        option = f"time.orbits={chosen:g}" if orbits is None else f"--orbits {chosen:g}"
        most = MOST_TICKS / ticks_per_orbit
        raise HarnessError(f"{option}: a run has at most {MOST_TICKS} ticks, here {most:.0f} orbits")
    return max(1, round(chosen * ticks_per_orbit))


def check_flyable(scenario: Scenario, seed: int) -> None:
    """Build plant and flight software once, before a run is begun that one of them could not fly.

    Raises:
        TableError: why not.
    """
    from fsw.table.config import flight_config  # noqa: PLC0415  (the plant's process has no flight software)

    flight_config(flight_table(scenario))
    check_plant(scenario, seed)


def check_plant(scenario: Scenario, seed: int) -> None:
    """The same of the plant alone."""
    make_plant(plant_config(scenario, seed), scenario.fault)


def record(
    path: Path,
    scenario: Scenario,
    bus: Bus,
    watch: Watch = lambda tick: None,
    patience: Patience | None = None,
    waiting: Callable[[float], None] = lambda waited_s: None,
) -> None:
    """Fly the run that ``path`` was begun for, and keep there its log, its histories, and who else spoke.

    Args:
        path: of the run.
        scenario: its own.
        bus: to fly on; it is closed.
        watch: told the tick, now and then.
        patience: how long the flight software is waited for; None: until it boots for ever.
        waiting: told every second how long that has lasted.

    Raises:
        FlightError: the flight software gives no answer.
        BusError: the bus failed.
    """
    run = run_dir.read_run(path)
    plant = make_plant(plant_config(scenario, run["seed"]), scenario.fault)
    pace = Pace(run["pace_factor"])
    senders = SenderWatch(lockstep=pace.factor is None)

    def keep_senders() -> None:
        run_dir.update(path, second_senders=[sender.as_json() for sender in senders.found])

    def overhear(tick: int, before: list[Frame], answers: list[Frame], again: bool) -> None:
        if senders.take(tick, before, answers, again):
            keep_senders()

    try:
        with (
            BusLog(path / run_dir.BUS_LOG, bus.name) as log,
            TruthFile(path / run_dir.TRUTH, run["ticks"], plant.torque_sources) as truth,
        ):
            flown = fly(
                plant,
                bus,
                log,
                truth,
                run["ticks"],
                scenario.epoch_unix_s,
                scenario.time.tick_hz,
                pace,
                watch,
                uplink(scenario.telecommand, scenario.time.tick_hz),
                patience,
                overhear,
                waiting,
            )
    finally:
        bus.close()
        if senders.found:  # how many frames, in the end
            keep_senders()
    run_dir.update(
        path,
        flown={"ticks": flown.ticks, "slips": flown.slips, "wall_s": flown.wall_s},
        **{run_dir.DIGESTS: {run_dir.BUS_LOG: log.sha256}},
    )
