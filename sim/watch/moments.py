"""What frames have shown, moment after moment of the satellite's time, for programs."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import inf
from time import monotonic

from fsw.core.algebra.quaternion import Quaternion
from fsw.core.algebra.vector import Vec3
from fsw.wire.frame import Frame
from fsw.wire.messages import Mode, Sync
from sim.watch.flight_view import FlightView
from sim.watch.happening import Occurrence
from sim.watch.source import FrameSource


@dataclass(frozen=True, slots=True)
class WatchedMoment:
    """What is known at one moment; None where nothing is.

    Attributes:
        tick: the last one.
        unix_s: its time.
        mode: of the flight software.
        q_body_from_orbit: attitude as estimated, scalar first; None while it is not valid.
        omega_body_orbit_radps: estimated rate relative to the orbital frame, body axes.
        turn_deg: angle of the estimated attitude from nominal.
        sigma3_deg: three standard deviations of it.
        rate_degps: size of the estimated rate.
        field_off_deg: angle between the measured field and that which the estimate predicts.
        sun_off_deg: the same of the Sun.
        levels: of the pulse under way, by coil.
        current_ma: of the coil that is driven.
        pulses: how many so far.
        refused: requests that the coil board has refused so far.
        bus_load: part of what the bus can carry.
        happenings: what has happened since the moment before.
        ended: whether the flight is over.
    """

    tick: int | None
    unix_s: int | None
    mode: Mode | None
    q_body_from_orbit: Quaternion | None
    omega_body_orbit_radps: Vec3 | None
    turn_deg: float | None
    sigma3_deg: float | None
    rate_degps: float | None
    field_off_deg: float | None
    sun_off_deg: float | None
    levels: tuple[int, int, int]
    current_ma: int
    pulses: int
    refused: int
    bus_load: float
    happenings: tuple[Occurrence, ...]
    ended: bool


def moments(
    source: FrameSource, view: FlightView, every_s: float = 1.0, silent_s: float = inf
) -> Iterator[WatchedMoment]:
    """A moment every so many seconds of the satellite's time, whole ticks each, and one at the end.

    Args:
        source: of the frames.
        view: takes them.
        every_s: time between two moments, by SYNC, whose times are whole seconds.
        silent_s: a source that sends nothing for so long is at its end.
    """
    happenings: list[Occurrence] = []
    last_s: float | None = None
    heard_s, pending = monotonic(), False
    for batch in source.batches():
        for frame, time_s in batch.frames:
            if frame.can_id == Sync.ID and view.unix_s is not None and _is_due(view.unix_s, last_s, every_s):
                yield _moment(view, happenings)
                last_s, happenings, pending = view.unix_s, [], False
            happenings += _taken(view, frame, time_s)
            pending = True
        view.load.pass_time(batch.now_s)
        heard_s = monotonic() if batch.frames else heard_s
        if monotonic() - heard_s > silent_s:
            break
    if pending:
        yield _moment(view, happenings)


def _is_due(unix_s: int, last_s: float | None, every_s: float) -> bool:
    """Whether a moment is due; where time goes back, as from one flight to the next in a log, it is."""
    return last_s is None or unix_s >= last_s + every_s or unix_s < last_s


def _taken(view: FlightView, frame: Frame, time_s: float) -> list[Occurrence]:
    """Take a frame; what happened by it."""
    before = view.happened
    view.take(frame, time_s)
    new = view.happened - before
    return list(view.happenings)[-new:] if new else []


def _moment(view: FlightView, happenings: list[Occurrence]) -> WatchedMoment:
    sample, coils = view.sample(), view.coils
    one, two, three = coils.levels
    return WatchedMoment(
        tick=view.tick,
        unix_s=view.unix_s,
        mode=view.mode,
        q_body_from_orbit=view.attitude,
        omega_body_orbit_radps=view.omega_body_orbit_radps,
        turn_deg=None if sample is None else sample.turn_deg,
        sigma3_deg=None if sample is None else sample.sigma3_deg,
        rate_degps=None if sample is None else sample.rate_degps,
        field_off_deg=None if sample is None else sample.field_off_deg,
        sun_off_deg=None if sample is None else sample.sun_off_deg,
        levels=(one, two, three),
        current_ma=coils.current_ma,
        pulses=coils.pulses,
        refused=coils.refused,
        bus_load=view.load.part,
        happenings=tuple(happenings),
        ended=view.ended,
    )
