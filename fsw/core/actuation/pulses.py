"""The PoSAT-1 actuation scheduler: short quantised pulses, one coil at a time, a long back-off.

One coil at a time, three levels per polarity, pulses of 3 s, then at least 100 s off: counted from the end
of the pulse, for that coil or for all of them (``shared``). After boot a full back-off passes first. All
timing is in integer ticks, rounded so that the pulse is never longer and the gap never shorter.

The demand of a continuous law is accumulated as the torque impulse still owed: a leaky sigma-delta
modulator, bounded by what one pulse can pay. What is due is the impulse that will be owed midway between
this pulse and the next: paid only in arrears, a lasting demand would be half that interval late and the leak
would keep a fraction of it. The pulse that is fired is the one that leaves the least of the impulse that is
due, or that a predictive law demands; firing none is one of the choices and wins ties. Least is by a metric:
the rate that is left, or its energy.

Source: Tavares et al. (ConSat, PoSAT-1) for the limits and the choice; the modulator is this project's.
"""

from dataclasses import dataclass
from math import copysign
from typing import final

from fsw.core.algebra.vector import (
    ZERO,
    Mat3,
    Vec3,
    add,
    cross,
    dot,
    item,
    norm,
    row,
    scale,
    sub,
    transform,
)
from fsw.core.laws.plan.pulse_model import AXES, NEVER, Pulse


@dataclass(frozen=True, slots=True)
class PulseConfig:
    """Limits and levels, in ticks and SI; J^-2 and J^-1 as the metrics of an impulse that is left.

    ``coil_axes``: the coils' dipoles per unit nominal dipole, body axes.
    """

    pulse_ticks: int
    backoff_ticks: int
    duration_ms: int
    shared: bool
    levels_am2: Vec3
    pulse_s: float
    tick_s: float
    leak_s: float
    rate_metric: Mat3
    energy_metric: Mat3
    coil_axes: Mat3 = AXES


@final
@dataclass(slots=True)
class PulseState:
    """The scheduler's own timers and the impulse still owed.

    ``ready_tick[coil]`` is the first tick in answer to which that coil may fire again; ``busy_until`` the
    first in answer to which no requested pulse is under way; ``held_am2`` is what a continuous driver holds
    meanwhile, body axes.
    """

    ready_tick: tuple[int, int, int]
    busy_until: int
    pending_impulse_body_nms: Vec3 = ZERO
    held_am2: Vec3 = ZERO


def pulse_timing(tick_hz: int, pulse_ms: int, backoff_ms: int) -> tuple[int, int, int]:
    """(pulse ticks, back-off ticks, duration in ms): the pulse rounded down, the back-off rounded up.

    Raises:
        ValueError: a tick is longer than the pulse.
    """
    pulse_ticks = pulse_ms * tick_hz // 1000
    if pulse_ticks < 1:
        raise ValueError(f"a pulse of {pulse_ms} ms is shorter than one tick at {tick_hz} Hz")
    return pulse_ticks, -(-backoff_ms * tick_hz // 1000), pulse_ticks * 1000 // tick_hz


def boot(tick: int, config: PulseConfig) -> PulseState:
    """The state at boot: nothing owed, a full back-off ahead."""
    first = tick + config.backoff_ticks
    return PulseState(ready_tick=(first, first, first), busy_until=tick)


def delay(state: PulseState, tick: int, skipped: int) -> None:
    """Extend the running timers by the skipped ticks, when the count has skipped to ``tick``.

    Lost ticks cannot be distinguished from ticks that never occurred, and a back-off must not end early.
    """
    before = tick - skipped - 1
    a, b, c = state.ready_tick
    state.ready_tick = (
        a + skipped if a > before else a,
        b + skipped if b > before else b,
        c + skipped if c > before else c,
    )
    if state.busy_until > before:
        state.busy_until += skipped


def owe(state: PulseState, torque_body_nm: Vec3, b_body_t: Vec3, config: PulseConfig) -> None:
    """Add one tick of the demanded torque: r <- (1 - h / tau) r + T h, |r| at most what one pulse can pay.

    Without that bound a strong demand would go on being paid long after its cause is gone.
    """
    keep, h = 1.0 - config.tick_s / config.leak_s, config.tick_s
    r1, r2, r3 = state.pending_impulse_body_nms
    t1, t2, t3 = torque_body_nm
    owed = (keep * r1 + h * t1, keep * r2 + h * t2, keep * r3 + h * t3)
    state.pending_impulse_body_nms = _within_a_pulse(owed, b_body_t, config)


def due(state: PulseState, torque_body_nm: Vec3, b_body_t: Vec3, config: PulseConfig) -> Vec3:
    """What a pulse fired now is to pay: r + T (T_p + T_b) / 2, T_b the back-off; body axes, N m s.

    The present demand is taken to last that long. The bound is that of ``owe``.
    """
    half_s = 0.5 * config.tick_s * (config.pulse_ticks + config.backoff_ticks)
    expected = add(state.pending_impulse_body_nms, scale(half_s, torque_body_nm))
    return _within_a_pulse(expected, b_body_t, config)


def _within_a_pulse(impulse_body_nms: Vec3, b_body_t: Vec3, config: PulseConfig) -> Vec3:
    """The impulse, scaled down to the largest that one pulse can pay."""
    size, limit = norm(impulse_body_nms), config.pulse_s * config.levels_am2[2] * norm(b_body_t)
    return scale(limit / size, impulse_body_nms) if size > limit else impulse_body_nms


def wait_ticks(
    state: PulseState, tick: int, faults: tuple[int, int, int] = (0, 0, 0)
) -> tuple[int, int, int]:
    """By coil, ticks until its own timer lets it fire (0: in answer to this tick); ``NEVER`` with a fault."""
    busy = max(state.busy_until - tick, 0)
    a, b, c = state.ready_tick
    return (
        NEVER if faults[0] else max(a - tick, busy),
        NEVER if faults[1] else max(b - tick, busy),
        NEVER if faults[2] else max(c - tick, busy),
    )


def choose(
    state: PulseState,
    impulse_body_nms: Vec3,
    metric: Mat3,
    tick: int,
    b_body_t: Vec3,
    config: PulseConfig,
    faults: tuple[int, int, int] = (0, 0, 0),
) -> Pulse | None:
    """The pulse, among the coils whose own timer has run out, that leaves the least; None if none helps.

    Minimises (r - T_p m x b)^T W (r - T_p m x b) over coil and level, T_p the pulse length.

    Args:
        state: the scheduler's own timers.
        impulse_body_nms: r, the impulse demanded.
        metric: W, symmetric and positive.
        tick: tick that is answered.
        b_body_t: field, body axes, T.
        config: limits and levels.
        faults: by coil; one with a fault is not chosen.
    """
    if tick < state.busy_until:
        return None
    weighted = transform(metric, impulse_body_nms)
    best: Pulse | None = None
    least = 0.0
    for coil in range(3):
        if tick < _of_coil(coil, state.ready_tick) or _of_coil(coil, faults):
            continue
        gain = scale(config.pulse_s, cross(row(config.coil_axes, coil), b_body_t))
        along, square = dot(weighted, gain), dot(gain, transform(metric, gain))
        for index in range(3):
            level_am2 = item(config.levels_am2, index)
            change = level_am2 * (level_am2 * square - 2.0 * abs(along))
            if change < least:
                least, best = change, Pulse(coil, index + 1 if along > 0.0 else -index - 1)
    return best


def _of_coil(coil: int, three: tuple[int, int, int]) -> int:
    return three[0] if coil == 0 else three[1] if coil == 1 else three[2]


def fire(state: PulseState, pulse: Pulse, paid_body_nms: Vec3, tick: int, config: PulseConfig) -> None:
    """Set the timers and take the impulse for paid: ``pulse`` has been requested in answer to ``tick``."""
    end = tick + config.pulse_ticks
    again = end + config.backoff_ticks
    a, b, c = state.ready_tick
    state.ready_tick = (
        again if config.shared or pulse.coil == 0 else a,
        again if config.shared or pulse.coil == 1 else b,
        again if config.shared or pulse.coil == 2 else c,
    )
    state.busy_until = end
    state.pending_impulse_body_nms = sub(state.pending_impulse_body_nms, paid_body_nms)


def impulse(pulse: Pulse, b_body_t: Vec3, config: PulseConfig) -> Vec3:
    """The impulse of a pulse, T_p m x b, body axes, N m s."""
    dipole = scale(dipole_am2(pulse.level, config.levels_am2), row(config.coil_axes, pulse.coil))
    return scale(config.pulse_s, cross(dipole, b_body_t))


def dipole_am2(level: int, levels_am2: Vec3) -> float:
    """The dipole of a level, A m^2, signed; zero for level 0."""
    return copysign(item(levels_am2, abs(level) - 1), level) if level else 0.0
