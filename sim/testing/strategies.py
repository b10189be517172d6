"""Hypothesis strategies of what a scheduler or a law may meet; each shrinks to something plain."""

from math import cos, sin, sqrt

from hypothesis import strategies as st
from hypothesis.strategies import SearchStrategy

from fsw.core.attitude import Attitude
from sim.testing.bench import Flight, Limits, Reboot, Stretch

Vec3 = tuple[float, float, float]

RATES = (1, 2, 3, 5, 7, 10)
TIMINGS_MS = ((3000, 100_000), (3000, 10_000), (2900, 7301))
"""Pulse and back-off: as flown, and short ones that are not whole ticks at every rate."""
MOST_DIPOLE_AM2 = 50.0
MOST_FIELD_T = 6.5e-5
MOST_RATE_RADPS = 0.2
MOST_STRETCHES = 4
_LOST = st.one_of(st.just(0), st.just(0), st.just(0xFF), st.integers(0, 0xFF))


def tick_rates() -> SearchStrategy[int]:
    """Ticks a second."""
    return st.sampled_from(RATES)


def limits(
    tick_hz: SearchStrategy[int] | None = None,
    timing_ms: SearchStrategy[tuple[int, int]] | None = None,
    shared: SearchStrategy[bool] | None = None,
) -> SearchStrategy[Limits]:
    """Limits: of every rate and both kinds of back-off, as flown and shorter, unless told."""
    timings = timing_ms if timing_ms is not None else st.sampled_from(TIMINGS_MS)
    return st.builds(
        lambda hz, timing, both: Limits(hz, timing[0], timing[1], both),
        tick_hz if tick_hz is not None else tick_rates(),
        timings,
        shared if shared is not None else st.booleans(),
    )


def dipoles(most_am2: float = MOST_DIPOLE_AM2) -> SearchStrategy[Vec3]:
    """A demand, body axes, A m^2: none, along an axis, or any."""
    component = st.floats(-most_am2, most_am2)
    along = st.builds(_along, st.integers(0, 2), component)
    return st.one_of(st.just((0.0, 0.0, 0.0)), along, st.tuples(component, component, component))


def fields() -> SearchStrategy[Vec3]:
    """A magnetic field, body axes, T: along an axis, or any, none at all too."""
    component = st.floats(-MOST_FIELD_T, MOST_FIELD_T)
    along = st.builds(_along, st.integers(0, 2), st.sampled_from((3e-5, -3e-5)))
    return st.one_of(along, st.tuples(component, component, component))


def attitudes() -> SearchStrategy[Attitude]:
    """An attitude and rate relative to the orbital frame, known or not."""
    rate = st.floats(-MOST_RATE_RADPS, MOST_RATE_RADPS)
    return st.builds(
        _attitude,
        st.floats(0.0, 3.15),
        st.floats(-1.0, 1.0),
        st.floats(0.0, 6.3),
        rate,
        rate,
        rate,
        st.booleans(),
    )


def stretches(within: Limits) -> SearchStrategy[Stretch]:
    """Some ticks, up to two pulses with their back-offs; often so many that the next begins in a pulse."""
    backoff = -(-within.backoff_ms * within.tick_hz // 1000)
    pulse = 2 + within.pulse_ms * within.tick_hz // 1000
    cycle = backoff + pulse
    reboots = (Reboot.NOBODY, Reboot.NOBODY, Reboot.SCHEDULER, Reboot.BOARD, Reboot.SCHEDULER | Reboot.BOARD)
    return st.builds(
        Stretch,
        ticks=st.one_of(
            st.just(cycle), st.integers(backoff + 1, cycle), st.integers(1, 8), st.integers(1, 2 * cycle)
        ),
        m_body_am2=dipoles(),
        b_body_t=fields(),
        attitude=attitudes(),
        reboot=st.sampled_from(reboots),
        lost_statuses=_LOST,
        lost_requests=_LOST,
    )


def flights(within: SearchStrategy[Limits] | None = None) -> SearchStrategy[Flight]:
    """Whole flights: limits, and up to four stretches."""
    return (within if within is not None else limits()).flatmap(
        lambda chosen: st.builds(
            Flight,
            st.just(chosen),
            st.integers(0, 1000),
            st.lists(stretches(chosen), min_size=1, max_size=MOST_STRETCHES).map(tuple),
        )
    )


def _along(axis: int, size: float) -> Vec3:
    x, y, z = (size if index == axis else 0.0 for index in range(3))
    return (x, y, z)


def _attitude(
    angle_rad: float, height: float, azimuth_rad: float, wx: float, wy: float, wz: float, valid: bool
) -> Attitude:
    """Rotated by an angle about an axis that is given by height and azimuth."""
    flat, half = sqrt(1.0 - height * height) * sin(angle_rad / 2.0), sin(angle_rad / 2.0)
    q = (cos(angle_rad / 2.0), flat * cos(azimuth_rad), flat * sin(azimuth_rad), height * half)
    return Attitude(q, (wx, wy, wz), 0.01, 1e-4, valid)
