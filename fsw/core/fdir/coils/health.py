"""What has been found of the coils so far, and what follows from it for the dipole of a tick."""

from dataclasses import dataclass
from typing import TypeVar, final

from fsw.core.actuation.actuator import CoilView
from fsw.core.actuation.pulses import PulseConfig
from fsw.core.algebra.vector import ZERO, Mat3, Vec3, scale, transform, transpose
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.fdir.coils.weak_test import NOTHING_OLDER, Older, WeakTest
from fsw.core.fdir.faults import CoilFault
from fsw.core.laws.plan.pulse_model import AXES


@dataclass(frozen=True, slots=True)
class CoilHealthConfig:
    """Current of each level and limits.

    ``weak`` tells a weak coil from a sound one; a stray current means a stuck coil after ``stuck_ticks``.
    ``stray_axes``: by coil, the dipole per nominal one of a current in the sense of its output, body axes.
    ``left_ma_per_am2``: current in the supply per dipole requested over a tick, body axes, where it may still
    flow at the end of the tick; zero where it is over by then.
    """

    current_ma: Vec3
    weak: WeakTest
    stuck_ma: float
    stuck_ticks: int
    pulses: PulseConfig
    mekf: MekfConfig
    retest_ticks: int
    stray_axes: Mat3 = AXES
    left_ma_per_am2: Vec3 = ZERO


NONE_OLDER = (NOTHING_OLDER, NOTHING_OLDER, NOTHING_OLDER)


@final
@dataclass(slots=True)
class CoilHealth:
    """By coil: its fault (0: none), what its currents show against it, nats, and its ``older`` pulses.

    ``unrequested_ticks``: ticks in a row with a level or a current without a request, ``stray_ma``: a current
    without a level; ``stuck``: there is such a level, or such a current for too long; ``stray_parts``: by
    coil, which fraction of it the filter takes into account. ``until_retest``: ticks until an isolated coil
    is tried again.
    """

    faults: tuple[int, int, int] = (0, 0, 0)
    nats: Vec3 = ZERO
    older: tuple[Older, Older, Older] = NONE_OLDER
    unrequested_ticks: int = 0
    stray_ma: int = 0
    stuck: bool = False
    stray_parts: Vec3 = ZERO
    until_retest: tuple[int, int, int] = (0, 0, 0)


def driven_am2(health: CoilHealth, view: CoilView, config: CoilHealthConfig) -> Vec3:
    """Dipole over the tick that has ended, body axes, with what is known of a stray current.

    Args:
        health: of this tick.
        view: after what was received in this tick.
        config: limits.
    """
    if not health.stray_ma:
        return view.driven_am2
    stuck = CoilFault.STUCK in health.faults
    parts = AXES[health.faults.index(CoilFault.STUCK)] if stuck else health.stray_parts
    if parts == ZERO:
        return view.driven_am2
    return transform(transpose(config.stray_axes), scale(stray_am2(health, config), parts))


def has_unassigned_torque(health: CoilHealth) -> bool:
    """Whether a stray current turns the satellite, and the coil in which it flows is not isolated yet."""
    return health.stuck and has_unassigned_current(health)


def has_unassigned_current(health: CoilHealth) -> bool:
    """Whether there is a stray current, and no coil is isolated for it."""
    return health.stray_ma != 0 and CoilFault.STUCK not in health.faults


def stray_am2(health: CoilHealth, config: CoilHealthConfig) -> float:
    """Nominal dipole of the stray current in a coil, in the sense of its output."""
    return health.stray_ma / config.current_ma[-1] * config.pulses.levels_am2[-1]


def isolate_coil(health: CoilHealth, coil: int, kind: int, config: CoilHealthConfig) -> None:
    """Isolate a coil, which keeps its first fault until it is tried again or cleared, or found stuck."""
    if health.faults[coil] and kind != CoilFault.STUCK:
        return
    health.faults = with_item(health.faults, coil, int(kind))
    health.until_retest = with_item(health.until_retest, coil, config.retest_ticks)


T = TypeVar("T")


def with_item(three: tuple[T, T, T], index: int, value: T) -> tuple[T, T, T]:
    """The three with another value in one place."""
    a, b, c = three
    return ((value, b, c), (a, value, c), (a, b, value))[index]
