"""The control laws by name, each in a form far from the goal and one near it.

Of the estimated disturbances ``predictive`` and ``pulse_mpc`` use torque and dipole; ``lqr`` and its variants
with the attitude known, ``sdre``, ``mpc`` and its variants, ``two_coils`` and ``wheel_allocation`` use the
torque. From the dipole that any law demands ``by_mode`` subtracts the residual one. The other laws have no
use for the torque: coils can oppose only its component normal to the field, which gains little at once;
``pd``, ``sliding_integral`` and ``wheel_integral`` counter its mean by their integral.
"""

from fsw.core.laws.damping.table import LAWS as DAMPING
from fsw.core.laws.entry import Aim, LawEntry, Need
from fsw.core.laws.feedback.table import LAWS as FEEDBACK
from fsw.core.laws.interface import Setpoint
from fsw.core.laws.one_axis.table import LAWS as ONE_AXIS
from fsw.core.laws.optimal.table import LAWS as OPTIMAL
from fsw.core.laws.phasing import PhasingGains, phasing
from fsw.core.laws.predictive.table import LAWS as PREDICTIVE
from fsw.core.laws.sliding.table import LAWS as SLIDING
from fsw.core.laws.spin.table import LAWS as SPIN
from fsw.core.laws.wheel.table import LAWS as WHEEL

OWN_NUMBER = 255
"""The number of a law that is not in this table."""

CHECK = {
    "phasing": LawEntry(70, Aim.CHECK, phasing, phasing, PhasingGains, needs=Need.PULSES, open_loop=True),
}

LAWS: dict[str, LawEntry] = dict(
    sorted(
        (DAMPING | SPIN | WHEEL | ONE_AXIS | FEEDBACK | SLIDING | OPTIMAL | PREDICTIVE | CHECK).items(),
        key=lambda item: item[1].number,
    )
)
"""All laws, in the order of their numbers."""


def open_loop(setpoint: Setpoint) -> bool:
    """Whether the law of the setpoint acts without feedback."""
    return setpoint.law in LAWS and LAWS[setpoint.law].open_loop


def number_of(law: str) -> int:
    """The number of a law by its name."""
    return LAWS[law].number if law in LAWS else OWN_NUMBER
