"""Which coil is faulty, told by its current and by what its pulses do to the rate.

At the end of a pulse the current that is read back is held against that of the level; the supply that all
coils share names the coil that was fired last. After the pulse, the filter's attitude drifts away from what
the sensors say if it was not what it was taken for. With d the change of rate that was reckoned with and x
the part of it by which the pulse was different (-1: nothing flowed, -2: it flowed the other way), a
direction v is seen off by

    y + v x c = x (v x r) + noise,    dr/dt = d - omega x r,    dc/dt = e - omega x c

c and e being what the filter's own corrections have added to attitude and rate since the pulse. The least
squares estimate of x, gathered over the pulses of a coil and forgotten by half with each, names it.
"""

from dataclasses import dataclass
from enum import IntEnum
from math import hypot, sqrt
from typing import NamedTuple, TypeVar

from fsw.core.actuation import CoilView
from fsw.core.ephemeris import Reference
from fsw.core.mekf import Estimate
from fsw.core.pulses import AXES, PulseConfig, dipole_am2
from fsw.core.quaternion import conjugate, multiply, rotate
from fsw.core.readings import Readings
from fsw.core.vector import ZERO, Mat3, Vec3, add, cross, dot, norm, scale, sub, transform


class CoilFault(IntEnum):
    """What is wrong with a coil, as named on the bus."""

    OPEN = 1
    WEAK = 2
    REVERSED = 3
    STUCK = 4


HEALTHY = (0, 0, 0)
T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class CoilHealthConfig:
    """Current of each level and limits.

    ``weak_part`` and ``open_part`` of the nominal current or torque are the most that is weak and open;
    ``name_pulses`` in a row with a wrong current name a coil, ``name_sigmas`` is the certainty that the rate
    has to give; a current that nobody asked for is stuck after ``stuck_ticks``.
    """

    current_ma: Vec3
    weak_part: float
    open_part: float
    name_pulses: int
    name_sigmas: float
    stuck_ma: float
    stuck_ticks: int
    sample_ticks: int
    watch_ticks: int
    tick_s: float
    field_sigma_t: float
    sun_sigma_rad: float
    inertia_inverse: Mat3


class Pulsed(NamedTuple):
    """The pulse whose effect is watched; ``coil`` is -1 where there is none.

    ``kick_radps`` d, ``reach_rad`` r, ``turned_rad`` c and ``changed_radps`` e as above; each ``cross`` and
    ``square`` are the sums of the least squares, ``doubt`` is the variance of x from the rate's uncertainty
    before the pulse.
    """

    coil: int = -1
    end_tick: int = -1
    kick_radps: Vec3 = ZERO
    reach_rad: Vec3 = ZERO
    turned_rad: Vec3 = ZERO
    changed_radps: Vec3 = ZERO
    field_cross: float = 0.0
    field_square: float = 0.0
    sun_cross: float = 0.0
    sun_square: float = 0.0
    doubt: float = 0.0


NO_WATCH = Pulsed()


class Correction(NamedTuple):
    """What turns out to be missing in attitude and rate, body axes, and its uncertainty as that of x."""

    turn_rad: Vec3
    change_radps: Vec3
    reach_rad: Vec3
    kick_radps: Vec3
    variance: float


class CoilHealth(NamedTuple):
    """By coil: its fault (0: none), pulses in a row with a wrong current, and what is gathered of x.

    ``unexplained_radps``: rate by which its pulses may have left the estimate wrong.

    ``strange_ticks``: ticks in a row with a level or current that nobody asked for; ``stuck``: the level is
    there, or the current for too long.
    """

    faults: tuple[int, int, int] = HEALTHY
    wrong: tuple[int, int, int] = HEALTHY
    sum: Vec3 = ZERO
    weight: Vec3 = ZERO
    pulsed: Pulsed = NO_WATCH
    unexplained_radps: Vec3 = ZERO
    strange_ticks: int = 0
    stuck: bool = False


def judge_current(
    health: CoilHealth,
    view: CoilView,
    readings: Readings,
    unasked: bool,
    tick: int,
    timing: PulseConfig,
    config: CoilHealthConfig,
) -> CoilHealth:
    """Hold what the coil driver says against what was asked of it.

    Args:
        health: of the tick before.
        view: after what was heard in this tick.
        readings: what was heard.
        unasked: the driver tells of a level that was not asked for.
        tick: this one.
        timing: of the pulses.
        config: limits.
    """
    status = readings.coil
    if status is None:
        return health
    if unasked or (status.level == 0 and abs(status.current_ma) > config.stuck_ma):
        return _strange(health, status.coil if unasked else view.fired.coil, unasked, config)
    if health.strange_ticks:
        health = health._replace(strange_ticks=0, stuck=False)
    fired = view.fired
    if tick != view.fired_tick + timing.pulse_ticks or (status.coil, status.level) != fired:
        return health
    nominal_ma = config.current_ma[abs(status.level) - 1]
    kind = _kind(status.current_ma / (nominal_ma if status.level > 0 else -nominal_ma), config)
    wrong = health.wrong[fired.coil] + 1 if kind else 0
    if wrong == health.wrong[fired.coil]:
        return health
    health = health._replace(wrong=_with(health.wrong, fired.coil, wrong))
    return _named(health, fired.coil, kind) if wrong >= config.name_pulses else health


def _strange(health: CoilHealth, coil: int, unasked: bool, config: CoilHealthConfig) -> CoilHealth:
    """Something flows unasked: stuck when for longer than a pulse that an earlier boot may have begun."""
    ticks = health.strange_ticks + 1
    lasts = ticks >= config.stuck_ticks
    health = health._replace(strange_ticks=ticks, stuck=unasked or lasts)
    return _named(health, coil, CoilFault.STUCK) if ticks == config.stuck_ticks else health


def judge_rate(
    health: CoilHealth,
    view: CoilView,
    field: Vec3 | None,
    sun: Vec3 | None,
    reference: Reference,
    predicted: Estimate | None,
    known: Estimate | None,
    sigma3_rate_radps: float,
    tick: int,
    timing: PulseConfig,
    config: CoilHealthConfig,
) -> tuple[CoilHealth, Correction | None]:
    """Hold what the sensors say after a pulse against what it should have done.

    Args:
        health: of the tick before.
        view: after what was heard in this tick.
        field: sample that the filter was given, T, body axes.
        sun: likewise, unit vector.
        reference: field and Sun as modelled.
        predicted: the estimate before the samples of this tick.
        known: the estimate after them.
        sigma3_rate_radps: three standard deviations of its rate.
        tick: this one.
        timing: of the pulses.
        config: limits.

    Returns:
        The health, and how far off the estimate is where a pulse was not what it was taken for.
    """
    pulsed = health.pulsed
    if tick == view.fired_tick + timing.pulse_ticks and view.driven_level:
        health, correction = _weighed(health, config)
        if known is not None and (view.driven_coil, view.driven_level) == view.fired:
            others_radps = norm(_with(health.unexplained_radps, view.fired.coil, 0.0))
            sigma_radps = hypot(sigma3_rate_radps / 3.0, others_radps)
            begun = _begun(view, known, reference, sigma_radps, tick, timing, config)
            health = health._replace(pulsed=begun)
        return health, correction
    if pulsed.coil < 0:
        return health, None
    if predicted is None or known is None:
        return _weighed(health, config)[0], None
    pulsed = _carried(pulsed, predicted, known, config.tick_s)
    age = tick - pulsed.end_tick
    if age % config.sample_ticks:
        return health._replace(pulsed=pulsed), None
    health = health._replace(pulsed=_sampled(pulsed, known, field, sun, reference, config))
    if age >= config.watch_ticks or (_clear(health.pulsed) and _accused(*_gathered(health), config)):
        return _weighed(health, config)
    return health, None


def _begun(
    view: CoilView,
    known: Estimate,
    reference: Reference,
    sigma_radps: float,
    tick: int,
    timing: PulseConfig,
    config: CoilHealthConfig,
) -> Pulsed:
    """The watch over a pulse that has just ended."""
    b_body_t = rotate(known.q_body_from_eci, reference.b_eci_t)
    m_body_am2 = scale(dipole_am2(view.fired.level, timing.levels_am2), AXES[view.fired.coil])
    kick = transform(config.inertia_inverse, scale(timing.pulse_s, cross(m_body_am2, b_body_t)))
    square = dot(kick, kick)
    if square == 0.0:
        return NO_WATCH
    return Pulsed(
        view.fired.coil,
        tick,
        kick,
        scale(0.5 * timing.pulse_s, kick),
        doubt=sigma_radps**2 / square + MODEL_ERROR**2,
    )


MODEL_ERROR = 0.05
"""Relative uncertainty of a pulse's effect that no number of samples takes away."""


def _carried(pulsed: Pulsed, predicted: Estimate, known: Estimate, tick_s: float) -> Pulsed:
    """Over one tick, with the corrections that the filter made at its end."""
    omega = known.omega_body_radps
    change = sub(omega, predicted.omega_body_radps)
    reach, turned, changed = pulsed.reach_rad, pulsed.turned_rad, pulsed.changed_radps
    reach = add(reach, scale(tick_s, sub(pulsed.kick_radps, cross(omega, reach))))
    turned = add(turned, scale(tick_s, sub(changed, cross(omega, turned))))
    if known.q_body_from_eci is not predicted.q_body_from_eci:
        _, q1, q2, q3 = multiply(conjugate(predicted.q_body_from_eci), known.q_body_from_eci)
        turned = add(turned, (2.0 * q1, 2.0 * q2, 2.0 * q3))
        changed = add(changed, change)
    return pulsed._replace(reach_rad=reach, turned_rad=turned, changed_radps=changed)


def _sampled(
    pulsed: Pulsed,
    known: Estimate,
    field: Vec3 | None,
    sun: Vec3 | None,
    reference: Reference,
    config: CoilHealthConfig,
) -> Pulsed:
    """With what field and Sun say about x."""
    if field is not None:
        v = rotate(known.q_body_from_eci, reference.b_eci_t)
        product, square = _told(sub(field, known.mag_bias_t), v, pulsed, config.field_sigma_t)
        pulsed = pulsed._replace(
            field_cross=pulsed.field_cross + product, field_square=pulsed.field_square + square
        )
    if sun is not None:
        v = rotate(known.q_body_from_eci, reference.sun_eci)
        product, square = _told(sun, v, pulsed, config.sun_sigma_rad)
        pulsed = pulsed._replace(sun_cross=pulsed.sun_cross + product, sun_square=pulsed.sun_square + square)
    return pulsed


def _told(seen: Vec3, v: Vec3, pulsed: Pulsed, sigma: float) -> tuple[float, float]:
    """What a direction adds to the sums of its least squares."""
    off = add(sub(seen, v), cross(v, pulsed.turned_rad))
    expected = cross(v, pulsed.reach_rad)
    variance = sigma * sigma
    return dot(expected, off) / variance, dot(expected, expected) / variance


def _gathered(health: CoilHealth) -> tuple[float, float]:
    """Sum and weight of x for the coil of the watched pulse, with that pulse unless its sensors disagree."""
    pulsed = health.pulsed
    square = pulsed.field_square + pulsed.sun_square
    before, weight = 0.5 * health.sum[pulsed.coil], 0.5 * health.weight[pulsed.coil]
    if square == 0.0 or not _one_story(pulsed):
        return before, weight
    own = 1.0 / (1.0 / square + pulsed.doubt)
    return before + own * (pulsed.field_cross + pulsed.sun_cross) / square, weight + own


def _clear(pulsed: Pulsed) -> bool:
    """Whether the pulse has been watched for long enough to tell one fault from another."""
    square = pulsed.field_square + pulsed.sun_square
    return square > 0.0 and 1.0 / square + pulsed.doubt < CLEAR**2


CLEAR = 0.15


def _one_story(pulsed: Pulsed) -> bool:
    """Whether field and Sun tell the same x: a pulse moves the body, a faulty sensor only what it says."""
    b, s = pulsed.field_square, pulsed.sun_square
    if b == 0.0 or s == 0.0:
        return True
    apart = pulsed.field_cross / b - pulsed.sun_cross / s
    return apart * apart < STORY_SIGMAS**2 * (1.0 / b + 1.0 / s)


STORY_SIGMAS = 4.0
CERTAIN = 4.0
"""Standard deviations of x from which on the estimate is set right by it."""


def _accused(total: float, weight: float, config: CoilHealthConfig) -> bool:
    """Whether a coil does certainly less than it should."""
    return weight > 0.0 and 1.0 + total / weight + config.name_sigmas / sqrt(weight) < config.weak_part


def _weighed(health: CoilHealth, config: CoilHealthConfig) -> tuple[CoilHealth, Correction | None]:
    """The watched pulse, if any, added to what is known of its coil, which it may name."""
    pulsed, coil = health.pulsed, health.pulsed.coil
    if coil < 0:
        return health, None
    total, weight = _gathered(health)
    health = health._replace(
        sum=_with(health.sum, coil, total), weight=_with(health.weight, coil, weight), pulsed=NO_WATCH
    )
    if _accused(total, weight, config):
        health = _named(health, coil, _kind(_part(pulsed, total / weight, config), config))
    correction = _correction(pulsed)
    left = 0.0 if correction is not None else _unexplained(pulsed)
    unexplained = _with(scale(0.5, health.unexplained_radps), coil, left)
    return health._replace(unexplained_radps=unexplained), correction


def _part(pulsed: Pulsed, gathered: float, config: CoilHealthConfig) -> float:
    """What the coil does of what it should: by this pulse alone if it is clear, else by all of them."""
    if not (_clear(pulsed) and _one_story(pulsed)):
        return 1.0 + gathered
    own = (pulsed.field_cross + pulsed.sun_cross) / (pulsed.field_square + pulsed.sun_square)
    return 1.0 + own if 1.0 + own < config.weak_part else 1.0 + gathered


def _unexplained(pulsed: Pulsed) -> float:
    """The change of rate by which a pulse seems to have been different, where that may be more than noise."""
    square = pulsed.field_square + pulsed.sun_square
    if square == 0.0:
        return 0.0
    x = (pulsed.field_cross + pulsed.sun_cross) / square
    return abs(x) * norm(pulsed.kick_radps) if x * x > 9.0 * (1.0 / square + pulsed.doubt) else 0.0


def _correction(pulsed: Pulsed) -> Correction | None:
    """What the estimate lacks, if the pulse was certainly another one than it was taken for."""
    square = pulsed.field_square + pulsed.sun_square
    if square == 0.0 or not _one_story(pulsed):
        return None
    x, variance = (pulsed.field_cross + pulsed.sun_cross) / square, 1.0 / square
    if x * x < CERTAIN**2 * (variance + pulsed.doubt):
        return None
    return Correction(
        sub(scale(x, pulsed.reach_rad), pulsed.turned_rad),
        sub(scale(x, pulsed.kick_radps), pulsed.changed_radps),
        pulsed.reach_rad,
        pulsed.kick_radps,
        variance,
    )


REVERSED_PART = -0.5


def _kind(part: float, config: CoilHealthConfig) -> int:
    """The fault of a coil that does this part of what it should; 0 if none."""
    if not part < config.weak_part:
        return 0
    if part < REVERSED_PART:
        return CoilFault.REVERSED
    return CoilFault.OPEN if part < config.open_part else CoilFault.WEAK


def _named(health: CoilHealth, coil: int, kind: int) -> CoilHealth:
    """A coil's first fault is kept until the ground clears it, but for one that is stuck."""
    if health.faults[coil] and kind != CoilFault.STUCK:
        return health
    return health._replace(faults=_with(health.faults, coil, kind))


def _with(three: tuple[T, T, T], index: int, value: T) -> tuple[T, T, T]:
    a, b, c = three
    return ((value, b, c), (a, value, c), (a, b, value))[index]
