"""The section of the onboard table for a reaction wheel that is driven."""

from math import ceil
from typing import Self

from pydantic import Field, model_validator

from fsw.core.algebra.vector import Mat3, dot, inverse, transform, unit
from fsw.core.laws.interface import Wheel
from fsw.core.laws.plan.law_axes import LawAxes
from fsw.input.schema import NotNegative, Section, Triple

STALE_S = 10.0
"""Age of a report from which the wheel's momentum counts as unknown."""
MOST_RADPS = 2000.0
"""A wheel of the given inertia and momentum turns no faster: its message holds no more."""


class WheelTable(Section):
    """A reaction wheel: axis in body axes, inertia about it, motor torque, momentum relative to the body.

    The body's inertia includes the wheel's. Friction: ``viscous_nms`` times the speed, and ``coulomb_nm``,
    which is nearly constant.
    """

    axis: Triple = (0.0, 0.0, 1.0)
    inertia_kgm2: float = Field(ge=1e-7, le=10.0)
    max_torque_nm: float = Field(ge=1e-6, le=0.4)
    max_momentum_nms: float = Field(gt=0.0, le=100.0)
    viscous_nms: NotNegative = 0.0
    coulomb_nm: NotNegative = 0.0

    @model_validator(mode="after")
    def _can_be_driven(self) -> Self:
        if not any(self.axis):
            raise ValueError("axis must not be zero")
        speed_radps = self.max_momentum_nms / self.inertia_kgm2
        if speed_radps > MOST_RADPS:
            raise ValueError(
                f"max_momentum_nms / inertia_kgm2 is {speed_radps:g} rad/s, which must not be above "
                f"{MOST_RADPS:g}: raise inertia_kgm2 or lower max_momentum_nms"
            )
        friction_nm = self.viscous_nms * speed_radps + self.coulomb_nm
        if friction_nm >= self.max_torque_nm:
            raise ValueError(
                f"friction at max_momentum_nms is {friction_nm:g} N m, not below max_torque_nm: the wheel "
                "could not be brought there"
            )
        return self


def check_wheel_inertia(table: WheelTable, inertia_kgm2: Mat3) -> None:
    """Check that the body less the wheel's own inertia is still a body.

    Raises:
        ValueError: the wheel's inertia is not below that of the body about its axis.
    """
    axis = unit(table.axis)
    least_kgm2 = 1.0 / dot(axis, transform(inverse(inertia_kgm2), axis))
    if table.inertia_kgm2 >= least_kgm2:
        raise ValueError(
            f"wheel.inertia_kgm2 must be below {least_kgm2:g}, what body.inertia_kgm2 has about its axis: it "
            "counts the wheel too"
        )


def driven_wheel(table: WheelTable | None, tick_hz: int, axes: LawAxes | None = None) -> Wheel | None:
    """The wheel as actuation and, with their axes, the laws use it."""
    if table is None:
        return None
    axis_body = unit(table.axis)
    return Wheel(
        axis_body=axis_body if axes is None else axes.of_body(axis_body),
        inertia_kgm2=table.inertia_kgm2,
        max_torque_nm=table.max_torque_nm,
        max_momentum_nms=table.max_momentum_nms,
        viscous_nms=table.viscous_nms,
        coulomb_nm=table.coulomb_nm,
        tick_s=1.0 / tick_hz,
        stale_ticks=ceil(STALE_S * tick_hz),
    )
