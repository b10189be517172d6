"""Records a flight: bus log, histories and second senders go into the run directory."""

from collections.abc import Callable
from pathlib import Path

from fsw.bus.interface import Bus
from fsw.table.flown_elements import check_tle
from fsw.wire.frame import Frame
from sim.errors import HarnessError
from sim.faults.section import make_plant
from sim.flight.flight_loop import ProgressCallback, fly
from sim.flight.fsw_answers import Patience
from sim.flight.second_senders import SenderWatch
from sim.record import run_dir
from sim.record.bus_log import BusLog
from sim.record.pace import Pace
from sim.record.truth import TruthFile
from sim.scenario.assemble import effects_of, plant_config
from sim.scenario.schema import Scenario, flight_table, orbit_period_s
from sim.scenario.telecommands import uplink

MOST_TICKS = 2**32 - 1
"""The largest tick of SYNC; PLANT_END counts modulo 2^24."""
MOST_IN_MEMORY = 2**24 - 1
"""Ticks of a flight whose histories are kept in memory."""


def ticks_of(scenario: Scenario, orbits: float | None, most: int = MOST_TICKS) -> int:
    """How many ticks a flight of ``orbits`` takes; None: as many as the scenario says. At least one.

    Raises:
        HarnessError: more than ``most``, or the orbit's elements do not hold so long.
    """
    ticks_per_orbit = orbit_period_s(scenario) * scenario.time.tick_hz
    chosen = scenario.time.orbits if orbits is None else orbits
    if not chosen * ticks_per_orbit <= most:  # NaN does not pass either
        option = f"time.orbits={chosen:g}" if orbits is None else f"--orbits {chosen:g}"
        most_orbits = most / ticks_per_orbit
        raise HarnessError(f"{option}: a run has at most {most} ticks, here {most_orbits:.0f} orbits")
    ticks = max(1, round(chosen * ticks_per_orbit))
    check_elements(scenario, ticks)
    return ticks


def check_elements(scenario: Scenario, ticks: int) -> None:
    """Check that the elements of a scenario are those of an orbit during a flight of so many ticks.

    Raises:
        HarnessError: when and why they are not.
    """
    begin_s = scenario.epoch_unix_s
    try:
        check_tle(scenario.orbit.tle, begin_s, begin_s + ticks / scenario.time.tick_hz)
    except ValueError as error:
        raise HarnessError(f"scenario {scenario.name}: {error}") from None


def check_can_fly(scenario: Scenario, seed: int) -> None:
    """Check that plant and flight software can be built, before the run is begun.

    Raises:
        TableError: why not.
    """
    from fsw.table.config import flight_config  # noqa: PLC0415  (the plant's process has no flight software)

    flight_config(flight_table(scenario), f"scenario {scenario.name}")
    check_plant(scenario, seed)


def check_plant(scenario: Scenario, seed: int) -> None:
    """The same for the plant alone."""
    make_plant(plant_config(scenario, seed), scenario.fault, effects_of(scenario))


def record_flight(
    path: Path,
    scenario: Scenario,
    bus: Bus,
    watch: ProgressCallback | None = None,
    patience: Patience | None = None,
    waiting: Callable[[float], None] | None = None,
    alone: bool = False,
) -> None:
    """Fly a run that was begun, and record its log, its histories and its second senders.

    Args:
        path: the run directory.
        scenario: of the run.
        bus: to fly on; it is closed.
        watch: called with the tick every ``WATCH_TICKS`` ticks.
        patience: how long to wait for the flight software; None: without limit until it boots.
        waiting: called at each request until the flight software boots, with the time waited [s].
        alone: no other node can be on the bus, so that second senders need not be looked for.

    Raises:
        FlightError: the flight software gives no answer.
        BusError: the bus failed.
    """
    run = run_dir.read_run(path)
    log_name = run_dir.COMPRESSED_LOG if run.get("compressed") else run_dir.BUS_LOG
    plant = make_plant(plant_config(scenario, run["seed"]), scenario.fault, effects_of(scenario))
    pace = Pace(run["pace_factor"])
    senders = SenderWatch(lockstep=pace.factor is None, may_boot="flight_software" in run)
    identity, wheel = run_dir.identity(scenario, run["seed"]), scenario.wheel is not None

    def store_senders() -> None:
        run_dir.update(path, second_senders=[sender.as_json() for sender in senders.found])

    def overhear(tick: int, before: list[Frame], answers: list[Frame], again: bool) -> None:
        if senders.take(tick, before, answers, again):
            store_senders()

    try:
        with (
            BusLog(path / log_name, bus.name) as log,
            TruthFile(path / run_dir.TRUTH, run["ticks"], plant.torque_sources, identity, wheel) as truth,
        ):
            outcome = fly(
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
                None if alone else overhear,
                waiting,
            )
    finally:
        bus.close()
        if senders.found:  # their final counts of frames
            store_senders()
    run_dir.update(
        path,
        flown={"ticks": outcome.ticks, "slips": outcome.slips, "wall_s": outcome.wall_s},
        **{run_dir.DIGESTS: {run_dir.BUS_LOG: log.sha256}},
    )
