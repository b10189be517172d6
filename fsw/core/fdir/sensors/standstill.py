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

from math import sqrt
from typing import NamedTuple

from fsw.core.algebra.quaternion import rotate
from fsw.core.algebra.vector import ZERO, Vec3, add, cross, norm, scale, sub
from fsw.core.estimation.mekf import Estimate
from fsw.core.fdir.evidence import SIGMAS
from fsw.core.orbit.ephemeris import Reference


class Steps(NamedTuple):
    """Steps of the readings, T and of the Sun's unit vector, 0: continuous; and the length of a tick, s."""

    field_t: float
    sun: float
    tick_s: float


class Moved(NamedTuple):
    """What a vector has moved by while its reading stood still, body axes, and one sigma of its error."""

    by_body: Vec3 = ZERO
    sigma: float = 0.0

    def beyond(self, step: float) -> bool:
        """Whether a sound reading with this step, in the vector's unit, would have changed."""
        return norm(self.by_body) > sqrt(3.0) * step + SIGMAS * self.sigma


NOT_MOVED = Moved()
Motion = tuple[Moved, Moved]
"""Of the field, T, and of the Sun's unit vector."""
NO_MOTION: Motion = (NOT_MOVED, NOT_MOVED)


def moved_on(
    motion: Motion,
    still: tuple[bool, bool],
    estimate: Estimate | None,
    reference: Reference,
    steps: Steps,
) -> Motion:
    """The motion after a tick.

    Args:
        motion: after the tick before.
        still: whether the readings of field and Sun have stood still for longer than they may be late.
        estimate: predicted to this tick; None: how the satellite turns is not known, which counts as rest.
        reference: field and Sun as modelled.
        steps: of the readings.
    """
    (field, sun), (field_still, sun_still) = motion, still
    if not field_still or not steps.field_t:
        field = NOT_MOVED
    elif estimate is not None:
        field = _further(field, reference.b_eci_t, reference.b_rate_eci_tps, estimate, steps.tick_s)
    if not sun_still or not steps.sun:
        sun = NOT_MOVED
    elif estimate is not None:
        sun = _further(sun, reference.sun_eci, ZERO, estimate, steps.tick_s)
    return field, sun


def frozen(motion: Motion, still: tuple[bool, bool], steps: Steps) -> tuple[bool, bool]:
    """Whether the readings of field and Sun stand still and should not; a continuous one never should."""
    (field, sun), (field_still, sun_still) = motion, still
    return (
        field_still and (not steps.field_t or field.beyond(steps.field_t)),
        sun_still and (not steps.sun or sun.beyond(steps.sun)),
    )


def _further(moved: Moved, v_eci: Vec3, rate_eci: Vec3, estimate: Estimate, tick_s: float) -> Moved:
    """What a vector has moved by after one more tick."""
    q, omega = estimate.q_body_from_eci, estimate.omega_body_radps
    rate_body = sub(rotate(q, rate_eci), cross(omega, rotate(q, v_eci)))
    sigma_radps = sqrt(sum(estimate.covariance.diagonal()[3:6].tolist()))
    sigma = moved.sigma + sigma_radps * norm(v_eci) * tick_s
    return Moved(add(moved.by_body, scale(tick_s, rate_body)), sigma)
