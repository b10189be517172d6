"""Hypothesis strategies for the flights of a scheduler or a law; each shrinks to something simple."""

from functools import cache
from itertools import product
from math import cos, inf, nan, sin, sqrt

from hypothesis import strategies as st
from hypothesis.strategies import DrawFn, SearchStrategy

from fsw.core.algebra.vector import ZERO, Vec3
from fsw.core.estimation.attitude import UNKNOWN, Attitude
from sim.testing.scheduler_flight import Flight, Limits, Reboot, Stretch

WHOLE_RATES = (1, 2, 5, 10, 1000)
BROKEN_RATES = (3, 7, 30, 64, 300)
"""Ticks a second: with a tick of a whole number of milliseconds, and without."""
SLOW_TIMINGS_MS = ((3000, 100_000), (3000, 10_000), (2900, 7301))
FAST_TIMINGS_MS = ((300, 999), (301, 2003))
"""Pulse and back-off, up to ``MOST_SLOW_HZ`` and above; the first is that of the default satellite."""
MOST_SLOW_HZ = 10
PULSES_TICKS = (1, 2, 3)
BACKOFFS_TICKS = (1, 2, 3, 4, 6, 8)
"""Lengths in whole ticks of the short timings."""
SIZES_AM2 = (8.0, 2.0, 0.5, 1e-9)
MOST_DIPOLE_AM2 = 50.0
MOST_FIELD_T = 6.5e-5
EQUAL = (0.0, 1.0, -1.0, 0.5)
"""Factors of components of equal size or value."""
SIZES_T = (3e-5, MOST_FIELD_T)
MOST_RATE_RADPS = 0.2
MOST_STRETCHES = 8
MOST_CYCLES = 30
"""Cycles of pulse and back-off in one stretch of a long flight."""
MOST_PULSES = 2000
"""Pulses in the longest of long flights, if each is fired as soon as it may be."""
MOST_TICKS = 12_000
"""Length of a long flight where back-offs are long."""
MOST_EVENTFUL_TICKS = 4000
"""Length of a flight of several laps that is not a long one."""
WORD_BITS = (8, 15, 16, 24, 31)
"""Word lengths that a tick number may outgrow; a float of 32 bits holds 24 bits."""

_LOST = st.sampled_from((0, 0, 0, 0, 0xFF)) | st.sampled_from((0, 0, 0, 0, 0xFF)) | st.integers(0, 0xFF)
_SELDOM_LOST = st.sampled_from((0, 0, 0, 0b1, 0b01010101, 0xFF))
_REBOOTS = st.sampled_from(
    (
        Reboot.NOBODY,
        Reboot.SCHEDULER,
        Reboot.SCHEDULER,
        Reboot.BOARD,
        Reboot.SCHEDULER | Reboot.BOARD,
    )
)


def tick_rates() -> SearchStrategy[int]:
    """Ticks a second."""
    return st.sampled_from(WHOLE_RATES) | st.sampled_from(BROKEN_RATES)


@cache
def timings_ms(tick_hz: int) -> SearchStrategy[tuple[int, int]]:
    """Pulse and back-off: of few ticks and a part of one more, or as in flight.

    Where they are of few ticks, a long flight holds many pulses.
    """
    part_ms = 1000 // tick_hz - 1
    parts_ms = sorted({0, part_ms // 2, part_ms})
    pulses_ms = [_at_least_ms(ticks, tick_hz) + part for ticks in PULSES_TICKS for part in parts_ms]
    backoffs_ms = [_at_least_ms(ticks, tick_hz) + part for ticks in BACKOFFS_TICKS for part in parts_ms]
    short = st.sampled_from(list(product(pulses_ms, backoffs_ms)))
    return short | st.sampled_from(SLOW_TIMINGS_MS if tick_hz <= MOST_SLOW_HZ else FAST_TIMINGS_MS)


@st.composite
def limits(
    draw: DrawFn,
    tick_hz: SearchStrategy[int] | None = None,
    timing_ms: SearchStrategy[tuple[int, int]] | None = None,
    shared: SearchStrategy[bool] | None = None,
) -> Limits:
    """Limits: of every rate and both kinds of back-off, as in flight and shorter, unless given."""
    hz = draw(tick_hz if tick_hz is not None else tick_rates())
    pulse_ms, backoff_ms = draw(timing_ms if timing_ms is not None else timings_ms(hz))
    return Limits(hz, pulse_ms, backoff_ms, draw(shared if shared is not None else st.booleans()))


@cache
def dipoles(most_am2: float = MOST_DIPOLE_AM2) -> SearchStrategy[Vec3]:
    """A demand, body axes, A m^2: none, along an axis, with components of equal size or value, or any."""
    sizes = [size for size in SIZES_AM2 if size < most_am2]
    return st.just(ZERO) | _vectors((*sizes, most_am2), most_am2)


@st.composite
def unsound_dipoles(draw: DrawFn) -> Vec3:
    """A demand with a component that is no number, or infinite."""
    unsound = draw(st.sampled_from((nan, inf, -inf)))
    x, y, z = draw(dipoles())
    return draw(st.sampled_from(((unsound, y, z), (x, unsound, z), (x, y, unsound))))


@cache
def fields() -> SearchStrategy[Vec3]:
    """A magnetic field, body axes, T: along an axis, with components of equal size, none at all, or any."""
    return _vectors(SIZES_T, MOST_FIELD_T)


@cache
def attitudes() -> SearchStrategy[Attitude]:
    """An attitude and rate relative to the orbital frame, valid or not."""
    rate = st.floats(-MOST_RATE_RADPS, MOST_RATE_RADPS)
    return st.just(UNKNOWN) | st.builds(
        _attitude,
        st.floats(0.0, 3.15),
        st.floats(-1.0, 1.0),
        st.floats(0.0, 6.3),
        rate,
        rate,
        rate,
        st.booleans(),
    )


@st.composite
def stretches(  # noqa: D417, draw is Hypothesis's own
    draw: DrawFn,
    within: Limits,
    demands: SearchStrategy[Vec3] | None = None,
    calm: bool = False,
    losses: bool = True,
) -> Stretch:
    """Some ticks with one demand; many end in a pulse, so that the next stretch begins in one.

    Args:
        within: the limits.
        demands: the demands on the scheduler; default: ``dipoles()``.
        calm: nothing reboots, fewer messages are lost, and there may be many pulses.
        losses: messages may be lost.
    """
    lost = st.just(0) if not losses else _SELDOM_LOST if calm else _LOST
    return Stretch(
        ticks=draw(_stretch_ticks(within, calm)),
        m_body_am2=draw(demands if demands is not None else dipoles()),
        b_body_t=draw(fields()),
        attitude=draw(attitudes()),
        reboot=Reboot.NOBODY if calm else draw(_REBOOTS),
        lost_statuses=draw(lost),
        lost_requests=draw(lost),
    )


def flights(
    within: SearchStrategy[Limits] | None = None, demands: SearchStrategy[Vec3] | None = None
) -> SearchStrategy[Flight]:
    """Whole flights: eventful ones, and long calm ones that hold up to ``MOST_PULSES`` pulses.

    Args:
        within: limits; default: ``limits()``.
        demands: the demands on the scheduler; default: ``dipoles()``.
    """
    one = _flights(within if within is not None else limits(), demands if demands is not None else dipoles())
    return st.lists(one, min_size=1, max_size=1, unique_by=id).map(_only)


def _only(flights: list[Flight]) -> Flight:
    """The one element of a list.

    Hypothesis makes five of six examples as variants of the one before, within the same limits, but not of
    the elements of a unique collection; so each flight differs.
    """
    return flights[0]


@st.composite
def _flights(draw: DrawFn, within: SearchStrategy[Limits], demands: SearchStrategy[Vec3]) -> Flight:
    chosen = draw(within)
    calm, losses = draw(st.booleans()), draw(st.sampled_from((False, True, True)))
    parts = draw(st.lists(stretches(chosen, demands, calm, losses), min_size=1, max_size=MOST_STRETCHES))
    most_ticks = min(MOST_TICKS, MOST_PULSES * _cycle_ticks(chosen)) if calm else MOST_EVENTFUL_TICKS
    most_laps = max(1, most_ticks // sum(part.ticks for part in parts))
    laps = draw(st.integers(1, most_laps) | st.just(most_laps))
    return Flight(chosen, draw(_first_ticks(chosen)), tuple(parts), laps)


def _backoff_ticks(within: Limits) -> int:
    return -(-within.backoff_ms * within.tick_hz // 1000)


def _cycle_ticks(within: Limits) -> int:
    return _backoff_ticks(within) + 2 + within.pulse_ms * within.tick_hz // 1000


@cache
def _stretch_ticks(within: Limits, calm: bool) -> SearchStrategy[int]:
    backoff, cycle = _backoff_ticks(within), _cycle_ticks(within)
    some = st.sampled_from((cycle, 2 * cycle)) | st.integers(1, 2 * cycle)
    if calm:
        return some | st.integers(1, 8) | st.integers(1, min(MOST_CYCLES * cycle, MOST_TICKS))
    until_a_pulse = st.integers(backoff + 1, cycle - 2) | st.integers(backoff + 1, cycle + 2)
    return some | until_a_pulse | until_a_pulse | st.integers(1, 8)


@cache
def _first_ticks(within: Limits) -> SearchStrategy[int]:
    """Any of the first, or one so late that the tick number outgrows a word within some pulses."""
    before = st.integers(1, 2 * _cycle_ticks(within))
    late = st.builds(lambda bits, ticks: max(0, 2**bits - ticks), st.sampled_from(WORD_BITS), before)
    return st.just(0) | st.integers(0, 1000) | late


def _at_least_ms(ticks: int, tick_hz: int) -> int:
    return -(-1000 * ticks // tick_hz)


def _vectors(sizes: tuple[float, ...], most: float) -> SearchStrategy[Vec3]:
    equal = [(size * x, size * y, size * z) for size in sizes for x, y, z in product(EQUAL, repeat=3)]
    component = st.floats(-most, most)
    return st.sampled_from(equal) | st.sampled_from(equal) | st.tuples(component, component, component)


def _attitude(
    angle_rad: float, height: float, azimuth_rad: float, wx: float, wy: float, wz: float, valid: bool
) -> Attitude:
    """Rotated by an angle about an axis that is given by height and azimuth."""
    flat, half = sqrt(1.0 - height * height) * sin(angle_rad / 2.0), sin(angle_rad / 2.0)
    q = (cos(angle_rad / 2.0), flat * cos(azimuth_rad), flat * sin(azimuth_rad), height * half)
    return Attitude(q, (wx, wy, wz), 0.01, 1e-4, valid)
