"""What the coils drove in each tick, for the filter, and how far that is in doubt.

A report that is lost or late, and a tick that is skipped, leave open what a coil did. The filter takes the
likelier for granted and the rest for noise of its torque. So it soon sees what the coil did, and no pulse
that nobody reported is evidence about a coil.
"""

from math import sqrt

from fsw.core.actuation.actuator import ActuatorConfig, CoilView, requested_level
from fsw.core.actuation.pulses import PulseConfig, dipole_am2
from fsw.core.algebra.vector import Vec3, scale, sub
from fsw.core.estimation.dynamics.error_dynamics import NOT_DRIVEN, Driven


def driven(
    view: CoilView, m_body_am2: Vec3, reported: bool, ticks: range, config: ActuatorConfig
) -> list[Driven]:
    """What the coils drove over each of these ticks, and what it is in doubt by.

    In a tick that was skipped the own request, if one is under way, counts as driven. A dipole is in doubt by
    what was requested less what was reported, since either may have been lost, or be of another tick. The n
    ticks of a pulse are in doubt together: each counts sqrt(n) fold, so that taken for independent they are
    never in doubt by less, (sum of a_i)^2 <= n sum of a_i^2.

    Args:
        view: after ``update_view``.
        m_body_am2: the dipole over the last tick, body axes.
        reported: the driver has reported in the last tick.
        ticks: those since the tick before, the last of which ends now.
        config: the coils.
    """
    if config.dipoles is not None:
        return [*[NOT_DRIVEN] * (len(ticks) - 1), Driven(m_body_am2)]
    *skipped, asked_am2 = [_requested_am2(view, tick, config.pulses) for tick in ticks]
    doubted_am2 = sub(asked_am2, view.driven_am2) if reported else asked_am2
    together = sqrt(config.pulses.pulse_ticks)
    return [
        *[Driven(one_am2, scale(together, one_am2)) for one_am2 in skipped],
        Driven(m_body_am2, scale(together, doubted_am2)),
    ]


def _requested_am2(view: CoilView, tick: int, config: PulseConfig) -> Vec3:
    level = requested_level(view, tick, config)
    return scale(dipole_am2(level, config.levels_am2), config.coil_axes[view.fired.coil])
