"""The record of a flight with a fault, from which it is judged."""

from dataclasses import dataclass, field
from math import acos, degrees, isfinite

from fsw.core.algebra.vector import Vec3, dot
from fsw.core.estimation.cells.prediction import LEAST_COSINE
from fsw.core.state import FlightState
from fsw.wire.frame import Frame
from fsw.wire.messages import (
    CoilBoot,
    CoilEvent,
    CoilFire,
    CoilRefused,
    CoilStatus,
    FswEvent,
    Mode,
    Sync,
    TickDone,
    intact,
)
from sim.fault_rig.currents import CurrentPulse
from sim.plant.coil_drive import CoilDrive
from sim.plant.truth_row import TruthRow
from sim.record.candump import LogEntry

_AUDITED = frozenset((CoilStatus.ID, CoilBoot.ID, Sync.ID))
US = 1_000_000


@dataclass(frozen=True, slots=True)
class ReportedEvent:
    """An FSW_EVENT."""

    tick: int
    number: int
    argument: int


@dataclass(frozen=True, slots=True)
class BoardEvent:
    """A COIL_EVENT, with the coil that was on; None: none was."""

    tick: int
    number: int
    coil: int | None


@dataclass(slots=True)
class FaultFlightRecord:
    """The record of a flight, tick by tick.

    Attributes:
        tick_hz: ticks a second.
        cell_normals_body: of the Sun cells; empty without cells.
        onset: tick in which the first fault begins; None if none did.
        end: first tick without any; None if one is permanent.
        entries: SYNC, COIL_STATUS and COIL_BOOT as plant and board sent them.
        coil_drives: the currents that the plant drove in each tick.
        pulses_by_time: pulses of a board with a clock of its own, over true time; otherwise none.
        request_ticks: ticks in which fsw sent COIL_FIRE.
        request_coils: the coils of these requests.
        boots: ticks in which fsw booted.
        restarts: ticks in which fsw concluded that the plant has restarted.
        requests_before: by restart, how many requests fsw had sent by then.
        ended: tick in which fsw ended the run; None if it never did.
        refused: number of COIL_REFUSED.
        error_deg: true error of the estimate; None where fsw has no valid one.
        lit: by tick, whether the Sun shines on the satellite.
        lit_cells: by tick, the numbers of the Sun cells, from 1, on which it shines more than grazingly.
        modes: by tick; None while fsw does not run.
        events: FSW_EVENT.
        board_events: COIL_EVENT.
        unfired_s: how long a pulse was awaited in vain [s]; None if none was missed.
        crash: exception that a step raised; None if none did.
        not_finite: first tick with a number in the state that is not finite.
        unanswered: ticks whose SYNC reached a running fsw and was not answered.
        done: by tick, whether fsw has answered it with its TICK_DONE.
        worst_answer: most frames in one answer.
        worst_step_s: longest time that one answer took.
        rejected: frames that fsw's gate has rejected.
    """

    tick_hz: int
    cell_normals_body: tuple[Vec3, ...] = ()
    onset: int | None = None
    end: int | None = None
    entries: list[LogEntry] = field(default_factory=list)
    coil_drives: list[CoilDrive] = field(default_factory=list)
    pulses_by_time: list[CurrentPulse] = field(default_factory=list)
    request_ticks: list[int] = field(default_factory=list)
    request_coils: list[int] = field(default_factory=list)
    boots: list[int] = field(default_factory=list)
    restarts: list[int] = field(default_factory=list)
    requests_before: list[int] = field(default_factory=list)
    ended: int | None = None
    refused: int = 0
    error_deg: list[float | None] = field(default_factory=list)
    lit: list[bool] = field(default_factory=list)
    lit_cells: list[tuple[int, ...]] = field(default_factory=list)
    modes: list[Mode | None] = field(default_factory=list)
    events: list[ReportedEvent] = field(default_factory=list)
    board_events: list[BoardEvent] = field(default_factory=list)
    unfired_s: float | None = None
    crash: str | None = None
    not_finite: int | None = None
    unanswered: list[int] = field(default_factory=list)
    done: list[bool] = field(default_factory=list)
    worst_answer: int = 0
    worst_step_s: float = 0.0
    rejected: int = 0

    @property
    def ticks(self) -> int:
        """Number of complete ticks."""
        return len(self.coil_drives)

    def note_sent(self, tick: int, epoch_us: int, frames: list[Frame]) -> None:
        """Note the frames that plant and boards sent in a tick."""
        stamp = epoch_us + tick * US // self.tick_hz
        on: int | None = None
        for frame in frames:
            if frame.can_id == CoilStatus.ID:
                status = CoilStatus.decode(frame.data)
                on = status.coil if status.level else None
            elif frame.can_id == CoilEvent.ID:
                self.board_events.append(BoardEvent(tick, CoilEvent.decode(frame.data).event, on))
            if frame.can_id in _AUDITED:
                self.entries.append(LogEntry(len(self.entries) + 1, stamp, "virtual", frame))
            self.refused += frame.can_id == CoilRefused.ID

    def note_answer(self, tick: int, frames: list[Frame]) -> None:
        """Note the frames that fsw sent in a tick."""
        self.worst_answer = max(self.worst_answer, len(frames))
        done = [TickDone.decode(frame.data).tick for frame in frames if frame.can_id == TickDone.ID]
        self.done.append(tick in done)
        for frame in frames:
            if frame.can_id == CoilFire.ID and intact(frame):
                self.request_ticks.append(tick)
                self.request_coils.append(CoilFire.decode(frame.data).coil)
            elif frame.can_id == FswEvent.ID:
                event = FswEvent.decode(frame.data)
                self.events.append(ReportedEvent(tick, event.event, event.argument))

    def note_state(self, tick: int, state: FlightState | None, truth: TruthRow) -> None:
        """Note the light and the mode of fsw in a tick, and the error of its estimate against the truth."""
        started = state is not None and state.tick >= 0
        self.lit.append(truth.lit > 0.0)
        light = [truth.lit * dot(normal, truth.sun_body) for normal in self.cell_normals_body]
        self.lit_cells.append(tuple([cell for cell, one in enumerate(light, 1) if one > LEAST_COSINE]))
        self.modes.append(state.modes.mode if state is not None and started else None)
        valid = state is not None and started and state.attitude.valid
        self.error_deg.append(_error_deg(state, truth) if state is not None and valid else None)
        if state is not None and self.not_finite is None and not finite(state):
            self.not_finite = tick


def finite(state: FlightState) -> bool:
    """Whether all numbers that fsw uses are finite."""
    numbers = (
        *state.attitude.q_body_from_orbit,
        *state.attitude.omega_body_orbit_radps,
        *state.pulses.pending_impulse_body_nms,
        *state.sample.b_body_t,
        *state.coil.driven_am2,
    )
    return isfinite(sum(numbers))


def _error_deg(state: FlightState, truth: TruthRow) -> float:
    pairs = zip(state.attitude.q_body_from_orbit, truth.q_body_from_orbit, strict=True)
    cosine = abs(sum(a * b for a, b in pairs))
    return degrees(2.0 * acos(min(1.0, cosine)))
