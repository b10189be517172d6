"""What the coils drove in each tick, for the filter, and how uncertain that is.

A lost or late report and a skipped tick leave open what a coil did. The filter assumes the likelier case and
treats the difference as noise of the torque. So it soon sees what the coil did, and an unreported pulse is
never evidence about a coil.
"""

from math import sqrt

from fsw.core.actuation.actuator import ActuatorConfig, CoilView, requested_level
from fsw.core.actuation.pulses import dipole_am2
from fsw.core.algebra.vector import Vec3, add, row, scale, sub
from fsw.core.estimation.dynamics.error_dynamics import Driven


def find_drives(
    view: CoilView, m_body_am2: Vec3, reported: bool, ticks: range, config: ActuatorConfig
) -> list[Driven]:
    """What the coils drove over each of these ticks, and how uncertain that is.

    In a skipped tick, a request that is under way counts as driven, and so does a stray current that is
    known, since it flowed before. The uncertainty of a dipole is what was requested less what was reported,
    since either may have been lost or belong to another tick. The errors in the n ticks of a pulse are
    correlated: each is scaled by sqrt(n), so that taking them as independent never understates their sum,
    (sum of a_i)^2 <= n sum of a_i^2. A request to a continuous driver is for one tick, and no other follows
    before the next report.

    Args:
        view: after ``update_view``.
        m_body_am2: the dipole over the last tick, with what is known of a stray current, body axes.
        reported: whether a driver of pulses reported in the last tick.
        ticks: those since the tick before, the last of which ends now.
        config: the coils.
    """
    together, stray_am2 = 1.0, sub(m_body_am2, view.driven_am2)
    if config.dipoles is None:
        together = sqrt(config.pulses.pulse_ticks)
    else:
        reported = view.requested.reported
    over: list[Driven] = []
    for tick in range(ticks.start, ticks.stop - 1):
        asked_am2 = _requested_am2(view, tick, config)
        over.append(Driven(add(asked_am2, stray_am2), scale(together, asked_am2)))
    asked_am2 = _requested_am2(view, ticks.stop - 1, config)
    doubted_am2 = sub(asked_am2, view.driven_am2) if reported else asked_am2
    over.append(Driven(m_body_am2, scale(together, doubted_am2)))
    return over


def _requested_am2(view: CoilView, tick: int, config: ActuatorConfig) -> Vec3:
    if config.dipoles is not None:
        return view.requested.over(tick)
    level, pulses = requested_level(view, tick, config.pulses), config.pulses
    return scale(dipole_am2(level, pulses.levels_am2), row(pulses.coil_axes, view.fired.coil))
