"""The histories of a run as a table: the plant's, and the estimates of a replay, tick by tick."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fsw.core.state import FlightState
from fsw.table.config import flight_config
from fsw.wire.messages import Mode
from sim.export.source import Source, histories
from sim.faults.section import forge_answers
from sim.progress import Watch
from sim.record.estimates import Estimates
from sim.record.truth import COLUMNS, OF_WHEEL, Histories, TruthReader
from sim.replay.log_replay import ReplayResult, replay
from sim.report.figures.histories import FlightHistories, HistoryBlocks
from sim.scenario.schema import flight_table
from sim.value_types import Array

AXES = {1: ("",), 3: ("_x", "_y", "_z"), 4: ("_w", "_x", "_y", "_z")}
"""Endings of the columns of a quantity, by its width; of a quaternion the scalar is w."""


@dataclass(frozen=True, slots=True)
class HistoryQuantity:
    """A column of the table, or several side by side.

    Attributes:
        name: with its unit, as everywhere in this project.
        width: columns.
        unit: as UDUNITS writes it.
        meaning: in words.
    """

    name: str
    width: int
    unit: str
    meaning: str

    @property
    def columns(self) -> tuple[str, ...]:
        """The names of its columns."""
        return tuple(self.name + axis for axis in AXES[self.width])


MODES = ", ".join(f"{mode.value} {mode.name}" for mode in Mode)

_Derived = Callable[[FlightHistories], Array]
_DERIVED: tuple[tuple[HistoryQuantity, _Derived], ...] = (
    (
        HistoryQuantity("pointing_deg", 1, "degree", "angle of the attitude from nominal"),
        lambda h: h.pointing_deg,
    ),
    (
        HistoryQuantity("axis1_deg", 1, "degree", "angle of axis 1, that looks up, from the vertical"),
        lambda h: h.axis1_deg,
    ),
    (
        HistoryQuantity("estimate_q_body_from_orbit", 4, "1", "estimated attitude, scalar first"),
        lambda h: h.estimates.q_body_from_orbit,
    ),
    (
        HistoryQuantity(
            "estimate_omega_body_orbit_radps", 3, "rad/s", "estimated rate, as omega_body_orbit_radps"
        ),
        lambda h: h.estimates.omega_body_orbit_radps,
    ),
    (
        HistoryQuantity("estimate_error_deg", 1, "degree", "angle between estimated and true attitude"),
        lambda h: h.attitude_error_deg,
    ),
    (
        HistoryQuantity(
            "estimate_sigma3_deg", 1, "degree", "three sigma of the estimated attitude, all axes"
        ),
        lambda h: h.sigma3_deg(0),
    ),
    (
        HistoryQuantity("estimate_rate_error_degps", 1, "degree/s", "error of the estimated rate"),
        lambda h: h.rate_error_degps,
    ),
    (
        HistoryQuantity(
            "estimate_sigma3_rate_degps", 1, "degree/s", "three sigma of the estimated rate, all axes"
        ),
        lambda h: h.sigma3_deg(3),
    ),
)
_REPLAYED: tuple[tuple[HistoryQuantity, Callable[[Estimates], NDArray[np.generic]]], ...] = (
    (HistoryQuantity("estimate_valid", 1, "1", "1 where the attitude is called valid"), lambda e: e.valid),
    (HistoryQuantity("mode", 1, "1", f"mode of the flight software: {MODES}"), lambda e: e.mode),
)

Block = dict[str, Array]
"""Some ticks of every quantity, by name: (n,) or (n, width); NaN where there is none."""
Take = Callable[[Block], None]


class HistoryTable:
    """The quantities of a run, block by block, so that memory does not grow with the flight.

    Attributes:
        quantities: in order.
        ticks: rows that there will be.

    Raises:
        HarnessError: the run has no histories, or they are damaged.
    """

    def __init__(self, source: Source) -> None:
        self._source = source
        self._path, self._scenario = histories(source)
        with TruthReader(self._path) as truth:
            self.ticks = truth.complete
            names = tuple(truth.rows(0, 0))
        known = {
            name: HistoryQuantity(name, width, unit, meaning)
            for name, width, unit, meaning in (*COLUMNS, OF_WHEEL)
        }
        self._truth = {name: known.get(name) or _torque(name) for name in names}
        self.quantities = (
            *self._truth.values(),
            *(quantity for quantity, _ in _DERIVED),
            *(quantity for quantity, _ in _REPLAYED),
        )

    def read(self, take: Take, watch: Watch) -> list[str]:
        """Replay the log, and hand over block after block; what is incomplete, in sentences.

        Raises:
            HarnessError: log or histories cannot be read.
        """
        config = flight_config(flight_table(self._scenario))
        last_tick = -1
        with TruthReader(self._path) as truth:

            def take_block(rows: Histories, estimates: Estimates) -> None:
                take(self._block(rows, estimates, last_tick))

            blocks = HistoryBlocks(truth, take_block)

            def on_tick(state: FlightState) -> None:
                nonlocal last_tick
                blocks.take(state)
                last_tick = state.tick
                watch(state.tick)

            result = replay(self._source.log, config, on_tick, forge_answers(self._scenario.fault))
            blocks.finish()
        return self._notes(result, last_tick + 1)

    def _block(self, truth: Histories, estimates: Estimates, last_tick: int) -> Block:
        flight = FlightHistories(truth, estimates, self._scenario.body.law_axes)
        block = {quantity.name: truth[name] for name, quantity in self._truth.items()}
        block |= {quantity.name: derive(flight) for quantity, derive in _DERIVED}
        replayed = np.round(truth["t_s"] * self._scenario.time.tick_hz) <= last_tick
        for quantity, pick in _REPLAYED:
            block[quantity.name] = np.where(replayed, pick(estimates), np.nan)
        return block

    def _notes(self, result: ReplayResult, replayed: int) -> list[str]:
        notes = []
        planned = 0 if self._source.record is None else self._source.record["ticks"]
        if not result.ended:
            how = "inside a line" if result.cut else "without its end mark"
            notes.append(
                f"the flight was cut short: of {planned} ticks the histories have {self.ticks}, the log "
                f"{replayed}; it ends {how} after line {result.end_line}"
            )
        if result.first_bit_difference is not None:
            notes.append(f"the estimates are those of a replay that differs: {result.first_bit_difference}")
        return notes


def _torque(name: str) -> HistoryQuantity:
    source = name.rpartition("/")[2]
    return HistoryQuantity(name.replace("/", "_"), 3, "N m", f"torque by {source}, body axes")
