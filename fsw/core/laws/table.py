"""The control laws by name, each in a form far from the goal and one near it.

Of the estimated disturbances ``predictive`` and ``pulse_mpc`` use torque and dipole; ``lqr`` and its variants
with the attitude known, ``sdre``, ``mpc`` and its variants, ``two_coils`` and ``wheel_allocation`` use the
torque. From the dipole that any law demands ``by_mode`` subtracts the residual one. The other laws have no
use for the torque: coils can oppose only its component normal to the field, which gains little at once;
``pd``, ``sliding_integral`` and ``wheel_integral`` counter its mean by their integral.
"""

from types import ModuleType

from fsw.core.laws import (
    bdot_held,
    damping,
    direction_tracking,
    dual_spin,
    field_direction,
    field_tracking,
    h_infinity,
    horizon_roll,
    lqg_field,
    lqr,
    lqr_averaged,
    lqr_disturbed,
    mpc,
    mpc_box,
    mpc_simple_field,
    nmpc,
    optimal_damping,
    output_feedback,
    pd,
    pd_boxed,
    pd_delayed,
    pd_held,
    pd_inertial,
    pd_neural,
    pd_when_slow,
    phasing,
    pitch_wheel,
    predictive,
    projection,
    pulse_mpc,
    rate_damping_matrix,
    relay_stages,
    roll_precession,
    sdre,
    six_gain,
    sliding,
    sliding_rate,
    sliding_realisable,
    sliding_sphere,
    sliding_twisting,
    slow_spin,
    sphere,
    spin,
    spin_axis,
    stepped_precession,
    sun_critical,
    sun_panels,
    sun_pointing,
    target_precession,
    two_coils,
    two_step,
    wheel_allocation,
    wheel_integral,
    wheel_relay,
)
from fsw.core.laws.entry import LawEntry
from fsw.core.laws.interface import Setpoint

OWN_NUMBER = 255
"""The number of a law that is not in this table."""

MODULES: tuple[ModuleType, ...] = (
    bdot_held,
    damping,
    direction_tracking,
    dual_spin,
    field_direction,
    field_tracking,
    h_infinity,
    horizon_roll,
    lqg_field,
    lqr,
    lqr_averaged,
    lqr_disturbed,
    mpc,
    mpc_box,
    mpc_simple_field,
    nmpc,
    optimal_damping,
    output_feedback,
    pd,
    pd_boxed,
    pd_delayed,
    pd_held,
    pd_inertial,
    pd_neural,
    pd_when_slow,
    phasing,
    pitch_wheel,
    predictive,
    projection,
    pulse_mpc,
    rate_damping_matrix,
    relay_stages,
    roll_precession,
    sdre,
    six_gain,
    sliding,
    sliding_rate,
    sliding_realisable,
    sliding_sphere,
    sliding_twisting,
    slow_spin,
    sphere,
    spin,
    spin_axis,
    stepped_precession,
    sun_critical,
    sun_panels,
    sun_pointing,
    target_precession,
    two_coils,
    two_step,
    wheel_allocation,
    wheel_integral,
    wheel_relay,
)
LAWS: dict[str, LawEntry] = dict(
    sorted(
        ((name, entry) for module in MODULES for name, entry in module.LAWS.items()),
        key=lambda law: law[1].number,
    )
)
"""All laws, in the order of their numbers."""


def open_loop(setpoint: Setpoint) -> bool:
    """Whether the law of the setpoint acts without feedback."""
    return setpoint.law in LAWS and LAWS[setpoint.law].open_loop


def number_of(law: str) -> int:
    """The number of a law by its name."""
    return LAWS[law].number if law in LAWS else OWN_NUMBER
