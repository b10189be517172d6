"""For how long the reading of a quantised sensor may stand still.

A sensor with the step q on each axis shows the same for values that differ by up to q, so that its vector v
may move by sqrt 3 q while it stands still, in whatever direction. What v has moved by is summed up tick by
tick from the rate and the models, body axes:

    dv = (C dv/dt|eci - omega x v) dt,

beside which a rate with the standard deviation sigma may be wrong by sigma |v| dt in each tick. Nothing of
this depends on what the sensor shows meanwhile. A reading that stands still although v has certainly moved by
more is frozen:

    |sum dv| > sqrt 3 q + ``SIGMAS`` sum sigma |v| dt.
"""

from dataclasses import dataclass, field
from math import sqrt
from typing import final

from fsw.core.algebra.quaternion import rotate
from fsw.core.algebra.vector import ZERO, Vec3, add, cross, norm, scale, sub
from fsw.core.estimation.mekf import Estimate
from fsw.core.fdir.evidence import SIGMAS
from fsw.core.orbit.ephemeris import Reference


@dataclass(frozen=True, slots=True)
class Steps:
    """Steps of the readings, T and of the Sun's unit vector, 0: continuous; and the length of a tick, s."""

    field_t: float
    sun: float
    tick_s: float


@final
@dataclass(slots=True)
class Displacement:
    """What a vector has moved by while its reading stood still, body axes, and one sigma of its error."""

    by_body: Vec3 = ZERO
    sigma: float = 0.0

    def exceeds(self, step: float) -> bool:
        """Whether a sound reading with this step, in the vector's unit, would have changed."""
        return norm(self.by_body) > sqrt(3.0) * step + SIGMAS * self.sigma


@final
@dataclass(slots=True)
class ReadingMotion:
    """Of the field, T, and of the Sun's unit vector."""

    of_field: Displacement = field(default_factory=Displacement)
    of_sun: Displacement = field(default_factory=Displacement)


def update_motion(
    motion: ReadingMotion,
    field_still: bool,
    sun_still: bool,
    estimate: Estimate | None,
    reference: Reference,
    steps: Steps,
) -> None:
    """Carry the motion over a tick.

    Args:
        motion: after the tick before.
        field_still: whether the reading of the field has stood still for longer than it may be late.
        sun_still: the same of the Sun.
        estimate: predicted to this tick; None: how the satellite turns is not known, which counts as rest.
        reference: field and Sun as modelled.
        steps: of the readings.
    """
    if not field_still or not steps.field_t:
        _reset(motion.of_field)
    elif estimate is not None:
        _move(motion.of_field, reference.b_eci_t, reference.b_rate_eci_tps, estimate, steps.tick_s)
    if not sun_still or not steps.sun:
        _reset(motion.of_sun)
    elif estimate is not None:
        _move(motion.of_sun, reference.sun_eci, ZERO, estimate, steps.tick_s)


def is_frozen(displacement: Displacement, still: bool, step: float) -> bool:
    """Whether a reading with this step stands still and should not; a continuous one never should."""
    return still and (not step or displacement.exceeds(step))


def _reset(displacement: Displacement) -> None:
    displacement.by_body, displacement.sigma = ZERO, 0.0


def _move(moved: Displacement, v_eci: Vec3, rate_eci: Vec3, estimate: Estimate, tick_s: float) -> None:
    """Add what a vector has moved by in one more tick."""
    q, omega = estimate.q_body_from_eci, estimate.omega_body_radps
    rate_body = sub(rotate(q, rate_eci), cross(omega, rotate(q, v_eci)))
    sigma_radps = sqrt(sum(estimate.covariance.diagonal()[3:6].tolist(), 0.0))
    moved.by_body = add(moved.by_body, scale(tick_s, rate_body))
    moved.sigma += sigma_radps * norm(v_eci) * tick_s
