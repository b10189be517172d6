"""The continuous driver: a dipole each tick; for an impulse law the best one, held for a pulse length.

The board drives each request over the first part of one tick and nothing without a request; the magnetometer
samples while it is off. An impulse law keeps the timing of the pulses; only its choice of dipole is wider.
"""

from dataclasses import dataclass
from typing import Final, final

from fsw.core.actuation.pulses import PulseConfig, PulseState
from fsw.core.algebra.vector import ZERO, Mat3, Vec3, cross, dot, is_finite, scale, transform
from fsw.core.laws.interface import Demand
from fsw.core.laws.plan.genetic import search
from fsw.core.laws.predictive import best_impulse
from fsw.wire.messages import CoilDipole

MOST: Final = 1.0 - 2.0**-16
"""Largest fraction of full scale on the wire."""


@dataclass(frozen=True, slots=True)
class DipoleConfig:
    """Mean dipole over a tick at full scale, A m^2, the inertia, and how the best dipole is found.

    The columns of ``body_from_coils``: the coils' dipoles per unit nominal one, body axes; None: nominal.
    """

    full_scale_am2: float
    inertia_kgm2: Mat3
    genetic: bool
    body_from_coils: Mat3 | None = None
    coils_from_body: Mat3 | None = None


@final
@dataclass(slots=True)
class RequestedDipole:
    """The last request: the tick that it answered, -1: none yet, and its dipole as it is on the wire.

    The dipole in body axes, A m^2. ``reported``: whether the board has said what it drove over the tick that
    just ended.
    """

    tick: int = -1
    m_body_am2: Vec3 = ZERO
    reported: bool = False

    def over(self, tick: int) -> Vec3:
        """The dipole requested over the tick that ends at this one."""
        return self.m_body_am2 if tick == self.tick + 1 else ZERO


def remember(requested: RequestedDipole, request: CoilDipole, tick: int, config: DipoleConfig) -> None:
    """Take this for the last request."""
    sent = CoilDipole.decode(request.encode().data)
    requested.tick, requested.m_body_am2 = tick, dipole_am2((sent.m_x, sent.m_y, sent.m_z), config)


def dipole_am2(fractions: Vec3, config: DipoleConfig) -> Vec3:
    """The mean dipole over a tick by these fractions of full scale, body axes, A m^2."""
    driven_am2 = scale(config.full_scale_am2, fractions)
    return driven_am2 if config.body_from_coils is None else transform(config.body_from_coils, driven_am2)


def request(
    state: PulseState, demand: Demand, b_body_t: Vec3, tick: int, config: DipoleConfig, timing: PulseConfig
) -> CoilDipole:
    """The dipole of this tick."""
    if demand.impulse_body_nms is None:
        return saturate(demand.m_body_am2, config)
    if tick >= state.busy_until:
        state.held_am2 = ZERO
        if tick >= max(state.ready_tick) and dot(b_body_t, b_body_t) > 0.0:
            _begin(state, demand.impulse_body_nms, b_body_t, tick, config, timing)
    return saturate(state.held_am2, config)


def _begin(
    state: PulseState,
    impulse_body_nms: Vec3,
    b_body_t: Vec3,
    tick: int,
    config: DipoleConfig,
    timing: PulseConfig,
) -> None:
    """Hold the best dipole for the length of a pulse, then none for the back-off."""
    if config.genetic:
        state.held_am2 = search(
            impulse_body_nms,
            b_body_t,
            timing.pulse_s,
            config.full_scale_am2,
            timing.energy_metric,
            seed=tick,
        )
    else:
        paid = best_impulse(impulse_body_nms, b_body_t, config.inertia_kgm2)
        state.held_am2 = scale(1.0 / (timing.pulse_s * dot(b_body_t, b_body_t)), cross(b_body_t, paid))
    state.busy_until = tick + timing.pulse_ticks
    again = state.busy_until + timing.backoff_ticks
    state.ready_tick = (again, again, again)


def saturate(m_body_am2: Vec3, config: DipoleConfig) -> CoilDipole:
    """The request: the dipole as fractions of full scale, scaled down to fit, its direction kept.

    A dipole that is not finite becomes zero: on the wire it would be full scale.
    """
    if config.coils_from_body is not None:
        m_body_am2 = transform(config.coils_from_body, m_body_am2)
    fractions = scale(1.0 / config.full_scale_am2, m_body_am2)
    if not is_finite(fractions[0] + fractions[1] + fractions[2]):
        return CoilDipole(0.0, 0.0, 0.0)
    most = max(abs(fractions[0]), abs(fractions[1]), abs(fractions[2]))
    x, y, z = scale(MOST / most, fractions) if most > MOST else fractions
    return CoilDipole(x, y, z)
